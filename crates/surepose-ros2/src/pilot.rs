//! The robot's pilot: odometry, headings, scans and goals in, beliefs and velocity commands out. It knows no ROS, reads no
//! clock, and says the same every time it hears the same.
//!
//! Time is that of the odometry's stamps: with each period of it that is over the pilot ticks, by
//! [`surepose::closed_loop::tick`] while it has a goal, and else by the first half of that. So a bag that is played slowly,
//! or a simulator with a clock of its own, gives what the robot gave.

mod errand;
mod inbox;
mod lookout;
mod odometer;
mod settings;
mod surroundings;

use surepose::closed_loop::{Controller, Sensed, Tick};
use surepose::{
    Belief, Body, Goal, Health, Map, Navigation, Pose, Reason, Stamp, Stamped, Tally, Travel, Twist, Verdict,
    Vigilance, Wheels,
};
use surepose_lab::rig::{Localisation, Watch, localisation};
use surepose_sim::Segment;

use crate::convert::Refused;

use errand::Errand;
use inbox::Inbox;
pub(crate) use odometer::Odometer;
use surroundings::Surroundings;

pub use errand::{Ended, Hindrance};
pub use inbox::{Heard, LaserScan};
pub use odometer::Odom;
pub use settings::{START_STD, Settings};

/// So long \[s] the pilot goes on telling the wheels to rest after it had a goal.
const REST: f64 = 0.5;

/// What the pilot says after a tick.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// When.
    pub stamp: Stamp,
    /// Where it thinks it is; worth nothing while it is lost.
    pub belief: Belief<f64>,
    /// Where odometry's frame is on the map.
    pub map_from_odom: Pose<Map, Odom, f64>,
    /// How far the belief can be trusted.
    pub health: Health,
    /// What the supervisor lets the wheels do.
    pub verdict: Verdict,
    /// How the robot shall move; nothing where the wheels are nobody's, or somebody else's.
    pub command: Option<Twist<f64>>,
    /// The goal as it is seen from there, where there is one.
    pub navigation: Option<Navigation<f64>>,
    /// What the robot waits for, if it does: that its way is free, or is seen.
    pub hindrance: Option<Hindrance>,
    /// What became of the goal that was driven to.
    pub ended: Option<Ended>,
}

/// The wheels come to rest.
#[derive(Clone, Copy, Debug)]
struct Resting {
    /// What they were told last.
    last: Twist<f64>,
    /// Until when they are told so.
    until: Stamp,
}

/// The loop on a robot that speaks in messages.
#[derive(Clone, Debug)]
pub struct Pilot {
    settings: Settings,
    controller: Controller<f64>,
    surroundings: Surroundings,
    localiser: Box<Localisation>,
    watch: Watch,
    inbox: Inbox,
    odometer: Option<Odometer>,
    errand: Option<Errand>,
    /// What became of the last errand, until the next report.
    ended: Option<Ended>,
    /// How the wheels come to rest after an errand.
    resting: Option<Resting>,
}

impl Pilot {
    /// A pilot who has heard nothing yet.
    pub fn new(settings: Settings) -> Self {
        let surroundings = Surroundings::of(settings.map.as_ref(), settings.room);
        let origin = Belief::new(Pose::identity(), [0.0; 3]);
        let belief = settings.start.unwrap_or(origin);
        Self {
            controller: settings.config.controller(),
            localiser: localisation(&settings.config, settings.reading, belief),
            watch: watch(&settings, &surroundings, Stamp::default()),
            surroundings,
            inbox: Inbox::default(),
            odometer: None,
            errand: None,
            ended: None,
            resting: None,
            settings,
        }
    }

    /// Takes in where odometry says that the robot is, and ticks if a period is over.
    ///
    /// # Errors
    /// [`Refused::OutOfOrder`] for a stamp that is not later than the last one, unless it is so much earlier that the clock
    /// was set back: then everything starts anew, from where the robot is believed to be.
    pub fn roll(&mut self, at: Stamped<Pose<Odom, Body, f64>>) -> Result<Option<Report>, Refused> {
        let Some(odometer) = &mut self.odometer else {
            self.begin(at);
            return Ok(None);
        };
        if odometer.is_set_back(at.stamp) {
            self.ended = self.end(Ended::Stopped("clock_set_back"));
            let resting = self.resting.take();
            self.begin(at);
            // The wheels still brake, by the new clock.
            self.resting = resting.map(|resting| Resting { until: at.stamp.after(REST), ..resting });
            return Ok(None);
        }
        let rims = odometer.roll(&self.controller, at)?;
        Ok(rims.map(|rims| self.tick(at, rims)))
    }

