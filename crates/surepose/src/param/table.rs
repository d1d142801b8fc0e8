//! The table itself. The sentence above an entry is its documentation here, in help, in errors and in ROS.

use super::{Kind, Parameter, Range, Unit};

const fn in_range(low: f64, high: f64, default: f64, reason: &'static str) -> Kind {
    Kind::Number { default, range: Range { low, low_inclusive: true, high, reason } }
}

const fn positive(high: f64, default: f64, reason: &'static str) -> Kind {
    Kind::Number { default, range: Range { low: 0.0, low_inclusive: false, high, reason } }
}

const fn integer(low: f64, high: f64, default: u32, reason: &'static str) -> Kind {
    Kind::Integer { default, range: Range { low, low_inclusive: true, high, reason } }
}

const fn one_of(options: &'static [&'static str]) -> Kind {
    Kind::Choice { options }
}

macro_rules! parameters {
    ($($(#[doc = $meaning:literal])+ $name:ident = $section:literal $key:literal, $unit:ident, $kind:expr;)*) => {
        $(
            $(#[doc = $meaning])+
            pub const $name: Parameter = Parameter {
                section: $section,
                key: $key,
                unit: Unit::$unit,
                kind: $kind,
                meaning: concat!($($meaning),+),
            };
        )*

        /// Every parameter, section by section.
        pub const ALL: &[Parameter] = &[$($name),*];
    };
}

const SIGMA: &str = "a standard deviation is positive; zero would claim a perfect sensor";
const LATENCY: &str = "a measurement is taken before it arrives, and the history reaches back 10 s at most";
const GAIN: &str = "the Lyapunov derivative is negative only for positive gains";
const TIMEOUT_REASON: &str = "a time-out is positive";
const PLACE: &str = "a place farther than 10 km away is a mistake of unit";
const TURN: &str = "an angle beyond one turn is a mistake of unit";

parameters! {
    /// Radius of the drive wheels; where they differ, the mean of the two.
    WHEEL_RADIUS = "robot" "wheel_radius_m", Meter,
        in_range(0.001, 1.0, 0.05, "a wheel of less than a millimetre, or of more than a metre, is a mistake of unit");
    /// Radius of the right drive wheel over that of the left one.
    WHEEL_RADIUS_RATIO = "robot" "wheel_radius_ratio", One,
        in_range(0.5, 2.0, 1.0, "wheels that differ by a factor of two are no pair");
    /// Distance between the contact points of the two drive wheels.
    WHEEL_SEPARATION = "robot" "track_m", Meter,
        in_range(0.01, 5.0, 0.6, "wheels less than a centimetre apart, or more than 5 m, are a mistake of unit");
    /// Largest speed of a wheel's rim. Faster wishes are slowed down along their path.
    WHEEL_SPEED_LIMIT = "robot" "wheel_speed_limit_m_s", MeterPerSecond,
        positive(10.0, 0.3, "a robot whose wheels may not turn goes nowhere, and 10 m/s is beyond this class");
    /// Largest change of a rim's speed per second.
    WHEEL_ACCELERATION_LIMIT = "robot" "wheel_acceleration_limit_m_s2", MeterPerSecondSquared,
        positive(1000.0, 0.5, "a wheel that may not accelerate never turns");

    /// The control law: this program's own, or the paper's without its additions.
    LAW_NAME = "law" "name", One, one_of(&["surepose", "paper"]);
    /// Gain of the distance to the goal. Unless set, it fits the law, the period and the wheels' acceleration.
    K_V = "law" "k_v", PerSecond, positive(1000.0, 2.0, GAIN);
    /// Gain of the goal's bearing; times the period it must stay well under 1. Unless set, it fits like k_v.
    K_ALPHA = "law" "k_alpha", PerSecond, positive(1000.0, 2.4, GAIN);
    /// Weight of the direction of approach against the bearing in the global Lyapunov function.
    H = "law" "h", One, positive(100.0, 0.3, GAIN);
    /// Gain of the heading error near the goal. Unless set, it fits like k_v.
    K_THETA = "law" "k_theta", PerSecond, positive(1000.0, 2.788_866_755_113_585, GAIN);
    /// How the robot slows down for its goal: `even`, as its wheels' acceleration allows, or by the `gains` alone, the harder
    /// the faster it runs. `auto` is even unless k_v or k_alpha is set, who sets them means them, or the law is the paper's.
    BRAKING = "law" "braking", One, one_of(&["auto", "even", "gains"]);
    /// Distance from the goal at which steering fades; the local law takes over at a quarter of it. The law `paper` switches
    /// at once, at 0.01 m unless this is set.
    CAPTURE_RADIUS = "law" "capture_radius_m", Meter,
        positive(1.0, 0.033, "the bearing of a goal at distance 0 is noise, and beyond 1 m turning in place parks nothing");
    /// Standard deviation of the estimated position, white from tick to tick, that the law is told of: near the goal the
    /// robot rests rather than follow it. 0 for an estimate whose error changes slowly, as a filter's does.
    POSITION_NOISE = "law" "position_noise_m", Meter,
        in_range(0.0, 0.1, 0.0, "a standard deviation is not negative, and with more than 0.1 m no robot parks");
    /// Which end of the robot goes first; `auto` takes the way with less turning.
    DIRECTION = "law" "direction", One, one_of(&["auto", "forward", "reverse"]);

    /// Largest distance from the goal that counts as being there.
    POSITION_TOLERANCE = "goal" "position_tolerance_m", Meter,
        positive(1.0, 0.01, "no robot reaches a point exactly");
    /// Largest heading error that counts as being there.
    HEADING_TOLERANCE = "goal" "heading_tolerance_deg", Degree,
        positive(180.0, 1.0, "no robot reaches a heading exactly");
    /// How long the robot must be there without a break.
    HOLD = "goal" "hold_s", Second, in_range(0.0, 60.0, 1.0, "a hold time is not negative, and a minute is long");
    /// How much wider the tolerance is once inside, so that noise does not break the hold.
    TOLERANCE_RELEASE = "goal" "tolerance_release", One,
        in_range(1.0, 10.0, 1.5, "below 1 arriving would undo itself");

    /// Variance of a wheel's speed over the speed squared: δ of the paper's Eq. (15), so 5 % is 0.0025.
    DELTA = "filter" "delta", One,
        positive(1.0, 0.0025, "a variance is positive; above 1 odometry says nothing");
    /// Probability that a measurement the model explains passes the χ² gate.
    GATE_PROBABILITY = "filter" "gate_probability", One,
        in_range(0.5, 0.999_999_999, 0.999_999, "below 0.5 good measurements are lost, and a gate of 1 refuses nothing");
    /// How far back a late measurement is still put in its place.
    HISTORY = "filter" "history_s", Second,
        in_range(0.0, 10.0, 1.0, "a history is not negative, and beyond 10 s the memory would not hold it");
    /// How odometry moves the pose: along the exact arc, or by the paper's midpoint rule.
    INTEGRATION = "filter" "integration", One, one_of(&["arc", "midpoint"]);

    /// Standard deviation of the compass.
    COMPASS_STD = "compass" "std_deg", Degree, positive(180.0, 0.1, SIGMA);
    /// What the compass reads when the robot faces along the map's x axis.
    COMPASS_OFFSET = "compass" "offset_deg", Degree, in_range(-360.0, 360.0, 0.0, TURN);
    /// How long a compass reading is under way.
    COMPASS_LATENCY = "compass" "latency_s", Second, in_range(0.0, 10.0, 0.0, LATENCY);

    /// Standard deviation of a laser range.
    LASER_RANGE_STD = "laser" "range_std_m", Meter, positive(10.0, 0.03, SIGMA);
    /// Standard deviation of a beam's direction.
    LASER_BEARING_STD = "laser" "bearing_std_deg", Degree, positive(90.0, 0.25, SIGMA);
    /// Where the laser sits, ahead of the wheels' axle.
    LASER_X = "laser" "x_m", Meter, in_range(-10.0, 10.0, 0.0, "a sensor sits on the robot");
    /// Where the laser sits, to the left of the robot's middle.
    LASER_Y = "laser" "y_m", Meter, in_range(-10.0, 10.0, 0.0, "a sensor sits on the robot");
    /// Which way the laser's zero bearing points, counter-clockwise from straight ahead.
    LASER_HEADING = "laser" "heading_deg", Degree, in_range(-360.0, 360.0, 0.0, TURN);
    /// How long a scan is under way.
    LASER_LATENCY = "laser" "latency_s", Second, in_range(0.0, 10.0, 0.0, LATENCY);
    /// How many beams the simulated laser has over its 180°.
    LASER_BEAMS = "laser" "beams", One,
        integer(2.0, 4096.0, 181, "a line needs two beams, and a scan holds at most 4096");

    /// How old a camera's sighting of a landmark is at its stamp.
    CAMERA_LATENCY = "camera" "latency_s", Second, in_range(0.0, 10.0, 0.03, LATENCY);
    /// Recorded depth of a landmark over its true depth.
    CAMERA_SCALE = "camera" "scale", One,
        in_range(0.5, 2.0, 1.04, "a camera that is off by a factor of two is not calibrated");
    /// Standard deviation of a depth, near the camera.
    CAMERA_DEPTH_STD = "camera" "depth_std_m", Meter, positive(10.0, 0.02, SIGMA);
    /// Growth of that standard deviation with depth.
    CAMERA_DEPTH_STD_PER_METER = "camera" "depth_std_per_metre", One,
        in_range(0.0, 1.0, 0.012, "a growth is not negative, and above 1 a depth says nothing");
    /// Standard deviation of a landmark's bearing.
    CAMERA_BEARING_STD = "camera" "bearing_std_deg", Degree, positive(90.0, 0.6, SIGMA);
    /// How long the error of a sighting lasts: repeated sightings within that time are not independent.
    CAMERA_CORRELATION_TIME = "camera" "correlation_time_s", Second,
        in_range(0.0, 1000.0, 4.0, "a time is not negative");
    /// Time between two images.
    CAMERA_FRAME_PERIOD = "camera" "frame_period_s", Second,
        positive(10.0, 0.23, "a camera takes time between two images");

    /// How long a commanded velocity shows no effect, where a recording has commands instead of wheel ticks.
    COMMAND_DEAD_TIME = "commands" "dead_time_s", Second, in_range(0.0, 10.0, 0.18, "a delay is not negative");
    /// Speed over commanded speed.
    COMMAND_SPEED_GAIN = "commands" "speed_gain", One,
        in_range(0.1, 10.0, 1.05, "a base that is off by a factor of ten does not follow commands");
    /// Turn rate over commanded turn rate.
    COMMAND_TURN_GAIN = "commands" "turn_gain", One,
        in_range(0.1, 10.0, 0.955, "a base that is off by a factor of ten does not follow commands");
    /// Way lost for each radian turned while driving.
    COMMAND_WAY_LOST = "commands" "way_lost_per_radian_m", Meter,
        in_range(0.0, 1.0, 0.096, "a turn does not push the robot");
    /// Variance of a rim's travel for each metre driven by command, in m².
    RIM_VARIANCE_PER_METER = "commands" "rim_variance_per_metre", One,
        positive(1.0, 1.5e-4, "a variance is positive");
    /// Variance of a rim's travel for each radian turned by command, in m².
    RIM_VARIANCE_PER_RADIAN = "commands" "rim_variance_per_radian", One,
        positive(1.0, 7e-4, "a variance is positive");

    /// Radius of the robot's outline around the middle of its axle. 0 checks the middle alone.
    FOOTPRINT_RADIUS = "robot" "footprint_radius_m", Meter,
        in_range(0.0, 5.0, 0.0, "a radius is not negative, and a robot of more than 5 m is a mistake of unit");
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
    /// Time without odometry after which the robot stops.
    ODOMETRY_TIMEOUT = "safety" "odometry_timeout_s", Second, positive(60.0, 0.5, TIMEOUT_REASON);
    /// Time without an accepted measurement of the pose after which the robot slows down.
    AIDING_TIMEOUT = "safety" "aiding_timeout_s", Second, positive(3600.0, 5.0, TIMEOUT_REASON);
    /// Time after which a stopped or blocked robot gives its goal up.
    GOAL_TIMEOUT = "safety" "goal_timeout_s", Second, positive(3600.0, 10.0, TIMEOUT_REASON);
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
        in_range(0.001, 1.0, 0.1, "below 1 ms no wheel follows; above 1 s the robot drives blind");

    /// Where the simulated robot drives: the paper's arena, the same without its plates, or the loop world.
    ARENA = "scenario" "arena", One, one_of(&["paper", "open", "loop"]);
    /// Where the simulated robot starts, x.
    START_X = "scenario" "start_x_m", Meter, in_range(-10_000.0, 10_000.0, 0.0, PLACE);
    /// Where the simulated robot starts, y.
    START_Y = "scenario" "start_y_m", Meter, in_range(-10_000.0, 10_000.0, 0.0, PLACE);
    /// Which way the simulated robot faces at the start.
    START_HEADING = "scenario" "start_heading_deg", Degree, in_range(-360.0, 360.0, 0.0, TURN);
    /// Where the robot shall come to rest, x.
    GOAL_X = "scenario" "goal_x_m", Meter, in_range(-10_000.0, 10_000.0, 2.0, PLACE);
    /// Where the robot shall come to rest, y.
    GOAL_Y = "scenario" "goal_y_m", Meter, in_range(-10_000.0, 10_000.0, 2.0, PLACE);
    /// Which way the robot shall face in the end.
    GOAL_HEADING = "scenario" "goal_heading_deg", Degree, in_range(-360.0, 360.0, 30.0, TURN);
    /// When to give up, in simulated time.
    TIMEOUT = "scenario" "timeout_s", Second,
        positive(3600.0, 120.0, "a drive takes time, and one that takes an hour is stuck");
}
