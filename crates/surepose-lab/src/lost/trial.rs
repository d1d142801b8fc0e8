//! One kidnapping.

use core::f64::consts::{PI, TAU};

use surepose::param::{START_HEADING, START_X, START_Y};
use surepose::{Belief, Body, Drive, Glance, Health, Map, Pose, RangeFinder, Twist, Wheels};
use surepose_data::Config;
use surepose_sim::{Clutter, Fault, Kind, LaserModel, Seed, Stream};

use crate::rig::{Reading, Rig, SEARCH_RATE, Scenario, Sensors, scan_of};

use super::place::Place;

/// When the robot is lifted \[s], and how long it is watched after that \[s].
const LIFTED: f64 = 2.0;
const WATCHED: f64 = 9.0;

/// The least distance \[m] or turn \[rad] that is a kidnapping; anything less the filter may take for slip.
const FAR: f64 = 0.5;
const TURNED: f64 = 0.35;

/// Up to this long \[s] after the kidnapping the pose must be found.
const IN_TIME: f64 = 5.0;

/// An error beyond so many standard deviations is wrong; wrong and healthy for so long \[s] is confidently wrong.
const WRONG: f64 = 5.0;
const CONFIDENT: f64 = 2.0;

/// Beams all around by which places are compared, and the part of them that are alike in places that are.
const AROUND: usize = 180;
const ALIKE: f64 = 0.98;

/// What a kidnapped robot has, and what is in its way.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Its configuration.
    pub config: Config,
    /// Its sensors.
    pub sensors: Sensors,
    /// How it reads scans.
    pub reading: Reading,
    /// Things on no map.
    pub clutter: Clutter,
}

/// What came of one kidnapping; times are from the moment of it \[s].
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "four questions about one trial, any answer to each")]
pub struct Kidnapping {
    /// From where.
    pub from: Pose<Map, Body, f64>,
    /// To where.
    pub to: Pose<Map, Body, f64>,
    /// When it was flagged as lost before it was lifted at all: a false alarm.
    pub false_alarm: bool,
    /// When it was flagged.
    pub flagged: Option<f64>,
    /// When it was last found.
    pub found: Option<f64>,
    /// The normalised estimation error squared when it was last found.
    pub found_nees: Option<f64>,
    /// Five seconds after, the estimate was healthy and right.
    pub recovered: bool,
    /// Five seconds after, another pose explained all that can be seen from the true one.
    pub ambiguous: bool,
    /// How often a pose was found that was wrong.
    pub wrongly_found: u32,
    /// How far off the estimate was at the end \[m].
    pub final_error: f64,
    /// For two seconds on end it was healthy and wrong.
    pub confidently_wrong: bool,
}

/// Kidnaps a robot in `place`, everything random drawn from `seed`.
pub fn kidnap(place: &Place, setup: &Setup, seed: u64) -> Kidnapping {
    let mut random = Seed(seed).stream("kidnapping");
    let from = place.pose(&mut random);
    let to = elsewhere(place, from, &mut random);
    let idle = random.uniform(-0.5, 0.5);
    let search = if random.chance(0.5) { SEARCH_RATE } else { -SEARCH_RATE };
    let turn = (to.heading - from.heading).radians();
    let start = [(&START_X, from.x), (&START_Y, from.y), (&START_HEADING, from.heading.degrees())];
    let scenario = Scenario {
        sensors: setup.sensors,
        reading: setup.reading,
        clutter: setup.clutter,
        faults: vec![Fault::at(LIFTED, Kind::Pushed([to.x - from.x, to.y - from.y, turn]))],
        ..Scenario::in_arena(place.arena.clone(), setup.config.clone().with_preset("kidnapping", &start))
    };
    let mut robot = Robot::new(&scenario, seed, idle, search);
    let mut result = Kidnapping {
        from,
        to,
        false_alarm: false,
        flagged: None,
        found: None,
        found_nees: None,
        recovered: false,
        ambiguous: false,
        wrongly_found: 0,
        final_error: f64::INFINITY,
        confidently_wrong: false,
    };
    let mut wrong_for = 0.0;
    while robot.time() < LIFTED + WATCHED {
        let was = robot.rig.health();
        let belief = robot.step();
        let (time, health) = (robot.time() - LIFTED, robot.rig.health());
        let nees = belief.nees(robot.rig.world().pose());
        result.final_error = belief.pose.origin().distance(robot.rig.world().pose().origin());
        let is_wrong = nees > WRONG * WRONG;
        if time <= 0.0 {
            result.false_alarm |= health == Health::Lost;
            continue;
        }
        if health == Health::Lost && was != Health::Lost {
            result.flagged.get_or_insert(time);
        }
        if health != Health::Lost && was == Health::Lost {
            (result.found, result.found_nees) = (Some(time), Some(nees));
            result.wrongly_found += u32::from(is_wrong);
        }
        wrong_for = if is_wrong && health == Health::Healthy { wrong_for + robot.period } else { 0.0 };
        result.confidently_wrong |= wrong_for > CONFIDENT;
        if time <= IN_TIME {
            result.recovered = health != Health::Lost && !is_wrong;
            result.ambiguous = robot.is_ambiguous();
        }
    }
    result
}

