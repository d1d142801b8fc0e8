//! A single kidnapping trial.

use core::f64::consts::{PI, TAU};

use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::{DiffDrive, Twist, WheelPair};
use surepose::lidar::{BeamSubset, RangeFinder};
use surepose::param::{SEARCH_TURN_RATE, START_HEADING, START_X, START_Y};
use surepose::safety::Health;
use surepose_config::{Config, ScanMethod};
use surepose_sim::robot::{Scenario, Sensors, SimulatedRobot, scan_view};
use surepose_sim::{Clutter, Fault, FaultKind, LaserModel, Seed, Stream};

use super::spawn_area::SpawnArea;

/// Time of the displacement, and duration of the observation after it \[s].
const KIDNAP_TIME: f64 = 2.0;
const OBSERVATION_TIME: f64 = 9.0;

/// Minimum distance \[m] or turn \[rad] of a displacement; smaller ones resemble wheel slip.
const MIN_DISTANCE: f64 = 0.5;
const MIN_TURN: f64 = 0.35;

/// Deadline for recovery after the displacement \[s].
const RECOVERY_DEADLINE: f64 = 5.0;

/// An error beyond this many standard deviations is wrong; wrong and healthy for this long \[s] is
/// confidently wrong.
const MAX_ERROR_STD: f64 = 5.0;
const MAX_WRONG_TIME: f64 = 2.0;

/// Beams of a full-circle scan that compares places, and the hit ratio beyond which they look alike.
const PANORAMA_BEAMS: usize = 180;
const SIMILARITY_THRESHOLD: f64 = 0.98;

/// Configuration and environment of a kidnapped robot.
#[derive(Clone, Debug)]
pub struct KidnappingSetup {
    /// The robot's configuration.
    pub config: Config,
    /// The robot's sensors.
    pub sensors: Sensors,
    /// Scan processing method.
    pub scan_method: ScanMethod,
    /// Obstacles that are not on the map.
    pub clutter: Clutter,
}

/// Result of one trial; times are relative to the displacement \[s].
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "four independent flags of one trial")]
pub struct KidnappingTrial {
    /// True pose before the displacement.
    pub from: Pose<Map, Body, f64>,
    /// True pose after the displacement.
    pub to: Pose<Map, Body, f64>,
    /// Whether the robot was flagged as lost before the displacement.
    pub false_alarm: bool,
    /// Time of the first flag; `None` if never flagged.
    pub flagged: Option<f64>,
    /// Time of the last accepted pose; `None` if none was accepted.
    pub found: Option<f64>,
    /// Normalized estimation error squared (NEES) at the last accepted pose.
    pub found_nees: Option<f64>,
    /// Whether the estimate was right and not lost five seconds after the displacement.
    pub recovered: bool,
    /// Whether, five seconds after the displacement, another pose explained the scan from the true one.
    pub ambiguous: bool,
    /// Number of accepted poses that were wrong.
    pub wrongly_found: u32,
    /// Position error at the end \[m].
    pub final_error: f64,
    /// Whether the estimate was wrong while healthy for two seconds.
    pub confidently_wrong: bool,
}

