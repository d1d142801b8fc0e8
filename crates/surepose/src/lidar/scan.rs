//! A laser range finder and one turn of its mirror.

use core::f64::consts::{FRAC_PI_4, TAU};

use crate::geometry::{Angle, Body, Laser, Pose};
use crate::scalar::Float;

/// A laser range finder: where it is mounted, and how well it measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeFinder<S> {
    /// Where it is mounted.
    pub body_from_laser: Pose<Body, Laser, S>,
    /// Standard deviation of a range \[m], positive.
    pub range_std: S,
    /// Standard deviation of the direction that a beam really takes \[rad], not negative.
    pub bearing_std: S,
    /// Nearer returns are the housing's own \[m].
    pub range_min: S,
    /// Farther returns are none \[m]; lasers report "nothing" as a range beyond it, as NaN, infinite or zero.
    pub range_max: S,
}

/// One turn of the mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan<'a, S> {
    /// Direction of the first beam from the laser's x axis.
    pub angle_min: Angle<S>,
    /// From one beam to the next \[rad], negative for a mirror that turns clockwise.
    pub angle_increment: S,
    /// The range of every beam \[m].
    pub ranges: &'a [S],
    /// Reach and mounting of the laser, where the scan brings its own. `None` uses those of the scan processor.
    pub geometry: Option<LaserGeometry<S>>,
}

/// Reach and mounting of the laser that took a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserGeometry<S> {
    /// Where the laser is mounted.
    pub body_from_laser: Pose<Body, Laser, S>,
    /// Nearer returns are discarded \[m].
    pub range_min: S,
    /// Farther returns are discarded \[m].
    pub range_max: S,
}

impl<'a, S> Scan<'a, S> {
    /// Scan of the configured laser.
    pub fn new(angle_min: Angle<S>, angle_increment: S, ranges: &'a [S]) -> Self {
        Self { angle_min, angle_increment, ranges, geometry: None }
    }

    /// The scan with the reach and the mounting of the laser that took it.
    #[must_use]
    pub fn with_geometry(self, geometry: LaserGeometry<S>) -> Self {
        Self { geometry: Some(geometry), ..self }
    }
}

/// Why a scan was not read at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ScanError {
    /// The laser's noise is not positive and finite, its reach is not positive, or its mounting is not finite.
    InvalidLaser,
    /// A bearing is not finite, the step is zero or beyond 45°, or the beams make more than one turn.
    InvalidAngles,
    /// There are more beams than the extractor has room for.
    TooManyBeams,
}

impl ScanError {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::InvalidLaser => "bad_laser",
            Self::InvalidAngles => "bad_bearings",
            Self::TooManyBeams => "too_many_beams",
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
        })
    }
}

impl core::error::Error for ScanError {}

impl<S: Float> Scan<'_, S> {
    /// The direction of a beam from the laser's x axis.
    pub fn angle(&self, number: usize) -> Angle<S> {
        self.angle_min.rotated_by(self.angle_increment * S::from_f64(number as f64))
    }
}

impl<S: Float> RangeFinder<S> {
    /// Whether a beam with this range came back from something.
    #[inline]
    pub(super) fn is_return(&self, range: S) -> bool {
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
        // One step more than a turn: some lasers give the first direction twice.
        let is_valid = self.angle_min.radians().is_finite()
            && step > S::from_f64(0.0)
            && step <= S::from_f64(FRAC_PI_4)
            && turn <= S::from_f64(TAU) + step * S::from_f64(1.5);
        if !is_valid {
            Err(ScanError::InvalidAngles)
        } else if count > capacity {
            Err(ScanError::TooManyBeams)
        } else {
            Ok(())
        }
    }
}
