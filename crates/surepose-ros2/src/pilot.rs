//! The robot's driver: odometry, headings, scans and goals in, beliefs and velocity commands out. It knows no ROS, reads no
//! clock, and says the same every time it hears the same.
//!
//! Time is that of the odometry's stamps: with each period of it that is over the driver ticks, by
//! [`surepose::closed_loop::tick`] while it has a goal, and else by the first half of that. So a bag that is played slowly,
//! or a simulator with a clock of its own, gives what the robot gave.

mod active_goal;
mod environment;
mod measurement_queue;
mod obstacle_monitor;
mod odometry_accumulator;
mod settings;

use surepose::closed_loop::{Controller, SensorInput, Tick};
use surepose::{
    Belief, Body, FaultReason, Goal, Health, Map, MeasurementStats, NavigationVariables, Pose, SafetyAction,
    Stamp, Stamped, SupervisorConfig, Twist, WheelOdometry, WheelPair,
};
use surepose_sim::WallSegment;
use surepose_sim::robot::{LocalizationMonitor, SimLocalizer, new_localizer};

use crate::convert::MessageError;

use active_goal::ActiveGoal;
use environment::Environment;
use measurement_queue::MeasurementQueue;
pub(crate) use odometry_accumulator::OdometryAccumulator;

pub use active_goal::{BlockReason, GoalResult};
pub use measurement_queue::{LaserScan, SensorMessage};
pub use odometry_accumulator::Odom;
pub use settings::{NodeDriverSettings, START_STD};

/// So long \[s] the driver goes on telling the wheels to rest after it had a goal.
const STOP_COMMAND_TIME: f64 = 0.5;

/// What the driver says after a tick.
#[derive(Clone, Copy, Debug)]
pub struct DriverReport {
    /// When.
    pub stamp: Stamp,
    /// Where it thinks it is; worth nothing while it is lost.
    pub belief: Belief<f64>,
    /// Where odometry's frame is on the map.
    pub map_from_odom: Pose<Map, Odom, f64>,
    /// How far the belief can be trusted.
    pub health: Health,
    /// What the supervisor lets the wheels do.
    pub action: SafetyAction,
    /// How the robot shall move; nothing where the wheels are nobody's, or somebody else's.
    pub command: Option<Twist<f64>>,
    /// The goal as it is seen from there, where there is one.
    pub navigation: Option<NavigationVariables<f64>>,
    /// What the robot waits for, if it does: that its way is free, or is seen.
    pub block_reason: Option<BlockReason>,
    /// What became of the goal that was driven to.
    pub ended: Option<GoalResult>,
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
pub struct NodeDriver {
    settings: NodeDriverSettings,
    controller: Controller<f64>,
    environment: Environment,
    localizer: Box<SimLocalizer>,
    monitor: LocalizationMonitor,
    measurement_queue: MeasurementQueue,
    odometry_accumulator: Option<OdometryAccumulator>,
    active_goal: Option<ActiveGoal>,
    /// What became of the last goal, until the next report.
    ended: Option<GoalResult>,
    /// How the wheels come to rest after a goal.
    resting: Option<Resting>,
}

impl NodeDriver {
    /// A driver who has heard nothing yet.
    pub fn new(settings: NodeDriverSettings) -> Self {
        let environment = Environment::from_map(settings.map.as_ref(), settings.safety_radius);
        let origin = Belief::new(Pose::identity(), [0.0; 3]);
        let belief = settings.start.unwrap_or(origin);
        Self {
            controller: settings.config.controller(),
            localizer: new_localizer(&settings.config, settings.scan_method, belief),
            monitor: monitor(&settings, &environment, Stamp::default()),
            environment,
            measurement_queue: MeasurementQueue::default(),
            odometry_accumulator: None,
            active_goal: None,
            ended: None,
            resting: None,
            settings,
        }
    }

    /// Takes in where odometry says that the robot is, and ticks if a period is over.
    ///
    /// # Errors
    /// [`MessageError::OutOfOrder`] for a stamp that is not later than the last one, unless it is so much earlier that the clock
    /// was set back: then everything starts anew, from where the robot is believed to be.
    pub fn on_odometry(
        &mut self,
        at: Stamped<Pose<Odom, Body, f64>>,
    ) -> Result<Option<DriverReport>, MessageError> {
        let Some(odometry_accumulator) = &mut self.odometry_accumulator else {
            self.begin(at);
            return Ok(None);
        };
        if odometry_accumulator.is_set_back(at.stamp) {
            self.ended = self.end(GoalResult::Stopped("clock_set_back"));
            let resting = self.resting.take();
            self.begin(at);
            // The wheels still brake, by the new clock.
            self.resting =
                resting.map(|resting| Resting { until: at.stamp.after(STOP_COMMAND_TIME), ..resting });
            return Ok(None);
        }
        let rims = odometry_accumulator.add(&self.controller, at)?;
        Ok(rims.map(|rims| self.tick(at, rims)))
    }

