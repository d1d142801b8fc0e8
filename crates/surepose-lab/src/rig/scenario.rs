//! What is driven: where, from where to where, and with which senses.

use surepose::{Body, Goal, Map, Pose, param};
use surepose_data::Config;
use surepose_sim::{Arena, Clutter, CompassModel, Fault, LaserModel, MotorModel, Slip, Timing, WorldModel};

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

/// How scans are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// Lines are found in them and matched: for places with long flat walls, and a map that has them exactly.
    #[default]
    Lines,
    /// They are laid on the walls beam by beam: for maps of many short walls, traced from a grid for instance.
    Beams,
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
    pub reading: Reading,
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
            reading: Reading::Lines,
            start_std,
            clutter: Clutter::default(),
            faults: Vec::new(),
        }
    }

    /// The scenarios by name, each named as its arena: `paper`, `open` and `loop`.
    pub fn named(name: &str, config: Config) -> Option<Self> {
        Arena::named(name).map(|arena| Self::in_arena(arena, config))
    }

    /// The scenario that `config` names.
    pub fn configured(config: Config) -> Self {
        let arena = Arena::named(config.choice(&param::ARENA)).unwrap_or_else(Arena::paper);
        Self::in_arena(arena, config)
    }

    /// Where the robot starts.
    pub fn start(&self) -> Pose<Map, Body, f64> {
        self.config.start()
    }

    /// Where it shall come to rest.
    pub fn goal(&self) -> Pose<Map, Goal, f64> {
        self.config.goal()
    }

    /// The world of this scenario.
    pub fn world(&self) -> WorldModel {
        let (compass, laser) = (self.config.compass(), self.config.laser());
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
            drive: self.config.drive(),
            motor: MotorModel::default(),
            slip: Slip { delta: self.config.ekf().delta },
            compass: self.sensors.compass.then(|| (compass_model, timing(compass.latency))),
            laser: self.sensors.laser.then(|| (laser_model, timing(laser.latency))),
            faults: self.faults.clone(),
        }
    }
}
