//! Parameters that describe a simulated world: those of the robot's table that have a true value, and those that
//! only a world has.

use surepose::impl_choice;
use surepose::param::{self, Parameter, in_range, integer, one_of, positive};
use surepose_config::ParameterSet;

/// Response of the motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorKind {
    /// Motors with lag, friction and ripple under a speed controller.
    Pid,
    /// Wheels that follow their setpoints exactly.
    Ideal,
}

impl_choice!(MotorKind { Pid = "pid", Ideal = "ideal" });

/// Whether the robot has a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Installed {
    /// It has none.
    No,
    /// It has one.
    Yes,
}

impl_choice!(Installed { No = "no", Yes = "yes" });

/// Wheels that do not turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldWheels {
    /// Both wheels turn.
    None,
    /// The left wheel is held.
    Left,
    /// The right wheel is held.
    Right,
    /// Both wheels are held.
    Both,
}

impl_choice!(HeldWheels { None = "none", Left = "left", Right = "right", Both = "both" });

/// Fault of the laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaserFault {
    /// No fault.
    None,
    /// No beam returns: every range is +∞.
    Infinite,
    /// Every range is NaN.
    NotANumber,
    /// Every range is 0.
    Zero,
    /// Every range is negative.
    Negative,
    /// Scans have no ranges.
    Empty,
    /// Scans repeat the last one before the fault.
    Frozen,
    /// There are no scans.
    Silent,
}

impl_choice!(LaserFault {
    None = "none",
    Infinite = "infinite",
    NotANumber = "nan",
    Zero = "zero",
    Negative = "negative",
    Empty = "empty",
    Frozen = "frozen",
    Silent = "silent",
});

/// Fault of the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompassFault {
    /// No fault.
    None,
    /// Every heading is NaN.
    NotANumber,
    /// There are no headings.
    Silent,
}

impl_choice!(CompassFault { None = "none", NotANumber = "nan", Silent = "silent" });

const FOREVER: &str = "a duration is positive, and no run is longer than an hour";
const FROM: &str = "a fault begins during the run, and no run is longer than an hour";

surepose::parameters! {
    /// Response of the motors: `pid` for motors with lag, friction and ripple under a speed controller, `ideal` for wheels
    /// that follow their setpoints exactly.
    MOTOR_MODEL = "motor" "model", One, one_of::<MotorKind>();
    /// Rim speed that starts a stopped wheel (stiction); a turning wheel turns on down to robot.min_wheel_speed_m_s. 0
    /// disables it.
    BREAKAWAY_SPEED = "motor" "breakaway_speed_m_s", MeterPerSecond,
        in_range(0.0, 10.0, 0.0, "a speed is not negative, and 10 m/s is beyond this class of robot");
    /// Encoder ticks per wheel turn.
    ENCODER_TICKS = "motor" "encoder_ticks", One,
        integer(1.0, 1e7, 20_000, "an encoder has at least one tick per turn");

    /// Fraction of the wheel travel that does not move the robot. The encoders report the whole travel.
    SLIP_RATIO = "slip" "ratio", One, in_range(0.0, 0.99, 0.0, "at 1 the robot cannot move");
    /// Maximum acceleration that the floor transmits to a wheel; a wheel that accelerates faster spins. Unset, wheels never
    /// spin.
    TRACTION_LIMIT = "slip" "traction_limit_m_s2", MeterPerSecondSquared,
        positive(1000.0, 1000.0, "at 0 the robot cannot move");

    /// Ratio of the robot's map to the true arena: 1.01 for a map that is 1 % too large, about its origin.
    MAP_SCALE = "map" "scale", One, in_range(0.5, 2.0, 1.0, "a map of twice the size is of another place");

    /// Change of the compass's offset, at a constant rate.
    COMPASS_DRIFT = "compass" "drift_deg_s", DegreePerSecond,
        in_range(-10.0, 10.0, 0.0, "a compass that turns faster is broken");

    /// Fraction of the laser's beams that obstacles on no map hide.
    CLUTTER = "clutter" "fraction", One, in_range(0.0, 0.99, 0.0, "with all beams hidden the laser shows no wall");
    /// Mean number of adjacent beams that one of these obstacles hides.
    CLUTTER_WIDTH = "clutter" "width_beams", One,
        in_range(1.0, 1000.0, 8.0, "an obstacle hides at least one beam");

    /// Whether the robot has a gyroscope that measures the yaw rate.
    GYROSCOPE = "gyroscope" "installed", One, one_of::<Installed>();
    /// Mean of the gyroscope's bias at the start.
    GYROSCOPE_BIAS = "gyroscope" "bias_deg_s", DegreePerSecond,
        in_range(-100.0, 100.0, 0.0, "a bias beyond 100 °/s is a broken sensor");

    /// Wheels that do not turn, whatever their motors do.
    HELD_WHEELS = "fault" "held_wheels", One, one_of::<HeldWheels>();
    /// Time from which the wheels are held.
    HELD_FROM = "fault" "held_from_s", Second, in_range(0.0, 3600.0, 0.0, FROM);
    /// Fault of the laser: every range `infinite`, `nan`, `zero` or `negative`, scans that are `empty` or repeat the last one
    /// (`frozen`), or no scans at all (`silent`).
    LASER_FAULT = "fault" "laser", One, one_of::<LaserFault>();
    /// Time from which the laser is faulty.
    LASER_FAULT_FROM = "fault" "laser_from_s", Second, in_range(0.0, 3600.0, 0.0, FROM);
    /// Duration of the fault of the laser. The default lasts to the end.
    LASER_FAULT_DURATION = "fault" "laser_duration_s", Second, positive(3600.0, 3600.0, FOREVER);
    /// Fault of the compass: every heading `nan`, or no headings at all (`silent`).
    COMPASS_FAULT = "fault" "compass", One, one_of::<CompassFault>();
    /// Time from which the compass is faulty.
    COMPASS_FAULT_FROM = "fault" "compass_from_s", Second, in_range(0.0, 3600.0, 0.0, FROM);
    /// Duration of the fault of the compass. The default lasts to the end.
    COMPASS_FAULT_DURATION = "fault" "compass_duration_s", Second, positive(3600.0, 3600.0, FOREVER);
}

