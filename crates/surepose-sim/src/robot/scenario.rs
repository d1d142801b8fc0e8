//! What is driven: where, from where to where, and with which senses.

use surepose::geometry::{Body, Goal, Map, Point, Pose};
use surepose::kinematics::WheelPair;
use surepose::param;
use surepose_config::{Config, NavigatorSetup, ScanMethod, ValueSource};

use crate::{
    Arena, Clutter, CompassModel, Fault, LaserModel, MotorModel, Slip, Timing, WallSegment, WorldModel,
};

/// How often compass and laser measure \[s]: the paper's ΔT, [Tran2012] Sec. 5.2.
const SENSOR_PERIOD: f64 = 0.1;

/// Which sensors correct the odometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensors {
    /// The compass does.
    pub compass: bool,
    /// The laser does.
    pub laser: bool,
}

impl Sensors {
    /// Both do.
    pub const ALL: Self = Self { compass: true, laser: true };
    /// Neither does: odometry alone.
    pub const NONE: Self = Self { compass: false, laser: false };
}

/// Where the loop world's course starts, x \[m], y \[m], heading \[°].
const LOOP_START: [f64; 3] = [2.0, 1.0, 0.0];

/// So far from every wall the robot's middle must be where it starts and where it is to rest \[m].
const MIN_CLEARANCE: f64 = 0.05;

/// A start or a goal where the robot cannot stand.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub struct InsufficientClearance {
    /// `start` or `goal`.
    pub end: &'static str,
    /// Where that is.
    pub at: Point<Map, f64>,
    /// How far the nearest wall is \[m]; negative outside the arena.
    pub clearance: f64,
    /// How far it must be \[m].
    pub needed: f64,
    /// That wall.
    pub wall: WallSegment,
}

impl InsufficientClearance {
    fn message(&self) -> String {
        let Self { end, at, clearance, needed, wall: WallSegment { start: a, end: b } } = self;
        let wall = format!("the wall from ({}, {}) to ({}, {})", a.x, a.y, b.x, b.y);
        let where_ = format!("the {end} ({}, {})", at.x, at.y);
        if *clearance < 0.0 {
            format!("{where_} lies outside the arena, {:.2} m beyond {wall}", clearance.abs())
        } else {
            format!("{where_} is {clearance:.2} m from {wall}, and the robot's middle needs {needed:.2} m")
        }
    }
}

/// A drive to be done.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Where.
    pub arena: Arena,
    /// The robot, its law, its filter, start and goal. The world has the noise that the filter is told of.
    pub config: Config,
    /// With which senses.
    pub sensors: Sensors,
    /// How scans are read.
    pub scan_method: ScanMethod,
    /// How well the start is known: standard deviations of x \[m], y \[m] and heading \[rad].
    pub start_std: [f64; 3],
    /// Things in the laser's way that are on no map.
    pub clutter: Clutter,
    /// What goes wrong.
    pub faults: Vec<Fault>,
}

impl Default for Scenario {
    /// The paper's arena, from (0, 0, 0) to its first goal (2, 2, 30°).
    fn default() -> Self {
        Self::in_arena(Arena::paper(), Config::default())
    }
}

impl Scenario {
    /// A drive in `arena` with all senses, from and to where `config` says, the start known to 1 cm and 0.5°.
    pub fn in_arena(arena: Arena, config: Config) -> Self {
        let start_std = [0.01, 0.01, 0.5_f64.to_radians()];
        Self {
            arena,
            config,
            sensors: Sensors::ALL,
            scan_method: ScanMethod::Lines,
            start_std,
            clutter: Clutter::default(),
            faults: Vec::new(),
        }
    }

    /// The scenarios by name, each named as its arena: `paper`, `open` and `loop`.
    pub fn named(name: &str, config: Config) -> Option<Self> {
        Arena::named(name).map(|arena| Self::in_arena(arena, config))
    }

    /// The scenario that `config` names; in the loop world the robot starts on the course, unless it is told to elsewhere.
    pub fn configured(config: Config) -> Self {
        let arena = Arena::named(config.choice(&param::ARENA)).unwrap_or_else(Arena::paper);
        let mut values = Vec::new();
        if arena.name() == Arena::loop_world().name() {
            let [x, y, heading] = LOOP_START;
            let start = [(&param::START_X, x), (&param::START_Y, y), (&param::START_HEADING, heading)];
            // A start of which a part is given is given.
            if start.iter().all(|(part, _)| config.origin(part) == ValueSource::Default) {
                values.extend(start);
            }
        }
        Self::in_arena(arena, config.with_preset("loop", &values))
    }

    /// Whether there is room for the robot where it starts and where it is to rest.
    ///
    /// # Errors
    /// [`InsufficientClearance`], which names the wall.
    pub fn check_clearance(&self) -> Result<(), InsufficientClearance> {
        let (start, goal) = (self.start().origin(), self.goal().origin());
        for (end, at) in [("start", start), ("goal", goal)] {
            let (clearance, needed) = (self.arena.clearance(at), MIN_CLEARANCE);
            if let Some(wall) = self.arena.nearest_wall(at)
                && clearance < needed
            {
                return Err(InsufficientClearance { end, at, clearance, needed, wall: *wall });
            }
        }
        Ok(())
    }

    /// A wall on the straight way from start to goal: the law does not go round it.
    pub fn wall_on_straight_path(&self) -> Option<&WallSegment> {
        self.arena.first_wall_crossed(self.start().origin(), self.goal().origin())
    }

    /// Where the robot starts.
    pub fn start(&self) -> Pose<Map, Body, f64> {
        self.config.start()
    }

    /// Where it shall come to rest.
    pub fn goal(&self) -> Pose<Map, Goal, f64> {
        self.config.goal()
    }

    /// What the robot's navigator is built from.
    pub fn navigator_setup(&self) -> NavigatorSetup {
        NavigatorSetup {
            scan_method: self.scan_method,
            has_laser: self.sensors.laser,
            is_aided: self.sensors != Sensors::NONE,
            safety_radius: None,
            hold_goal: true,
        }
    }

    /// The world of this scenario.
    pub fn world(&self) -> WorldModel {
        let (compass, laser) = (self.config.compass(), self.config.laser());
        let (drive, limit) = (self.config.drive(), self.config.limits().wheel_speed);
        let compass_model = CompassModel { std: compass.std, offset: compass.offset.radians() };
        let laser_model = LaserModel {
            body_from_laser: laser.body_from_laser,
            range_std: laser.range_std,
            bearing_std: laser.bearing_std,
            clutter: self.clutter,
            ..LaserModel::half_circle(laser.beams)
        };
        let timing = |latency| Timing { period: SENSOR_PERIOD, latency };
        WorldModel {
            arena: self.arena.clone(),
            drive,
            motor: MotorModel::for_max_speed(
                drive.wheel_angle_from_travel(WheelPair::new(limit, limit)).max_abs(),
            ),
            slip: Slip { delta: self.config.ekf().delta },
            compass: self.sensors.compass.then(|| (compass_model, timing(compass.latency))),
            laser: self.sensors.laser.then(|| (laser_model, timing(laser.latency))),
            faults: self.faults.clone(),
        }
    }
}
