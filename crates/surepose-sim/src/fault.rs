//! What goes wrong, and when: for tests of what the estimator and the law make of it.

use core::ops::Range;

use surepose::Stamp;

/// A sensor of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sensor {
    /// The wheels' encoders.
    Encoders,
    /// The compass.
    Compass,
    /// The laser range finder.
    Laser,
}

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The sensor says nothing; encoders count nothing.
    Silent(Sensor),
    /// Every value of the sensor is NaN.
    NotANumber(Sensor),
    /// Every value is off by this much: rims by a factor, the compass in rad, the laser's ranges in m.
    Offset(Sensor, f64),
    /// Messages carry a stamp this much too early \[s].
    Backdated(Sensor, f64),
    /// The robot is lifted, once, and put down this much farther (x \[m], y \[m]) and turned \[rad].
    Pushed([f64; 3]),
}

/// Something that goes wrong for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// When it does; a push happens at the start.
    pub during: Range<Stamp>,
    /// What it is.
    pub kind: Kind,
}

impl Fault {
    /// `kind`, from `start` to `end` \[s].
    pub fn between(start: f64, end: f64, kind: Kind) -> Self {
        Self { during: Stamp::from_seconds(start)..Stamp::from_seconds(end), kind }
    }

    /// `kind`, once, at `time` \[s].
    pub fn at(time: f64, kind: Kind) -> Self {
        Self::between(time, time, kind)
    }
}

/// What the faults of a moment make of one sensor's values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Disturbance {
    pub(crate) silent: bool,
    /// Added to values; NaN where they are broken.
    pub(crate) offset: f64,
    pub(crate) backdated: f64,
}

/// What `faults` do to `sensor` at `now`.
pub(crate) fn disturbance(faults: &[Fault], sensor: Sensor, now: Stamp) -> Disturbance {
    let mut result = Disturbance::default();
    for fault in faults.iter().filter(|fault| fault.during.contains(&now)) {
        match fault.kind {
            Kind::Silent(s) if s == sensor => result.silent = true,
            Kind::NotANumber(s) if s == sensor => result.offset = f64::NAN,
            Kind::Offset(s, size) if s == sensor => result.offset += size,
            Kind::Backdated(s, seconds) if s == sensor => result.backdated += seconds,
            _ => {}
        }
    }
    result
}
