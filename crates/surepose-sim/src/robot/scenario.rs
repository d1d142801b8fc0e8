//! Scenario of a simulation: arena, robot, start, goal, sensors and faults.

use surepose::geometry::{Body, Goal, Map, Pose};
use surepose::kinematics::WheelPair;
use surepose::param::{self, ArenaName};
use surepose_config::{Config, NavigatorSetup, ScanMethod, ValueSource};
use surepose_io::owned_map::OwnedMap;

use super::invalid_end::{InvalidEnd, InvalidEndReason, ScenarioEnd};
use crate::arena::walls_from_segments;
use crate::{
    Arena, Clutter, CompassModel, Fault, LaserModel, MotorModel, Slip, Timing, WallSegment, WorldModel,
};

/// Measurement period of compass and laser \[s]: the paper's ΔT, [Tran2012] Sec. 5.2.
const SENSOR_PERIOD: f64 = 0.1;

/// Sensors that correct the odometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensors {
    /// Whether the compass is used.
    pub compass: bool,
    /// Whether the laser is used.
    pub laser: bool,
}

impl Sensors {
    /// Compass and laser.
    pub const ALL: Self = Self { compass: true, laser: true };
    /// Odometry alone.
    pub const NONE: Self = Self { compass: false, laser: false };
}

/// Start of the course in the loop world: x \[m], y \[m], heading \[°].
const LOOP_START: [f64; 3] = [2.0, 1.0, 0.0];

/// Configures a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Arena.
    pub arena: Arena,
    /// Robot, control law, filter, start and goal. The world has the noise that the filter assumes.
    pub config: Config,
    /// Sensors in use.
    pub sensors: Sensors,
    /// Method that matches scans with the map.
    pub scan_method: ScanMethod,
    /// Uncertainty of the start: standard deviations of x \[m], y \[m] and heading \[rad].
    pub start_std: [f64; 3],
    /// Unmapped obstacles.
    pub clutter: Clutter,
    /// Injected faults.
    pub faults: Vec<Fault>,
}

impl Default for Scenario {
    /// The paper's arena, from (0, 0, 0) to its first goal (2, 2, 30°).
    fn default() -> Self {
        Self::in_arena(Arena::paper(), Config::default())
    }
}

impl Scenario {
    /// Scenario in `arena` with all sensors and the start and goal of `config`; the start is known to 1 cm and 0.5°.
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

    /// Scenario of `config`. In the loop world the default start is on the course.
    pub fn configured(config: Config) -> Self {
        let name: ArenaName = config.choice();
        let arena = Arena::from_name(name);
        let mut values = Vec::new();
        if name == ArenaName::Loop {
            let [x, y, heading] = LOOP_START;
            let start = [(&param::START_X, x), (&param::START_Y, y), (&param::START_HEADING, heading)];
            // A partly configured start counts as configured.
            if start.iter().all(|(part, _)| config.origin(part) == ValueSource::Default) {
                values.extend(start);
            }
        }
        Self::in_arena(arena, config.with_preset("loop", &values))
    }

    /// Checks that the footprint has room at start and goal, and that walls do not separate them.
    ///
    /// # Errors
    /// [`InvalidEnd`], which names the wall.
    pub fn check_clearance(&self) -> Result<(), InvalidEnd> {
        let (start, goal) = (self.start(), self.goal());
        for (end, at) in [(ScenarioEnd::Start, start.origin()), (ScenarioEnd::Goal, goal.origin())] {
            let distance = -self.arena.clearance(at);
            if let Some(wall) = self.arena.nearest_wall(at)
                && distance > 0.0
            {
                let reason = InvalidEndReason::OutsideArena { distance, wall: *wall };
                return Err(InvalidEnd { end, at, reason });
            }
        }
        let (map, collision) =
            (OwnedMap::from_walls(walls_from_segments(self.arena.walls())), self.config.collision(None));
        let is_in_contact = collision.distance_to_walls(start, map.walls()).is_some_and(|it| it <= 0.0);
        if let Some(wall) = self.arena.nearest_wall(start.origin())
            && is_in_contact
        {
            let reason = InvalidEndReason::InContact { wall: *wall };
            return Err(InvalidEnd { end: ScenarioEnd::Start, at: start.origin(), reason });
        }
        let checked = map.check_goal(&collision, Some(start.origin()), goal);
        checked.map_err(|problem| InvalidEnd {
            end: ScenarioEnd::Goal,
            at: goal.origin(),
            reason: problem.into(),
        })
    }

    /// First wall on the straight line from start to goal, which the control law does not avoid.
    pub fn wall_on_straight_path(&self) -> Option<&WallSegment> {
        self.arena.first_wall_crossed(self.start().origin(), self.goal().origin())
    }

    /// Start pose.
    pub fn start(&self) -> Pose<Map, Body, f64> {
        self.config.start()
    }

    /// Goal pose.
    pub fn goal(&self) -> Pose<Map, Goal, f64> {
        self.config.goal()
    }

    /// Setup of the robot's navigator.
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