fn elsewhere(place: &Place, from: Pose<Map, Body, f64>, random: &mut Stream) -> Pose<Map, Body, f64> {
    loop {
        let to = place.pose(random);
        let turned = (to.heading - from.heading).radians().abs();
        if from.origin().distance(to.origin()) > FAR || turned > TURNED {
            return to;
        }
    }
}

/// A robot that turns slowly in place, and faster while it is lost.
struct Robot {
    rig: Rig,
    drive: Drive<f64>,
    period: f64,
    config: Config,
    idle: f64,
    search: f64,
}

impl Robot {
    fn new(scenario: &Scenario, seed: u64, idle: f64, search: f64) -> Self {
        let controller = scenario.config.controller();
        let (drive, period) = (controller.drive, controller.period);
        let config = scenario.config.clone();
        Self { rig: Rig::new(scenario, seed), drive, period, config, idle, search }
    }

    fn time(&self) -> f64 {
        self.rig.world().now().seconds()
    }

    fn step(&mut self) -> Belief<f64> {
        let is_lost = self.rig.health() == Health::Lost;
        let wheels: Wheels<f64> =
            self.drive.rates_from_twist(Twist::new(0.0, if is_lost { self.search } else { self.idle }));
        self.rig.step(wheels, self.period)
    }

    /// Whether another pose than the true one explains everything that can be seen from there, all around and without
    /// noise and clutter.
    ///
    /// Poses are those that the search came up with: one that nobody thought of makes no place ambiguous.
    fn is_ambiguous(&self) -> bool {
        let (world, laser) = (self.rig.world(), self.config.laser());
        let truth = world.pose();
        let eye = LaserModel {
            first_bearing: -PI,
            bearing_step: TAU / AROUND as f64,
            beams: AROUND,
            ..noiseless()
        };
        let seen = eye.scan(world.model().arena.walls(), truth, &mut Seed(0).stream("nothing"));
        let finder = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: laser.range_std,
            bearing_std: laser.bearing_std,
            nearest: 0.0,
            farthest: eye.max_range,
        };
        let Ok(glance) = Glance::<f64, AROUND>::of(&finder, &scan_of(&seen)) else { return false };
        self.rig.hypotheses().any(|known| {
            let pose = known.belief.pose;
            let turned = (pose.heading - truth.heading).radians().abs();
            let is_other = pose.origin().distance(truth.origin()) > 0.3 || turned > 0.2;
            is_other && {
                let seen_from_there = glance.from(pose, &known.belief.covariance, self.rig.walls());
                seen_from_there.explained_share() >= ALIKE
            }
        })
    }
}

fn noiseless() -> LaserModel {
    LaserModel { range_std: 0.0, bearing_std: 0.0, ..LaserModel::half_circle(0) }
}