    /// Takes in what a sensor measured; without walls, scans say nothing.
    pub fn add_measurement(&mut self, heard: Stamped<SensorMessage>) {
        if self.environment.has_map() || heard.value.scan().is_none() {
            self.measurement_queue.put(heard);
        }
    }

    /// Takes somebody's word for where the robot was at a moment that the filter remembers, else for where it is now.
    pub fn set_pose(&mut self, told: Stamped<Belief<f64>>) {
        self.settings.start = Some(told.value);
        if let Some(odometry_accumulator) = &self.odometry_accumulator {
            self.localizer.estimator.reset_at(told.stamp, told.value);
            self.monitor = monitor(&self.settings, &self.environment, odometry_accumulator.stamp());
            self.measurement_queue = MeasurementQueue::default();
        }
        if let Some(active_goal) = &mut self.active_goal {
            active_goal.reset();
        }
    }

    /// Forgets where the robot is, so that it looks for itself.
    ///
    /// Without walls there is nothing to look at, and it stays where it is.
    pub fn start_global_localization(&mut self) {
        if self.environment.has_map() {
            self.settings.start = None;
            if let Some(odometry_accumulator) = &self.odometry_accumulator {
                self.monitor.lose(odometry_accumulator.stamp());
            }
        }
    }

    /// Drives to `goal` from now on, and says what that makes of the goal before.
    ///
    /// # Errors
    /// [`MessageError::InsufficientClearance`], where a wall of the map is too near; the goal before stays.
    pub fn set_goal(&mut self, goal: Pose<Map, Goal, f64>) -> Result<Option<GoalResult>, MessageError> {
        self.environment.check_clearance(goal)?;
        let ended = self.end(GoalResult::Preempted);
        // The wheels go on from what they were told last.
        let last = self.resting.take().map_or_else(Twist::zero, |resting| resting.last);
        self.active_goal = Some(ActiveGoal::new(goal, last));
        Ok(ended)
    }

    /// Gives the goal up, and rests.
    pub fn cancel(&mut self) -> Option<GoalResult> {
        self.end(GoalResult::Cancelled)
    }

    /// Odometry has not come for `age` \[s] by the clock on the wall: whether the wheels must be told to rest for that, and
    /// what became of the goal. They start from rest when odometry is back.
    pub fn on_odometry_timeout(&mut self, age: f64) -> (bool, Option<GoalResult>) {
        if !self.is_odometry_timed_out(age) {
            return (false, None);
        }
        let was_braking = self.resting.take().is_some();
        let Some(active_goal) = &mut self.active_goal else { return (was_braking, None) };
        active_goal.stop();
        let given_up = age > active_goal::GOAL_TIMEOUT;
        (
            true,
            if given_up { self.end(GoalResult::Stopped(FaultReason::OdometryTimeout.name())) } else { None },
        )
    }

    /// Whether the wheels are told anything: where there is a goal, and until they rest after one.
    pub fn is_commanding(&self) -> bool {
        self.active_goal.is_some() || self.resting.is_some_and(|resting| self.belief_stamp() <= resting.until)
    }

    /// Whether odometry that last came `age` \[s] ago is silent.
    pub fn is_odometry_timed_out(&self, age: f64) -> bool {
        age > SupervisorConfig::<f64>::default().odometry_timeout
    }

    /// Whether it has a goal.
    pub fn is_driving(&self) -> bool {
        self.active_goal.is_some()
    }

    /// A wall of the map on the straight way to `goal`: the law does not go round it.
    pub fn wall_on_straight_path(&self, goal: Pose<Map, Goal, f64>) -> Option<&WallSegment> {
        self.environment.wall_between(self.belief().pose, goal)
    }

    /// Where it thinks it is.
    pub fn belief(&self) -> Belief<f64> {
        self.localizer.estimator.belief()
    }

    /// What became of the measurements.
    pub fn measurement_stats(&self) -> &MeasurementStats {
        self.localizer.estimator.measurement_stats()
    }

    /// How many signals were dropped because odometry did not come to give them a place in time.
    pub fn dropped(&self) -> u64 {
        self.measurement_queue.dropped()
    }

    /// When that was.
    pub fn belief_stamp(&self) -> Stamp {
        self.localizer.estimator.stamp()
    }

    /// Where it drives to, or holds.
    pub fn goal(&self) -> Option<Pose<Map, Goal, f64>> {
        self.active_goal.as_ref().map(ActiveGoal::goal)
    }

    /// The controller.
    pub fn controller(&self) -> &Controller<f64> {
        &self.controller
    }

    /// Everything starts, at the first odometry.
    fn begin(&mut self, at: Stamped<Pose<Odom, Body, f64>>) {
        let belief = match &self.odometry_accumulator {
            None => self.settings.start,
            Some(before) => {
                let belief = self.belief();
                let is_lost = self.monitor.health(before.stamp(), &belief) == Health::Lost;
                (!is_lost).then_some(belief)
            }
        };
        self.odometry_accumulator = Some(OdometryAccumulator::new(at));
        self.measurement_queue = MeasurementQueue::default();
        self.resting = None;
        self.monitor = monitor(&self.settings, &self.environment, at.stamp);
        // Without walls, the map is where the robot starts.
        let unknown = Belief::new(Pose::identity(), [0.0; 3]);
        self.localizer.estimator.reset(at.stamp, belief.unwrap_or(unknown));
        if belief.is_none() && self.environment.has_map() {
            self.monitor.lose(at.stamp);
        }
    }