/// Runs a trial in `area`; all randomness is drawn from `seed`.
pub fn run_trial(area: &SpawnArea, setup: &KidnappingSetup, seed: u64) -> KidnappingTrial {
    let mut random = Seed(seed).stream("kidnapping");
    let from = area.pose(&mut random);
    let to = random_other_pose(area, from, &mut random);
    let idle = random.uniform(-0.5, 0.5);
    let search_rate = setup.config.number(&SEARCH_TURN_RATE);
    let search = if random.bernoulli(0.5) { search_rate } else { -search_rate };
    let turn = (to.heading - from.heading).radians();
    let start = [(&START_X, from.x), (&START_Y, from.y), (&START_HEADING, from.heading.degrees())];
    let scenario = Scenario {
        sensors: setup.sensors,
        scan_method: setup.scan_method,
        clutter: setup.clutter,
        faults: vec![Fault::at(KIDNAP_TIME, FaultKind::Displaced([to.x - from.x, to.y - from.y, turn]))],
        ..Scenario::in_arena(area.arena.clone(), setup.config.clone().with_preset("kidnapping", &start))
    };
    let mut robot = Robot::new(&scenario, seed, idle, search);
    let mut result = KidnappingTrial {
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
    while robot.time() < KIDNAP_TIME + OBSERVATION_TIME {
        let was = robot.health();
        let belief = robot.step();
        let (time, health) = (robot.time() - KIDNAP_TIME, robot.health());
        let nees = belief.nees(robot.simulated_robot.world().pose());
        result.final_error = belief.pose.origin().distance(robot.simulated_robot.world().pose().origin());
        let is_wrong = nees > MAX_ERROR_STD * MAX_ERROR_STD;
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
        result.confidently_wrong |= wrong_for > MAX_WRONG_TIME;
        if time <= RECOVERY_DEADLINE {
            result.recovered = health != Health::Lost && !is_wrong;
            result.ambiguous = robot.is_ambiguous();
        }
    }
    result
}

fn random_other_pose(
    area: &SpawnArea,
    from: Pose<Map, Body, f64>,
    random: &mut Stream,
) -> Pose<Map, Body, f64> {
    loop {
        let to = area.pose(random);
        let turned = (to.heading - from.heading).radians().abs();
        if from.origin().distance(to.origin()) > MIN_DISTANCE || turned > MIN_TURN {
            return to;
        }
    }
}

/// A robot that turns in place slowly, and faster while it is lost.
struct Robot {
    simulated_robot: SimulatedRobot,
    drive: DiffDrive<f64>,
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
        Self { simulated_robot: SimulatedRobot::new(scenario, seed), drive, period, config, idle, search }
    }

    fn time(&self) -> f64 {
        self.simulated_robot.world().now().seconds()
    }

    fn health(&self) -> Health {
        self.simulated_robot.navigator().localizer().health()
    }

    fn step(&mut self) -> Belief<f64> {
        let is_lost = self.health() == Health::Lost;
        let wheels: WheelPair<f64> =
            self.drive.wheel_rates_from_twist(Twist::new(0.0, if is_lost { self.search } else { self.idle }));
        self.simulated_robot.advance(wheels, self.period).belief
    }

    /// Returns whether a hypothesis other than the true pose explains a full-circle scan without noise and
    /// clutter.
    ///
    /// Only the hypotheses of the global localizer are compared.
    fn is_ambiguous(&self) -> bool {
        let (world, laser) = (self.simulated_robot.world(), self.config.laser());
        let truth = world.pose();
        let eye = LaserModel {
            angle_min: -PI,
            angle_increment: TAU / PANORAMA_BEAMS as f64,
            beams: PANORAMA_BEAMS,
            ..noiseless()
        };
        let seen = eye.scan(world.model().arena.walls(), truth, &mut Seed(0).stream("nothing"));
        let finder = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: laser.range_std,
            bearing_std: laser.bearing_std,
            range_min: 0.0,
            range_max: eye.max_range,
        };
        let Ok(beams) = BeamSubset::<f64, PANORAMA_BEAMS>::from_scan(&finder, &scan_view(&seen)) else {
            return false;
        };
        let Some(monitor) = self.simulated_robot.navigator().localizer().monitor() else { return false };
        monitor.hypotheses().any(|known| {
            let pose = known.belief.pose;
            let turned = (pose.heading - truth.heading).radians().abs();
            let is_other = pose.origin().distance(truth.origin()) > 0.3 || turned > 0.2;
            is_other && {
                let seen_from_there =
                    beams.evaluate(pose, &known.belief.covariance, self.simulated_robot.walls());
                seen_from_there.hit_ratio() >= SIMILARITY_THRESHOLD
            }
        })
    }
}

fn noiseless() -> LaserModel {
    LaserModel { range_std: 0.0, bearing_std: 0.0, ..LaserModel::half_circle(0) }
}