/// Parameters of the robot's table that have a true value in the world.
const TRUE_VALUES: &[&Parameter] = &[
    &param::WHEEL_RADIUS,
    &param::WHEEL_RADIUS_RATIO,
    &param::WHEEL_SEPARATION,
    &param::WHEEL_SPEED_LIMIT,
    &param::WHEEL_ACCELERATION_LIMIT,
    &param::WHEEL_DECELERATION_LIMIT,
    &param::MIN_WHEEL_SPEED,
    &param::MIN_SPEED,
    &param::MIN_TURN_RATE,
    &param::COMMAND_DELAY,
    &param::MOTOR_TIME_CONSTANT,
    &param::DELTA,
    &param::COMPASS_STD,
    &param::COMPASS_OFFSET,
    &param::COMPASS_LATENCY,
    &param::GYROSCOPE_STD,
    &param::GYROSCOPE_BIAS_STD,
    &param::GYROSCOPE_BIAS_WALK,
    &param::LASER_RANGE_STD,
    &param::LASER_BEARING_STD,
    &param::LASER_X,
    &param::LASER_Y,
    &param::LASER_HEADING,
    &param::LASER_LATENCY,
    &param::LASER_SWEEP,
    &param::LASER_STAMP,
    &param::LASER_FIELD_OF_VIEW,
    &param::LASER_BEAMS,
    &param::ARENA,
    &param::START_X,
    &param::START_Y,
    &param::START_HEADING,
];

/// Parameters that have no effect unless another one has an option other than its first.
pub(crate) const DEPENDENT: &[(&Parameter, &Parameter)] = &[
    (&GYROSCOPE_BIAS, &GYROSCOPE),
    (&param::GYROSCOPE_STD, &GYROSCOPE),
    (&param::GYROSCOPE_BIAS_STD, &GYROSCOPE),
    (&param::GYROSCOPE_BIAS_WALK, &GYROSCOPE),
    (&CLUTTER_WIDTH, &CLUTTER),
    (&HELD_FROM, &HELD_WHEELS),
    (&LASER_FAULT_FROM, &LASER_FAULT),
    (&LASER_FAULT_DURATION, &LASER_FAULT),
    (&COMPASS_FAULT_FROM, &COMPASS_FAULT),
    (&COMPASS_FAULT_DURATION, &COMPASS_FAULT),
];

/// Returns every parameter of a world, sections contiguous; the first ones are of the robot's table.
pub fn world_parameters() -> ParameterSet {
    ParameterSet::new(TRUE_VALUES.iter().copied().chain(ALL), "surepose run --world help")
}

/// Returns the parameters of the base alone: wheels, drive, limits and grip.
pub fn base_parameters() -> ParameterSet {
    let describes_base = |p: &&Parameter| match p.section {
        "robot" | "slip" => true,
        _ => *p == &BREAKAWAY_SPEED,
    };
    ParameterSet::new(world_parameters().iter().filter(describes_base), "surepose sweep --world help")
}