    /// Takes in what a sensor measured; without walls, scans say nothing.
    pub fn hear(&mut self, heard: Stamped<Heard>) {
        if self.surroundings.are_known() || heard.value.scan().is_none() {
            self.inbox.put(heard);
        }
    }

    /// Takes somebody's word for where the robot was at a moment that the filter remembers, else for where it is now.
    pub fn place(&mut self, told: Stamped<Belief<f64>>) {
        self.settings.start = Some(told.value);
        if let Some(odometer) = &self.odometer {
            self.localiser.estimator.resume(told.stamp, told.value);
            self.watch = watch(&self.settings, &self.surroundings, odometer.stamp());
            self.inbox = Inbox::default();
        }
        if let Some(errand) = &mut self.errand {
            errand.forget();
        }
    }

    /// Forgets where the robot is, so that it looks for itself.
    ///
    /// Without walls there is nothing to look at, and it stays where it is.
    pub fn lose(&mut self) {
        if self.surroundings.are_known() {
            self.settings.start = None;
            if let Some(odometer) = &self.odometer {
                self.watch.lose(odometer.stamp());
            }
        }
    }

    /// Drives to `goal` from now on, and says what that makes of the goal before.
    ///
    /// # Errors
    /// [`Refused::NoRoom`], where a wall of the map is too near; the goal before stays.
    pub fn go(&mut self, goal: Pose<Map, Goal, f64>) -> Result<Option<Ended>, Refused> {
        self.surroundings.have_room(goal)?;
        let ended = self.end(Ended::Preempted);
        // The wheels go on from what they were told last.
        let last = self.resting.take().map_or_else(Twist::rest, |resting| resting.last);
        self.errand = Some(Errand::to(goal, last));
        Ok(ended)
    }

    /// Gives the goal up, and rests.
    pub fn cancel(&mut self) -> Option<Ended> {
        self.end(Ended::Cancelled)
    }

    /// Odometry has not come for `age` \[s] by the clock on the wall: whether the wheels must be told to rest for that, and
    /// what became of the goal. They start from rest when odometry is back.
    pub fn miss(&mut self, age: f64) -> (bool, Option<Ended>) {
        if !self.is_silent(age) {
            return (false, None);
        }
        let was_braking = self.resting.take().is_some();
        let Some(errand) = &mut self.errand else { return (was_braking, None) };
        errand.stand();
        let given_up = age > errand::PATIENCE;
        (true, if given_up { self.end(Ended::Stopped(Reason::OdometrySilent.name())) } else { None })
    }

    /// Whether the wheels are told anything: where there is a goal, and until they rest after one.
    pub fn has_wheels(&self) -> bool {
        self.errand.is_some() || self.resting.is_some_and(|resting| self.belief_stamp() <= resting.until)
    }

    /// Whether odometry that last came `age` \[s] ago is silent.
    pub fn is_silent(&self, age: f64) -> bool {
        age > Vigilance::<f64>::default().odometry_age
    }

    /// Whether it has a goal.
    pub fn is_driving(&self) -> bool {
        self.errand.is_some()
    }

    /// A wall of the map on the straight way to `goal`: the law does not go round it.
    pub fn wall_before(&self, goal: Pose<Map, Goal, f64>) -> Option<&Segment> {
        self.surroundings.wall_between(self.belief().pose, goal)
    }

    /// Where it thinks it is.
    pub fn belief(&self) -> Belief<f64> {
        self.localiser.estimator.belief()
    }

    /// What became of the measurements.
    pub fn tally(&self) -> &Tally {
        self.localiser.estimator.tally()
    }

    /// How many signals were dropped because odometry did not come to give them a place in time.
    pub fn dropped(&self) -> u64 {
        self.inbox.dropped()
    }

    /// When that was.
    pub fn belief_stamp(&self) -> Stamp {
        self.localiser.estimator.stamp()
    }

    /// Where it drives to, or holds.
    pub fn goal(&self) -> Option<Pose<Map, Goal, f64>> {
        self.errand.as_ref().map(Errand::goal)
    }

    /// The controller.
    pub fn controller(&self) -> &Controller<f64> {
        &self.controller
    }

    /// Everything starts, at the first odometry.
    fn begin(&mut self, at: Stamped<Pose<Odom, Body, f64>>) {
        let belief = match &self.odometer {
            None => self.settings.start,
            Some(before) => {
                let belief = self.belief();
                let is_lost = self.watch.health(before.stamp(), &belief) == Health::Lost;
                (!is_lost).then_some(belief)
            }
        };
        self.odometer = Some(Odometer::starting(at));
        self.inbox = Inbox::default();
        self.resting = None;
        self.watch = watch(&self.settings, &self.surroundings, at.stamp);
        // Without walls, the map is where the robot starts.
        let unknown = Belief::new(Pose::identity(), [0.0; 3]);
        self.localiser.estimator.restart(at.stamp, belief.unwrap_or(unknown));
        if belief.is_none() && self.surroundings.are_known() {
            self.watch.lose(at.stamp);
        }
    }

