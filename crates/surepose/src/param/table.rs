//! Lists the parameters. The doc comment of an entry is its meaning in help texts, error messages and ROS.

use crate::control::Direction;
use crate::kinematics::Integration;
use crate::lidar::StampedBeam;

use super::{ArenaName, BrakingMode, Choice, Kind, LawName, MountingSource, Range};

/// Kind of a number in \[`low`, `high`].
pub const fn in_range(low: f64, high: f64, default: f64, reason: &'static str) -> Kind {
    Kind::Number { default: Some(default), range: Range { low, low_inclusive: true, high, reason } }
}

/// Kind of a number in (0, `high`].
pub const fn positive(high: f64, default: f64, reason: &'static str) -> Kind {
    Kind::Number { default: Some(default), range: Range { low: 0.0, low_inclusive: false, high, reason } }
}

/// A positive number whose default is derived from other parameters.
const fn derived(high: f64, reason: &'static str) -> Kind {
    Kind::Number { default: None, range: Range { low: 0.0, low_inclusive: false, high, reason } }
}

/// A number from 0 whose default is derived from other parameters.
const fn derived_from_0(high: f64, reason: &'static str) -> Kind {
    Kind::Number { default: None, range: Range { low: 0.0, low_inclusive: true, high, reason } }
}

const fn polygon(reach: f64, reason: &'static str) -> Kind {
    Kind::Polygon { range: Range { low: -reach, low_inclusive: true, high: reach, reason } }
}

/// Kind of an integer in \[`low`, `high`].
pub const fn integer(low: f64, high: f64, default: u32, reason: &'static str) -> Kind {
    Kind::Integer { default, range: Range { low, low_inclusive: true, high, reason } }
}

/// Kind of a name; the first is the default.
pub const fn one_of<C: Choice>() -> Kind {
    Kind::Choice { options: C::NAMES }
}

