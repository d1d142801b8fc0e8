//! Scenario of a simulation: arena, robot, start, goal, sensors and faults.

use surepose::geometry::{Body, Goal, Map, Pose};
use surepose::kinematics::WheelPair;
use surepose::map::Wall;
use surepose::param::{self, ArenaName, Parameter};
use surepose_config::{Config, NavigatorSetup, ScanMethod, ValueSource};
use surepose_io::owned_map::OwnedMap;
use surepose_io::wall_map::WallMap;

use super::invalid_end::{InvalidEnd, InvalidEndReason, ScenarioEnd};
use crate::arena::walls_from_segments;
use crate::world_parameters::{self as world, MotorKind};
use crate::{
    Arena, Clutter, CompassModel, Fault, LaserModel, LaserSweep, MotorModel, PlantModel, Slip, Timing,
    WallSegment, WorldModel, WorldSettings,
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
    /// Arena of the robot's map, and of the world unless it differs.
    pub arena: Arena,
    /// Wall map of the robot, with the covariances of its walls; `None` for the walls of `arena`, exactly.
    pub map: Option<WallMap>,
    /// Arena of the world; `None` for that of `world_settings`, or else `arena`.
    pub world_arena: Option<Arena>,
    /// Robot, control law, filter, start and goal.
    pub config: Config,
    /// Differences of the world from this configuration; by default none.
    pub world_settings: WorldSettings,
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
            map: None,
            world_arena: None,
            config,
            world_settings: WorldSettings::default(),
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

    /// The scenario with this wall map of the robot; the walls of the world are the same, unless it differs.
    #[must_use]
    pub fn with_map(self, map: WallMap) -> Self {
        Self { arena: Arena::from_wall_map(&map), map: Some(map), ..self }
    }

    /// The map of the robot.
    pub fn robot_map(&self) -> OwnedMap {
        let exact = || OwnedMap::from_walls(walls_from_segments(self.arena.walls()));
        self.map.as_ref().map_or_else(exact, OwnedMap::from_wall_map)
    }

    /// Checks that the footprint has room at start and goal, and that walls do not separate them.
    ///
    /// # Errors
    /// [`InvalidEnd`], which names the wall.
    pub fn check_clearance(&self) -> Result<(), InvalidEnd> {
        let (start, goal, true_start) = (self.start(), self.goal(), self.true_start());
        let (world, collision) = (self.true_arena(), self.config.collision(None));
        let ends = [
            (&self.arena, ScenarioEnd::Start, start.origin()),
            (&self.arena, ScenarioEnd::Goal, goal.origin()),
            (&world, ScenarioEnd::Start, true_start.origin()),
        ];
        for (arena, end, at) in ends {
            let distance = -arena.clearance(at);
            if let Some(wall) = arena.nearest_wall(at)
                && distance > 0.0
            {
                let reason = InvalidEndReason::OutsideArena { distance, wall: *wall };
                return Err(InvalidEnd { end, at, reason });
            }
        }
        for (arena, pose) in [(&self.arena, start), (&world, true_start)] {
            let distance = collision.distance_to_walls(pose, &walls_from_segments(arena.walls()));
            if let Some(wall) = arena.nearest_wall(pose.origin())
                && distance.is_some_and(|distance| distance <= 0.0)
            {
                let reason = InvalidEndReason::InContact { wall: *wall };
                return Err(InvalidEnd { end: ScenarioEnd::Start, at: pose.origin(), reason });
            }
        }
        let checked = self.robot_map().check_goal(&collision, Some(start.origin()), goal);
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

    /// True start pose; without a difference of the world that of the robot.
    pub fn true_start(&self) -> Pose<Map, Body, f64> {
        self.world_settings.over(&self.config).start()
    }

    /// Start pose that the robot assumes.
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
            map_std: Wall::position_std_of(self.robot_map().walls()),
            has_laser: self.sensors.laser,
            is_aided: self.sensors != Sensors::NONE,
            safety_radius: None,
            hold_goal: true,
        }
    }

    /// The world of this scenario: the robot's configuration, with the differences of the world.
    pub fn world(&self) -> WorldModel {
        let (given, truth) = (&self.world_settings, self.world_settings.over(&self.config));
        let (compass, laser, drive) = (truth.compass(), truth.laser(), truth.drive());
        let max_speed = truth.limits().wheel_speed;
        let compass_model = CompassModel {
            std: compass.std,
            offset: compass.offset.radians(),
            drift: given.number(&world::COMPASS_DRIFT),
        };
        let laser_model = LaserModel {
            body_from_laser: laser.body_from_laser,
            range_std: laser.range_std,
            bearing_std: laser.bearing_std,
            clutter: given.clutter().unwrap_or(self.clutter),
            sweep: LaserSweep { duration: laser.timing.sweep.unwrap_or(0.0), stamped: laser.timing.stamped },
            ..LaserModel::facing_forward(laser.beams, laser.field_of_view)
        };
        let timing = |latency| Timing { period: SENSOR_PERIOD, latency };
        let geared = MotorModel::for_max_speed(
            drive.wheel_angle_from_travel(WheelPair::new(max_speed, max_speed)).max_abs(),
        );
        WorldModel {
            arena: self.true_arena(),
            drive,
            plant: self.plant(&truth),
            motor: MotorModel {
                ideal: given.choice::<MotorKind>(&world::MOTOR_MODEL) == MotorKind::Ideal,
                ticks_per_turn: given.number(&world::ENCODER_TICKS),
                ..geared
            },
            slip: Slip { delta: truth.ekf().delta },
            traction: given.traction(),
            gyroscope: given.gyroscope(&truth),
            compass: self.sensors.compass.then(|| (compass_model, timing(compass.latency))),
            laser: self.sensors.laser.then(|| (laser_model, timing(laser.latency))),
            faults: self.faults.iter().cloned().chain(given.faults()).collect(),
        }
    }

    /// The base between command and motors. Its motors follow every commanded step at once, unless the world has a
    /// limit of its own: the robot's own limits shape its commands already.
    fn plant(&self, truth: &Config) -> PlantModel {
        let (given, limits, actuator) = (&self.world_settings, truth.limits(), truth.actuator());
        let own_limit = |parameters: &[&Parameter], limit: f64| {
            let is_own = parameters.iter().any(|parameter| given.is_given(parameter));
            if is_own { limit } else { f64::INFINITY }
        };
        let ramp = [&param::WHEEL_ACCELERATION_LIMIT, &param::WHEEL_DECELERATION_LIMIT];
        PlantModel {
            command_delay: actuator.delay,
            min_speed: actuator.min_speeds.v,
            min_turn_rate: actuator.min_speeds.omega,
            min_wheel_speed: actuator.min_speeds.wheel,
            breakaway_speed: given.number(&world::BREAKAWAY_SPEED),
            wheel_speed: own_limit(&[&param::WHEEL_SPEED_LIMIT], limits.wheel_speed),
            wheel_acceleration: own_limit(&ramp, limits.wheel_acceleration),
            wheel_deceleration: own_limit(&ramp, limits.wheel_deceleration),
            lag: actuator.time_constant,
        }
    }

    /// The arena of the world; without a difference that of the robot's map.
    fn true_arena(&self) -> Arena {
        let arena = if let Some(arena) = &self.world_arena {
            arena.clone()
        } else if self.world_settings.is_given(&param::ARENA) {
            Arena::from_name(self.world_settings.over(&self.config).choice())
        } else {
            self.arena.clone()
        };
        if !self.world_settings.is_given(&world::MAP_SCALE) {
            return arena;
        }
        arena.scaled(1.0 / self.world_settings.number(&world::MAP_SCALE))
    }
}