    /// The errand is over, if there is one; of one that had arrived, and held the pose, that was said.
    fn end(&mut self, ended: Ended) -> Option<Ended> {
        let is_under_way = self.errand.as_ref().is_some_and(|errand| !errand.has_arrived());
        self.rest();
        is_under_way.then_some(ended)
    }

    /// There is no errand any more: the wheels brake, and for a while are told to rest.
    fn rest(&mut self) {
        if let Some(errand) = self.errand.take() {
            let until = self.belief_stamp().after(REST);
            self.resting = Some(Resting { last: errand.granted(), until });
        }
    }

    /// How wheels are braked that have no errand any more; nothing where they are nobody's.
    fn brake(&mut self, now: Stamp) -> Option<Twist<f64>> {
        let Resting { last, until } = self.resting.filter(|resting| now <= resting.until)?;
        let Controller { drive, limits, period, .. } = &self.controller;
        let granted = limits.grant(drive, Twist::rest(), last, *period);
        let until = if granted == Twist::rest() { until } else { now.after(REST) };
        self.resting = Some(Resting { last: granted, until });
        Some(granted)
    }

    /// A period is over, in which the rims rolled so far \[m].
    fn tick(&mut self, at: Stamped<Pose<Odom, Body, f64>>, rims: Wheels<f64>) -> Report {
        let stamp = at.stamp;
        let heard = self.inbox.until(stamp);
        let last_scan = heard.iter().rev().find_map(|heard| Some((heard.stamp, heard.value.scan()?)));
        if let Some((_, scan)) = last_scan {
            let laser = &mut self.localiser.eye.laser;
            (laser.nearest, laser.farthest) = (scan.nearest, scan.farthest);
            laser.body_from_laser = scan.body_from_laser;
        }
        let signals: Vec<_> = heard.iter().map(Heard::signal).collect();
        let travel = self.localiser.estimator.travel(stamp, rims);
        let sensed = Sensed { stamp, travel, signals: &signals };
        let ticked = self.think(&sensed);
        // Where things stand is known as well as where the robot was when it saw them: better now than before it thought.
        if let Some((taken, scan)) = last_scan {
            self.surroundings.look(taken, scan, &self.localiser);
        }
        self.surroundings.lookout.forget(stamp);
        let driven = self.errand.as_mut().zip(ticked).map(|(errand, ticked)| {
            errand.drive(&ticked, stamp, &self.controller, &self.surroundings, &self.watch)
        });
        if let Some(ended) = driven.and_then(|driven| driven.ended) {
            self.ended = Some(ended);
            if ended != Ended::Reached || !self.settings.hold {
                self.rest();
            }
        }
        let belief = self.belief();
        let braked = if self.errand.is_none() { self.brake(stamp) } else { None };
        Report {
            stamp,
            belief,
            map_from_odom: belief.pose * at.value.inverse(),
            health: self.watch.health(stamp, &belief),
            verdict: self.watch.verdict(stamp, &belief),
            command: driven.map(|driven| driven.command).or(braked),
            navigation: driven.map(|driven| driven.navigation),
            hindrance: self.errand.as_ref().and_then(Errand::hindrance),
            ended: self.ended.take(),
        }
    }

    /// Where is the robot, and what would the law do? Without an errand nobody told the wheels anything that they could have
    /// failed to do: they did what odometry says, or, where that jumped, anything that they can.
    fn think(&mut self, sensed: &Sensed<'_, f64>) -> Option<Tick<f64>> {
        let Self { controller, localiser, surroundings, watch, .. } = self;
        if let Some(errand) = &self.errand {
            return Some(errand.think(controller, localiser, &surroundings.walls, sensed, watch));
        }
        let Travel { rims, .. } = sensed.travel;
        let told = if (rims.right + rims.left).is_finite() {
            sensed.travel
        } else {
            let elapsed = sensed.stamp.since(localiser.estimator.stamp());
            let most = (controller.limits.wheel_speed * elapsed).powi(2);
            Travel { rims: Wheels::rest(), variance: Wheels::new(most, most) }
        };
        let _belief = localiser.sense(sensed, told, &surroundings.walls, watch);
        None
    }
}

/// The watch over a robot with these settings.
fn watch(settings: &Settings, surroundings: &Surroundings, stamp: Stamp) -> Watch {
    let walls = &surroundings.walls;
    let aided = settings.compass || !walls.is_empty();
    Watch::new(&settings.config, aided, settings.reading, walls, stamp)
}

#[cfg(test)]
mod tests;
