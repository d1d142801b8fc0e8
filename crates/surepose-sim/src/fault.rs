//! What goes wrong, and when: for tests of what the estimator and the law make of it.

use core::ops::Range;

use surepose::time::Stamp;

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
pub enum FaultKind {
    /// The sensor says nothing; encoders count nothing.
    Dropout(Sensor),
    /// Every value of the sensor is NaN.
    NotANumber(Sensor),
    /// Every value is off by this much: rims by a factor, the compass in rad, the laser's ranges in m.
    Offset(Sensor, f64),
    /// Messages carry a stamp this much too early \[s].
    StampOffset(Sensor, f64),
    /// The robot is lifted, once, and put down this much farther (x \[m], y \[m]) and turned \[rad].
    Displaced([f64; 3]),
}

/// Something that goes wrong for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// When it does; a push happens at the start.
    pub during: Range<Stamp>,
    /// What it is.
    pub kind: FaultKind,
}

impl Fault {
    /// `kind`, from `start` to `end` \[s].
    pub fn between(start: f64, end: f64, kind: FaultKind) -> Self {
        Self { during: Stamp::from_seconds(start)..Stamp::from_seconds(end), kind }
    }

    /// `kind`, once, at `time` \[s].
    pub fn at(time: f64, kind: FaultKind) -> Self {
        Self::between(time, time, kind)
    }
}

/// What the faults of a moment make of one sensor's values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Disturbance {
    pub(crate) dropout: bool,
    /// Added to values; NaN where they are broken.
    pub(crate) offset: f64,
    pub(crate) stamp_offset: f64,
}

/// What `faults` do to `sensor` at `now`.
pub(crate) fn disturbance(faults: &[Fault], sensor: Sensor, now: Stamp) -> Disturbance {
    let mut result = Disturbance::default();
    for fault in faults.iter().filter(|fault| fault.during.contains(&now)) {
        match fault.kind {
            FaultKind::Dropout(s) if s == sensor => result.dropout = true,
            FaultKind::NotANumber(s) if s == sensor => result.offset = f64::NAN,
            FaultKind::Offset(s, size) if s == sensor => result.offset += size,
            FaultKind::StampOffset(s, seconds) if s == sensor => result.stamp_offset += seconds,
            _ => {}
        }
    }
    result
}