    /// The goal is over, if there is one; of one that had arrived, and held the pose, that was said.
    fn end(&mut self, ended: GoalResult) -> Option<GoalResult> {
        let is_under_way = self.active_goal.as_ref().is_some_and(|active_goal| !active_goal.has_arrived());
        self.rest();
        is_under_way.then_some(ended)
    }

    /// There is no goal any more: the wheels brake, and for a while are told to rest.
    fn rest(&mut self) {
        if let Some(active_goal) = self.active_goal.take() {
            let until = self.belief_stamp().after(STOP_COMMAND_TIME);
            self.resting = Some(Resting { last: active_goal.limited(), until });
        }
    }

    /// How wheels are braked that have no goal any more; nothing where they are nobody's.
    fn brake(&mut self, now: Stamp) -> Option<Twist<f64>> {
        let Resting { last, until } = self.resting.filter(|resting| now <= resting.until)?;
        let Controller { drive, limits, period, .. } = &self.controller;
        let limited = limits.limit(drive, Twist::zero(), last, *period);
        let until = if limited == Twist::zero() { until } else { now.after(STOP_COMMAND_TIME) };
        self.resting = Some(Resting { last: limited, until });
        Some(limited)
    }

    /// A period is over, in which the rims rolled so far \[m].
    fn tick(&mut self, at: Stamped<Pose<Odom, Body, f64>>, rims: WheelPair<f64>) -> DriverReport {
        let stamp = at.stamp;
        let heard = self.measurement_queue.until(stamp);
        let last_scan = heard.iter().rev().find_map(|heard| Some((heard.stamp, heard.value.scan()?)));
        if let Some((_, scan)) = last_scan {
            let laser = &mut self.localizer.scan_processor.laser;
            (laser.range_min, laser.range_max) = (scan.range_min, scan.range_max);
            laser.body_from_laser = scan.body_from_laser;
        }
        let signals: Vec<_> = heard.iter().map(SensorMessage::signal).collect();
        let travel = self.localizer.estimator.wheel_odometry(stamp, rims);
        let sensed = SensorInput { stamp, travel, readings: &signals };
        let ticked = self.process(&sensed);
        // Where things stand is known as well as where the robot was when it saw them: better now than before it thought.
        if let Some((taken, scan)) = last_scan {
            self.environment.look(taken, scan, &self.localizer);
        }
        self.environment.obstacle_monitor.forget(stamp);
        let driven = self.active_goal.as_mut().zip(ticked).map(|(active_goal, ticked)| {
            active_goal.command(&ticked, stamp, &self.controller, &self.environment, &self.monitor)
        });
        if let Some(ended) = driven.and_then(|driven| driven.ended) {
            self.ended = Some(ended);
            if ended != GoalResult::Reached || !self.settings.hold {
                self.rest();
            }
        }
        let belief = self.belief();
        let braked = if self.active_goal.is_none() { self.brake(stamp) } else { None };
        DriverReport {
            stamp,
            belief,
            map_from_odom: belief.pose * at.value.inverse(),
            health: self.monitor.health(stamp, &belief),
            action: self.monitor.action(stamp, &belief),
            command: driven.map(|driven| driven.command).or(braked),
            navigation: driven.map(|driven| driven.navigation),
            block_reason: self.active_goal.as_ref().and_then(ActiveGoal::block_reason),
            ended: self.ended.take(),
        }
    }

    /// Where is the robot, and what would the law do? Without a goal nobody told the wheels anything that they could have
    /// failed to do: they did what odometry says, or, where that jumped, anything that they can.
    fn process(&mut self, sensed: &SensorInput<'_, f64>) -> Option<Tick<f64>> {
        let Self { controller, localizer, environment, monitor, .. } = self;
        if let Some(active_goal) = &self.active_goal {
            return Some(active_goal.tick(controller, localizer, &environment.walls, sensed, monitor));
        }
        let WheelOdometry { travel: rims, .. } = sensed.travel;
        let told = if (rims.right + rims.left).is_finite() {
            sensed.travel
        } else {
            let elapsed = sensed.stamp.since(localizer.estimator.stamp());
            let most = (controller.limits.wheel_speed * elapsed).powi(2);
            WheelOdometry { travel: WheelPair::zero(), variance: WheelPair::new(most, most) }
        };
        let _belief = localizer.update(sensed, told, &environment.walls, monitor);
        None
    }
}

/// The monitor over a robot with these settings.
fn monitor(settings: &NodeDriverSettings, environment: &Environment, stamp: Stamp) -> LocalizationMonitor {
    let walls = &environment.walls;
    let aided = settings.compass || !walls.is_empty();
    LocalizationMonitor::new(&settings.config, aided, settings.scan_method, walls, stamp)
}

#[cfg(test)]
mod tests;
