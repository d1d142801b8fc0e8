//! Fault injection for tests of the estimator and the control law.

use core::ops::Range;

use surepose::time::Stamp;

/// A sensor of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sensor {
    /// Wheel encoders.
    Encoders,
    /// Compass.
    Compass,
    /// Laser range finder.
    Laser,
}

/// Type of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The sensor publishes nothing; encoders report zero travel.
    Dropout(Sensor),
    /// All values of the sensor are NaN.
    NotANumber(Sensor),
    /// Offset of all values: a relative travel error of the encoders, the compass in rad, the laser ranges in
    /// m.
    Offset(Sensor, f64),
    /// Stamps are too early by this time \[s].
    StampOffset(Sensor, f64),
    /// Kidnapped robot: one displacement by (x \[m], y \[m], heading \[rad]).
    Displaced([f64; 3]),
}

/// A fault in a time interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Time interval; a displacement happens at its start.
    pub during: Range<Stamp>,
    /// Type of the fault.
    pub kind: FaultKind,
}

impl Fault {
    /// Creates a fault from `start` to `end` \[s].
    pub fn between(start: f64, end: f64, kind: FaultKind) -> Self {
        Self { during: Stamp::from_seconds(start)..Stamp::from_seconds(end), kind }
    }

    /// Creates a fault at one instant \[s].
    pub fn at(time: f64, kind: FaultKind) -> Self {
        Self::between(time, time, kind)
    }
}

/// Combined effect of the active faults on one sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Disturbance {
    pub(crate) dropout: bool,
    /// Added to values; NaN under [`FaultKind::NotANumber`].
    pub(crate) offset: f64,
    pub(crate) stamp_offset: f64,
}

/// Combines the effects of `faults` on `sensor` at time `now`.
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
