//! Fault injection for tests of the estimator and the control law.

use core::ops::Range;

use surepose::time::Stamp;

use crate::laser::SimulatedScan;

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
    /// The laser reports useless ranges.
    Scan(ScanFault),
    /// Held wheels do not turn, whatever their motors do.
    WheelsHeld {
        /// Whether the right wheel is held.
        right: bool,
        /// Whether the left wheel is held.
        left: bool,
    },
    /// Kidnapped robot: one displacement by (x \[m], y \[m], heading \[rad]).
    Displaced([f64; 3]),
}

/// Useless ranges of a laser, with valid angles and stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanFault {
    /// Every range is +∞: no beam returns.
    Infinite,
    /// Every range is NaN.
    NotANumber,
    /// Every range is 0.
    Zero,
    /// Every range is −1 m.
    Negative,
    /// The scan has no ranges.
    Empty,
    /// The ranges of the scan before the fault, again and again.
    Frozen,
}

impl ScanFault {
    /// Applies the fault to `scan`; `before` is the last scan before the fault.
    pub(crate) fn apply(self, scan: &mut SimulatedScan, before: &SimulatedScan) {
        match self {
            Self::Infinite => scan.ranges.fill(f64::INFINITY),
            Self::NotANumber => scan.ranges.fill(f64::NAN),
            Self::Zero => scan.ranges.fill(0.0),
            Self::Negative => scan.ranges.fill(-1.0),
            Self::Empty => scan.ranges.clear(),
            Self::Frozen => scan.ranges.clone_from(&before.ranges),
        }
    }
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

    /// Creates a fault from `start` \[s] to the end of the simulation.
    pub fn from(start: f64, kind: FaultKind) -> Self {
        Self { during: Stamp::from_seconds(start)..Stamp::from_nanoseconds(i64::MAX), kind }
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
    pub(crate) scan: Option<ScanFault>,
}

/// Whether the right and the left wheel are held at time `now`.
pub(crate) fn held_wheels(faults: &[Fault], now: Stamp) -> (bool, bool) {
    let active = faults.iter().filter(|fault| fault.during.contains(&now));
    active.fold((false, false), |(right, left), fault| match fault.kind {
        FaultKind::WheelsHeld { right: r, left: l } => (right || r, left || l),
        _ => (right, left),
    })
}

/// Combines the effects of `faults` on `sensor` at time `now`.
pub(crate) fn disturbance(faults: &[Fault], sensor: Sensor, now: Stamp) -> Disturbance {
    let mut result = Disturbance::default();
    for fault in faults.iter().filter(|fault| fault.during.contains(&now)) {
        match fault.kind {
            FaultKind::Dropout(s) if s == sensor => result.dropout = true,
            FaultKind::NotANumber(s) if s == sensor => result.offset = f64::NAN,
            FaultKind::Offset(s, size) if s == sensor => result.offset += size,
            FaultKind::Scan(kind) if sensor == Sensor::Laser => result.scan = Some(kind),
            FaultKind::StampOffset(s, seconds) if s == sensor => result.stamp_offset += seconds,
            _ => {}
        }
    }
    result
}
