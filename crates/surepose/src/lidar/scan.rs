//! Laser range finder model and scan.

use core::f64::consts::{FRAC_PI_4, TAU};

use crate::geometry::{Angle, Body, Laser, Pose};
use crate::scalar::Float;

/// Mounting, noise and range limits of a laser range finder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeFinder<S> {
    /// Pose of the laser in the body frame.
    pub body_from_laser: Pose<Body, Laser, S>,
    /// Standard deviation of a range \[m], positive.
    pub range_std: S,
    /// Standard deviation of the direction of a beam \[rad], not negative.
    pub bearing_std: S,
    /// Minimum range \[m]; nearer returns are reflections of the housing.
    pub range_min: S,
    /// Maximum range \[m]. Lasers report a missing return as a larger range, NaN, infinity or zero.
    pub range_max: S,
}

/// One scan of the laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan<'a, S> {
    /// Direction of the first beam from the laser's x axis.
    pub angle_min: Angle<S>,
    /// Angle from one beam to the next \[rad]; negative for a clockwise scan.
    pub angle_increment: S,
    /// Range of each beam \[m].
    pub ranges: &'a [S],
    /// Time from one beam to the next \[s], for a laser that sweeps; the stamp of the scan is that of the first beam. 0 for
    /// beams that were all measured at the stamp.
    pub time_increment: f64,
    /// Direction of each beam from the laser's x axis; `None` for even steps from `angle_min`.
    pub bearings: Option<&'a [Angle<S>]>,
    /// Range limits and mounting of the laser; `None` uses those of the scan processor.
    pub geometry: Option<LaserGeometry<S>>,
}

/// Range limits and mounting of the laser that took a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserGeometry<S> {
    /// Pose of the laser in the body frame.
    pub body_from_laser: Pose<Body, Laser, S>,
    /// Minimum range \[m]; nearer returns are discarded.
    pub range_min: S,
    /// Maximum range \[m]; farther returns are discarded.
    pub range_max: S,
}

impl<'a, S> Scan<'a, S> {
    /// Scan of the configured laser.
    pub fn new(angle_min: Angle<S>, angle_increment: S, ranges: &'a [S]) -> Self {
        Self { angle_min, angle_increment, ranges, time_increment: 0.0, bearings: None, geometry: None }
    }

    /// Sets the time from one beam to the next \[s].
    #[must_use]
    pub fn with_time_increment(self, time_increment: f64) -> Self {
        Self { time_increment, ..self }
    }

    /// Time from the first beam to the last \[s]; 0 for beams that were all measured at the stamp.
    pub fn sweep_duration(&self) -> f64 {
        self.time_increment * self.ranges.len().saturating_sub(1) as f64
    }

    /// Sets the range limits and the mounting of the laser that took the scan.
    #[must_use]
    pub fn with_geometry(self, geometry: LaserGeometry<S>) -> Self {
        Self { geometry: Some(geometry), ..self }
    }
}

/// Reason for the rejection of a whole scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ScanError {
    /// The laser noise is not positive and finite, the range limits are not positive, or the mounting is not finite.
    InvalidLaser,
    /// An angle is not finite, the increment is zero or beyond 45°, or the beams cover more than one turn.
    InvalidAngles,
    /// The scan has more beams than the capacity of the extractor.
    TooManyBeams,
    /// The time increment is negative or not finite, or the sweep takes longer than [`MAX_SWEEP_DURATION`].
    InvalidSweep,
}

/// Maximum time from the first beam of a scan to the last \[s].
pub const MAX_SWEEP_DURATION: f64 = 1.0;

impl ScanError {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::InvalidLaser => "bad_laser",
            Self::InvalidAngles => "bad_bearings",
            Self::TooManyBeams => "too_many_beams",
            Self::InvalidSweep => "bad_sweep",
        }
    }
}

impl core::fmt::Display for ScanError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::InvalidLaser => {
                "the laser's noise and reach must be positive, and its noise and mounting finite"
            }
            Self::InvalidAngles => {
                "bearings must be finite, steps between 0 and 45°, all beams within one turn"
            }
            Self::TooManyBeams => "the scan has more beams than the extractor has room for",
            Self::InvalidSweep => "the time increment must not be negative, and a sweep takes at most 1 s",
        })
    }
}

impl core::error::Error for ScanError {}

impl<S: Float> Scan<'_, S> {
    /// Direction of a beam from the x axis of the laser.
    pub fn angle(&self, number: usize) -> Angle<S> {
        let bearing = self.bearings.and_then(|bearings| bearings.get(number));
        bearing
            .copied()
            .unwrap_or_else(|| self.angle_min.rotated_by(self.angle_increment * S::from_f64(number as f64)))
    }
}

impl<S: Float> RangeFinder<S> {
    /// Whether a beam of this range has a return.
    #[inline]
    pub fn is_return(&self, range: S) -> bool {
        // A NaN compares false on both sides.
        range > self.range_min && range <= self.range_max && range.is_finite()
    }

    pub(super) fn check(&self) -> Result<(), ScanError> {
        let zero = S::from_f64(0.0);
        let mount = self.body_from_laser;
        let finite =
            [mount.x, mount.y, mount.heading.radians(), self.bearing_std, self.range_std, self.range_min]
                .iter()
                .all(|v| v.is_finite());
        let is_valid = self.range_std > zero
            && self.bearing_std >= zero
            && self.range_min >= zero
            && self.range_max > self.range_min;
        if finite && is_valid { Ok(()) } else { Err(ScanError::InvalidLaser) }
    }
}

impl<S: Float> Scan<'_, S> {
    pub(super) fn check(&self, capacity: usize) -> Result<(), ScanError> {
        let step = self.angle_increment.abs();
        let count = self.ranges.len();
        let turn = step * S::from_f64(count as f64);
        // One increment more than a turn is valid: some lasers report the first direction twice.
        let is_valid = self.angle_min.radians().is_finite()
            && step > S::from_f64(0.0)
            && step <= S::from_f64(FRAC_PI_4)
            && turn <= S::from_f64(TAU) + step * S::from_f64(1.5)
            && self.bearings.is_none_or(|bearings| bearings.len() == count);
        if !is_valid {
            Err(ScanError::InvalidAngles)
        } else if count > capacity {
            Err(ScanError::TooManyBeams)
        } else if !(self.time_increment >= 0.0 && self.sweep_duration() <= MAX_SWEEP_DURATION) {
            Err(ScanError::InvalidSweep)
        } else {
            Ok(())
        }
    }
}