/// Declares parameters and lists them in `ALL`, in the style of [`param`](crate::param).
#[macro_export]
macro_rules! parameters {
    ($($(#[doc = $meaning:literal])+ $name:ident = $section:literal $key:literal, $unit:ident, $kind:expr;)*) => {
        $(
            $(#[doc = $meaning])+
            pub const $name: $crate::param::Parameter = $crate::param::Parameter {
                section: $section,
                key: $key,
                unit: $crate::param::Unit::$unit,
                kind: $kind,
                meaning: concat!($($meaning),+),
            };
        )*

        /// All parameters, grouped by section.
        pub const ALL: &[$crate::param::Parameter] = &[$($name),*];
    };
}

const SIGMA: &str = "a standard deviation is positive; 0 would mean a perfect sensor";
const MODEL_ERROR: &str = "a standard deviation is not negative, and 0 leaves the error out";
const LATENCY: &str = "the history holds at most 10 s, and no stamp is a second early";
const CAMERA_LATENCY_REASON: &str = "an image arrives after it was taken, and the history holds at most 10 s";
const GAIN: &str = "the Lyapunov derivative is negative only for positive gains";
const TIMEOUT_REASON: &str = "a time-out is positive";
const PLACE: &str = "a coordinate beyond 10 km indicates a wrong unit";
const TURN: &str = "an angle beyond one turn indicates a wrong unit";

/// The sections of the configuration file with their contents, in the order of [`ALL`].
pub const SECTIONS: &[(&str, &str)] = &[
    ("robot", "Drive, limits and outline of the robot."),
    ("law", "Control law and its gains."),
    ("goal", "When the goal counts as reached."),
    ("filter", "Kalman filter."),
    ("compass", "Compass."),
    ("gyroscope", "Gyroscope: the yaw rate of an inertial measurement unit."),
    ("laser", "Laser range finder."),
    ("map", "Map of walls."),
    ("camera", "Camera that observes landmarks, of the recordings in the format `mrclam`."),
    ("commands", "Response of a base to velocity commands, for recordings without wheel ticks."),
    ("safety", "Supervisor, collision check and search of a lost robot."),
    ("loop", "Control loop."),
    ("scenario", "Simulated run: environment, start and goal."),
];

parameters! {
    /// Radius of the drive wheels; the mean of both if they differ.
    WHEEL_RADIUS = "robot" "wheel_radius_m", Meter,
        in_range(0.001, 1.0, 0.05, "a radius below 1 mm or above 1 m indicates a wrong unit");
    /// Ratio of the right wheel radius to the left wheel radius.
    WHEEL_RADIUS_RATIO = "robot" "wheel_radius_ratio", One,
        in_range(0.5, 2.0, 1.0, "the two wheels of one axle do not differ by a factor of two");
    /// Wheel separation: distance between the contact points of the two drive wheels.
    WHEEL_SEPARATION = "robot" "track_m", Meter,
        in_range(0.01, 5.0, 0.6, "a wheel separation below 1 cm or above 5 m indicates a wrong unit");
    /// Relative standard deviation of the wheel radii that both wheels share: load, wear, tire pressure. A constant error that the
    /// filter considers and does not estimate; 0 leaves it out.
    WHEEL_RADIUS_STD = "robot" "wheel_radius_std", One, in_range(0.0, 0.2, 0.0, MODEL_ERROR);
    /// Standard deviation of wheel_radius_ratio, considered like wheel_radius_std.
    WHEEL_RADIUS_RATIO_STD = "robot" "wheel_radius_ratio_std", One, in_range(0.0, 0.2, 0.0, MODEL_ERROR);
    /// Relative standard deviation of track_m, considered like wheel_radius_std.
    WHEEL_SEPARATION_STD = "robot" "track_std", One, in_range(0.0, 0.2, 0.0, MODEL_ERROR);
    /// Maximum rim speed of a wheel. Faster commands are scaled down; the curvature of the path stays the same.
    WHEEL_SPEED_LIMIT = "robot" "wheel_speed_limit_m_s", MeterPerSecond,
        positive(10.0, 0.3, "at 0 the robot cannot move, and 10 m/s is beyond this class of robot");
    /// Maximum rim acceleration of a wheel.
    WHEEL_ACCELERATION_LIMIT = "robot" "wheel_acceleration_limit_m_s2", MeterPerSecondSquared,
        positive(1000.0, 0.5, "at 0 the wheels cannot start");
    /// Maximum rim deceleration of a wheel. If unset, it equals the acceleration.
    WHEEL_DECELERATION_LIMIT = "robot" "wheel_deceleration_limit_m_s2", MeterPerSecondSquared,
        derived(1000.0, "at 0 the wheels cannot stop");
    /// Minimum rim speed that a wheel executes; the motor ignores slower commands. They are sent as short pulses at this
    /// speed, so that the distance over time is what the law asks for. 0 for a wheel that executes every speed.
    MIN_WHEEL_SPEED = "robot" "min_wheel_speed_m_s", MeterPerSecond,
        in_range(0.0, 1.0, 0.0, "a speed is not negative, and no robot parks with a minimum above 1 m/s");
    /// Minimum |v| that the base executes, for a driver that ignores slower commands; see min_wheel_speed_m_s.
    MIN_SPEED = "robot" "min_speed_m_s", MeterPerSecond,
        in_range(0.0, 1.0, 0.0, "a speed is not negative, and no robot parks with a minimum above 1 m/s");
    /// Minimum |ω| that the base executes, for a driver that ignores slower commands; see min_wheel_speed_m_s.
    MIN_TURN_RATE = "robot" "min_turn_rate_deg_s", DegreePerSecond,
        in_range(0.0, 180.0, 0.0, "a turn rate is not negative, and no robot parks with a minimum above 180°/s");
    /// Dead time between a command and its effect on the wheels. The controller predicts the pose at which a command takes
    /// effect; at most the last 32 commands are predicted.
    COMMAND_DELAY = "robot" "command_delay_s", Second,
        in_range(0.0, 2.0, 0.0, "a command does not act before it is sent");
    /// Time constant of the wheels' response, for a base that follows a change of speed exponentially. The controller
    /// predicts the distance that the wheels still cover.
    MOTOR_TIME_CONSTANT = "robot" "motor_time_constant_s", Second,
        in_range(0.0, 2.0, 0.0, "a time constant is not negative, and a slower base cannot be controlled");
    /// Radius of the robot's outline around the middle of its axle, for walls and obstacles. If unset, it is half the wheel
    /// separation plus 2 cm, which is a circle around both wheels. 0 checks the middle alone.
    FOOTPRINT_RADIUS = "robot" "footprint_radius_m", Meter,
        derived_from_0(5.0, "a radius is not negative, and more than 5 m indicate a wrong unit");
    /// Outline of the robot as a polygon of 3 to 8 points [x, y] around the middle of its axle, x forward and y left. It replaces
    /// the circle of footprint_radius_m; `[]` is no polygon. Example: [[0.4, 0.2], [-0.1, 0.2], [-0.1, -0.2], [0.4, -0.2]].
    FOOTPRINT = "robot" "footprint_m", Meter, polygon(5.0, "coordinates beyond 5 m indicate a wrong unit");

    /// Control law: `surepose`, or `paper` for the law of Tran et al. (2012) without the additions of Surepose.
    LAW_NAME = "law" "name", One, one_of::<LawName>();
    /// Gain of the distance to the goal. If unset, it is fitted to the law, the period and the wheel acceleration.
    K_V = "law" "k_v", PerSecond, derived(1000.0, GAIN);
    /// Gain of the bearing to the goal; k_alpha times the period must stay well below 1. If unset, it is fitted like k_v.
    K_ALPHA = "law" "k_alpha", PerSecond, derived(1000.0, GAIN);
    /// Weight of the direction of approach, relative to the bearing, in the global Lyapunov function. If unset, it
    /// depends on the law.
    H = "law" "h", One, derived(100.0, GAIN);
    /// Gain of the heading error near the goal. If unset, it is fitted like k_v.
    K_THETA = "law" "k_theta", PerSecond, derived(1000.0, GAIN);
    /// Braking before the goal. `even` decelerates within the wheel acceleration limit. `gains` uses the unmodified
    /// gains, so that deceleration grows with speed. `auto` means `even`, unless k_v or k_alpha is set or the law is `paper`.
    BRAKING = "law" "braking", One, one_of::<BrakingMode>();
    /// Distance from the goal at which steering fades out. The local law takes over at a quarter of it. The law `paper`
    /// switches abruptly at this distance, by default 0.02 m.
    CAPTURE_RADIUS = "law" "capture_radius_m", Meter,
        positive(1.0, 0.033, "at distance 0 the bearing is pure noise, and beyond 1 m turning in place does not park the robot");
    /// Standard deviation of the white, tick-to-tick noise of the estimated position. It sets a deadband near the goal,
    /// within which the robot stays at rest. 0 disables the deadband; use 0 if the error changes slowly, as a filter's does.
    POSITION_NOISE = "law" "position_noise_m", Meter,
        in_range(0.0, 0.1, 0.0, "a standard deviation is not negative, and no robot parks with more than 0.1 m");
    /// Travel direction. `auto` selects the direction that needs less turning.
    DIRECTION = "law" "direction", One, one_of::<Direction>();

    /// Maximum distance from the goal at which the position counts as reached.
    POSITION_TOLERANCE = "goal" "position_tolerance_m", Meter,
        positive(1.0, 0.01, "no robot reaches a point exactly");
    /// Maximum heading error at which the heading counts as reached.
    HEADING_TOLERANCE = "goal" "heading_tolerance_deg", Degree,
        positive(180.0, 1.0, "no robot reaches a heading exactly");
    /// Dwell time: how long the robot must stay within the tolerances without interruption.
    HOLD = "goal" "hold_s", Second, in_range(0.0, 60.0, 1.0, "a dwell time is not negative and is at most one minute");
    /// Hysteresis: factor on both tolerances once the robot is inside, so that noise does not restart the dwell time.
    TOLERANCE_RELEASE = "goal" "tolerance_release", One,
        in_range(1.0, 10.0, 1.5, "below 1 the robot would leave the tolerance by entering it");

    /// Wheel-speed variance divided by the squared wheel speed: δ in [Tran2012] Eq. (15). A noise of 5 % is 0.0025.
    DELTA = "filter" "delta", One,
        positive(1.0, 0.0025, "a variance is positive, and above 1 odometry carries no information");
    /// Probability that a measurement consistent with the model passes the χ² gate.
    GATE_PROBABILITY = "filter" "gate_probability", One,
        in_range(0.5, 0.999_999_999, 0.999_999, "below 0.5 most valid measurements are rejected, and a gate of 1 rejects none");
    /// Length of the history in which the filter inserts delayed measurements at their stamps.
    HISTORY = "filter" "history_s", Second,
        in_range(0.0, 10.0, 1.0, "a duration is not negative, and the filter stores at most 10 s");
    /// Integration of odometry: along the exact circular arc (`arc`), or by the midpoint rule of the paper (`midpoint`).
    INTEGRATION = "filter" "integration", One, one_of::<Integration>();

    /// Standard deviation of the compass heading.
    COMPASS_STD = "compass" "std_deg", Degree, positive(180.0, 0.1, SIGMA);
    /// Compass reading when the robot faces along the x axis of the map.
    COMPASS_OFFSET = "compass" "offset_deg", Degree, in_range(-360.0, 360.0, 0.0, TURN);
    /// Source of the rotation of the compass relative to the robot, for ROS 2: included in offset_deg (`config`), or the transform
    /// from the frame of the messages to the base frame (`tf_static`). `auto` is `config` unless offset_deg is 0.
    COMPASS_MOUNTING = "compass" "mounting", One, one_of::<MountingSource>();
    /// Delay between a compass measurement and its stamp, which is subtracted; negative for a stamp that is early. Simulated
    /// measurements arrive with this delay.
    COMPASS_LATENCY = "compass" "latency_s", Second, in_range(-1.0, 10.0, 0.0, LATENCY);

    /// Standard deviation of the constant error of the compass: declination, offset_deg, iron nearby. The filter considers it and
    /// does not estimate it; 0 leaves it out.
    COMPASS_BIAS_STD = "compass" "bias_std_deg", Degree, in_range(0.0, 90.0, 0.0, MODEL_ERROR);
    /// Standard deviation of the compass's latency_s, considered like bias_std_deg.
    COMPASS_LATENCY_STD = "compass" "latency_std_s", Second, in_range(0.0, 1.0, 0.0, MODEL_ERROR);

    /// Standard deviation of one reading of the gyroscope's yaw rate.
    GYROSCOPE_STD = "gyroscope" "std_deg_s", DegreePerSecond, positive(100.0, 0.3, SIGMA);
    /// Standard deviation of the gyroscope's bias at the start. The filter estimates the bias.
    GYROSCOPE_BIAS_STD = "gyroscope" "bias_std_deg_s", DegreePerSecond, positive(100.0, 1.0, SIGMA);
    /// Random walk of the gyroscope's bias: the standard deviation of its change in one second.
    GYROSCOPE_BIAS_WALK = "gyroscope" "bias_walk_deg_s", DegreePerSecond,
        in_range(0.0, 10.0, 0.01, "a standard deviation is not negative, and a bias that walks faster is noise");

    /// Standard deviation of a laser range.
    LASER_RANGE_STD = "laser" "range_std_m", Meter, positive(10.0, 0.03, SIGMA);
    /// Standard deviation of the direction of a laser beam.
    LASER_BEARING_STD = "laser" "bearing_std_deg", Degree, positive(90.0, 0.25, SIGMA);
    /// Position of the laser along the x axis of the robot, forward of the wheel axle.
    LASER_X = "laser" "x_m", Meter, in_range(-10.0, 10.0, 0.0, "the laser is mounted on the robot");
    /// Position of the laser along the y axis of the robot, to the left of its center line.
    LASER_Y = "laser" "y_m", Meter, in_range(-10.0, 10.0, 0.0, "the laser is mounted on the robot");
    /// Yaw of the laser relative to the robot, counter-clockwise: the direction of beam angle 0.
    LASER_HEADING = "laser" "heading_deg", Degree, in_range(-360.0, 360.0, 0.0, TURN);
    /// Source of the pose of the laser, for ROS 2: x_m, y_m and heading_deg (`config`), or the transform from the frame of the scans
    /// to the base frame (`tf_static`). `auto` is `config` unless all three are 0.
    LASER_MOUNTING = "laser" "mounting", One, one_of::<MountingSource>();
    /// Delay between a scan and its stamp, which is subtracted; negative for a stamp that is early. Simulated scans arrive
    /// with this delay.
    LASER_LATENCY = "laser" "latency_s", Second, in_range(-1.0, 10.0, 0.0, LATENCY);
    /// Time from the first beam of a scan to its last. Each beam is moved by odometry to the middle of the sweep. If unset,
    /// the time increment of each scan message counts; 0 takes all beams at the stamp.
    LASER_SWEEP = "laser" "sweep_s", Second,
        in_range(0.0, 1.0, 0.0, "a sweep takes time, and one of more than 1 s is not used");
    /// Beam that the stamp of a scan belongs to: `first`, as in ROS, `middle` or `last`.
    LASER_STAMP = "laser" "stamp", One, one_of::<StampedBeam>();
    /// Standard deviation of x_m and of y_m. A constant error that the filter considers and does not estimate; 0 leaves it out.
    LASER_POSITION_STD = "laser" "position_std_m", Meter, in_range(0.0, 1.0, 0.0, MODEL_ERROR);
    /// Standard deviation of heading_deg, considered like position_std_m.
    LASER_HEADING_STD = "laser" "heading_std_deg", Degree, in_range(0.0, 90.0, 0.0, MODEL_ERROR);
    /// Standard deviation of the relative error that all ranges share, considered like position_std_m.
    LASER_RANGE_SCALE_STD = "laser" "range_scale_std", One, in_range(0.0, 0.2, 0.0, MODEL_ERROR);
    /// Standard deviation of the laser's latency_s, considered like position_std_m.
    LASER_LATENCY_STD = "laser" "latency_std_s", Second, in_range(0.0, 1.0, 0.0, MODEL_ERROR);
    /// Field of view of the simulated laser, centered on its x axis.
    LASER_FIELD_OF_VIEW = "laser" "field_of_view_deg", Degree,
        positive(360.0, 180.0, "a laser sees something, and at most one turn");
    /// Number of beams of the simulated laser over its field of view.
    LASER_BEAMS = "laser" "beams", One,
        integer(2.0, 4096.0, 181, "a line needs two beams, and a scan holds at most 4096");

    /// Standard deviation of the position of each wall, across the wall. A constant error of the map that the filter considers and
    /// does not estimate; 0 leaves it out.
    WALL_STD = "map" "wall_std_m", Meter, in_range(0.0, 1.0, 0.0, MODEL_ERROR);

    /// Delay between the true time of a landmark observation and its stamp.
    CAMERA_LATENCY = "camera" "latency_s", Second, in_range(0.0, 10.0, 0.03, CAMERA_LATENCY_REASON);
    /// Ratio of the measured depth of a landmark to its true depth.
    CAMERA_SCALE = "camera" "scale", One,
        in_range(0.5, 2.0, 1.04, "a scale error by a factor of two means that the camera is not calibrated");
    /// Standard deviation of a landmark depth at zero depth.
    CAMERA_DEPTH_STD = "camera" "depth_std_m", Meter, positive(10.0, 0.02, SIGMA);
    /// Increase of the standard deviation of the depth per meter of depth.
    CAMERA_DEPTH_STD_PER_METER = "camera" "depth_std_per_metre", One,
        in_range(0.0, 1.0, 0.012, "the standard deviation does not shrink with depth, and above 1 a depth carries no information");
    /// Standard deviation of a landmark's bearing.
    CAMERA_BEARING_STD = "camera" "bearing_std_deg", Degree, positive(90.0, 0.6, SIGMA);
    /// Correlation time of observation errors: repeated observations within this time are not independent.
    CAMERA_CORRELATION_TIME = "camera" "correlation_time_s", Second,
        in_range(0.0, 1000.0, 4.0, "a duration is not negative");
    /// Time between two camera images.
    CAMERA_FRAME_PERIOD = "camera" "frame_period_s", Second,
        positive(10.0, 0.23, "a camera needs time between two images");

    /// Dead time between a velocity command and its effect. It applies to recordings that hold commands instead of wheel ticks.
    COMMAND_DEAD_TIME = "commands" "dead_time_s", Second, in_range(0.0, 10.0, 0.18, "a delay is not negative");
    /// Ratio of the actual speed to the commanded speed.
    COMMAND_SPEED_GAIN = "commands" "speed_gain", One,
        in_range(0.1, 10.0, 1.05, "a base with a factor of ten does not follow its commands");
    /// Ratio of the actual turn rate to the commanded turn rate.
    COMMAND_TURN_GAIN = "commands" "turn_gain", One,
        in_range(0.1, 10.0, 0.955, "a base with a factor of ten does not follow its commands");
    /// Distance lost per radian of rotation while driving.
    COMMAND_WAY_LOST = "commands" "way_lost_per_radian_m", Meter,
        in_range(0.0, 1.0, 0.096, "rotation does not add distance");
    /// Variance of the rim travel per meter driven by command, in m².
    RIM_VARIANCE_PER_METER = "commands" "rim_variance_per_metre", One,
        positive(1.0, 1.5e-4, "a variance is positive");
    /// Variance of the rim travel per radian turned by command, in m².
    RIM_VARIANCE_PER_RADIAN = "commands" "rim_variance_per_radian", One,
        positive(1.0, 7e-4, "a variance is positive");

    /// Distance between the robot's outline and the walls of the map that stays free.
    WALL_CLEARANCE = "safety" "wall_clearance_m", Meter,
        in_range(0.0, 2.0, 0.05, "a distance is not negative, and 2 m close every door");
    /// Factor on the predicted distance to rest: wheels slip and motors overshoot.
    TRAVEL_FACTOR = "safety" "travel_factor", One,
        in_range(1.0, 3.0, 1.2, "below 1 the prediction would be shorter than the command");
    /// Time from a command to the response of the drive, for the predicted distance to rest.
    RESPONSE_TIME = "safety" "response_time_s", Second,
        in_range(0.0, 5.0, 0.05, "a drive does not respond before its command");
    /// Time without a scan after which the obstacle check counts as unavailable and the robot stops.
    SCAN_TIMEOUT = "safety" "scan_timeout_s", Second, positive(60.0, 1.0, TIMEOUT_REASON);
    /// Time for which all scans are unusable, or empty where the map has walls, after which the robot stops as `laser_blind`.
    LASER_BLIND_TIMEOUT = "safety" "laser_blind_timeout_s", Second, positive(60.0, 0.3, TIMEOUT_REASON);
    /// Smallest fraction of the beams that must be valid, and of the beams at walls of the map that must return.
    MIN_VALID_BEAMS = "safety" "min_valid_beams", One,
        in_range(0.0, 1.0, 0.1, "a share lies between 0 and 1");
    /// Time without odometry after which the robot stops.
    ODOMETRY_TIMEOUT = "safety" "odometry_timeout_s", Second, positive(60.0, 0.5, TIMEOUT_REASON);
    /// Time without an accepted measurement of the pose after which the robot slows down.
    AIDING_TIMEOUT = "safety" "aiding_timeout_s", Second, positive(3600.0, 5.0, TIMEOUT_REASON);
    /// Time after which a stopped or blocked robot gives its goal up.
    GOAL_TIMEOUT = "safety" "goal_timeout_s", Second, positive(3600.0, 10.0, TIMEOUT_REASON);
    /// Time without motion, though motion is commanded, after which the goal is aborted as `stalled` or `blocked`.
    STALL_TIMEOUT = "safety" "stall_timeout_s", Second, positive(60.0, 4.0, TIMEOUT_REASON);
    /// Time without progress, by the Lyapunov function, after which the goal is aborted as `no_progress`.
    PROGRESS_TIMEOUT = "safety" "progress_timeout_s", Second, positive(3600.0, 20.0, TIMEOUT_REASON);
    /// Smallest share of the beams that must end at a wall of the map; a scan with less contradicts the map.
    MIN_HIT_RATIO = "safety" "min_hit_ratio", One,
        in_range(0.0, 1.0, 0.55, "a share lies between 0 and 1");
    /// Largest share of the beams that may end behind a wall of the map.
    MAX_BEHIND_WALL_RATIO = "safety" "max_behind_wall_ratio", One,
        in_range(0.0, 1.0, 0.12, "a share lies between 0 and 1");
    /// Largest mean of the normalized innovation squared per row, which is 1 for a consistent filter.
    MAX_MEAN_NIS = "safety" "max_mean_nis", One,
        in_range(1.0, 1000.0, 3.0, "a consistent filter has 1");
    /// Largest mean difference between commanded and measured turn rate of a wheel, in rad/s.
    MAX_WHEEL_RATE_ERROR = "safety" "max_wheel_rate_error_rad_s", One,
        positive(1000.0, 2.0, "wheels follow their commands with some error");
    /// Standard deviation of the position beyond which the robot slows down.
    SLOW_STD = "safety" "slow_std_m", Meter, positive(100.0, 0.5, "no position is exact");
    /// Standard deviation of the position beyond which the robot stops.
    STOP_STD = "safety" "stop_std_m", Meter, positive(1000.0, 2.0, "no position is exact");
    /// Turn rate of a lost robot that looks around.
    SEARCH_TURN_RATE = "safety" "search_turn_rate_deg_s", DegreePerSecond,
        in_range(0.0, 360.0, 46.0, "a faster turn blurs the scans");

    /// Time between two ticks of the loop.
    PERIOD = "loop" "period_s", Second,
        in_range(0.001, 1.0, 0.1, "wheels do not follow commands faster than 1 ms, and above 1 s the loop is too slow to control");

    /// Simulated environment: the arena of the paper, the same arena without its plates (`open`), or the `loop` world.
    ARENA = "scenario" "arena", One, one_of::<ArenaName>();
    /// Start position of the simulated robot, x.
    START_X = "scenario" "start_x_m", Meter, in_range(-10_000.0, 10_000.0, 0.0, PLACE);
    /// Start position of the simulated robot, y.
    START_Y = "scenario" "start_y_m", Meter, in_range(-10_000.0, 10_000.0, 0.0, PLACE);
    /// Start heading of the simulated robot.
    START_HEADING = "scenario" "start_heading_deg", Degree, in_range(-360.0, 360.0, 0.0, TURN);
    /// Goal position, x.
    GOAL_X = "scenario" "goal_x_m", Meter, in_range(-10_000.0, 10_000.0, 2.0, PLACE);
    /// Goal position, y.
    GOAL_Y = "scenario" "goal_y_m", Meter, in_range(-10_000.0, 10_000.0, 2.0, PLACE);
    /// Goal heading.
    GOAL_HEADING = "scenario" "goal_heading_deg", Degree, in_range(-360.0, 360.0, 30.0, TURN);
    /// Simulated time after which the run ends with the outcome `timeout`.
    TIMEOUT = "scenario" "timeout_s", Second,
        positive(3600.0, 120.0, "a run takes time, and one of more than an hour is stuck");
}
