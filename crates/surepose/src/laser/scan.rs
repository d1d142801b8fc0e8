//! A laser range finder and one turn of its mirror.

use core::f64::consts::{FRAC_PI_4, TAU};

use crate::angle::Angle;
use crate::frame::{Body, Laser};
use crate::pose::Pose;
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
    pub nearest: S,
    /// Farther returns are none \[m]; lasers report "nothing" as a range beyond it, as NaN, infinite or zero.
    pub farthest: S,
}

/// One turn of the mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan<'a, S> {
    /// Direction of the first beam from the laser's x axis.
    pub first_bearing: Angle<S>,
    /// From one beam to the next \[rad], negative for a mirror that turns clockwise.
    pub bearing_step: S,
    /// The range of every beam \[m].
    pub ranges: &'a [S],
}

/// Why a scan was not read at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScanRefusal {
    /// The laser's noise is not positive and finite, its reach is not positive, or its mounting is not finite.
    BadLaser,
    /// A bearing is not finite, the step is zero or beyond 45°, or the beams make more than one turn.
    BadBearings,
    /// There are more beams than the extractor has room for.
    TooManyBeams,
}

impl ScanRefusal {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::BadLaser => "bad_laser",
            Self::BadBearings => "bad_bearings",
            Self::TooManyBeams => "too_many_beams",
        }
    }
}

impl core::fmt::Display for ScanRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::BadLaser => {
                "the laser's noise and reach must be positive, and its noise and mounting finite"
            }
            Self::BadBearings => {
                "bearings must be finite, steps between 0 and 45°, all beams within one turn"
            }
            Self::TooManyBeams => "the scan has more beams than the extractor has room for",
        })
    }
}

impl core::error::Error for ScanRefusal {}

impl<S: Float> Scan<'_, S> {
    /// The direction of a beam from the laser's x axis.
    pub(super) fn bearing(&self, number: usize) -> Angle<S> {
        self.first_bearing.turned(self.bearing_step * S::of(number as f64))
    }
}

impl<S: Float> RangeFinder<S> {
    /// Whether a beam with this range came back from something.
    #[inline]
    pub(super) fn came_back(&self, range: S) -> bool {
        // A NaN compares false on both sides.
        range > self.nearest && range <= self.farthest && range.is_finite()
    }

    pub(super) fn check(&self) -> Result<(), ScanRefusal> {
        let zero = S::of(0.0);
        let mount = self.body_from_laser;
        let finite =
            [mount.x, mount.y, mount.heading.radians(), self.bearing_std, self.range_std, self.nearest]
                .iter()
                .all(|v| v.is_finite());
        let sound = self.range_std > zero
            && self.bearing_std >= zero
            && self.nearest >= zero
            && self.farthest > self.nearest;
        if finite && sound { Ok(()) } else { Err(ScanRefusal::BadLaser) }
    }
}

impl<S: Float> Scan<'_, S> {
    pub(super) fn check(&self, room: usize) -> Result<(), ScanRefusal> {
        let step = self.bearing_step.abs();
        let count = self.ranges.len();
        let turn = step * S::of(count as f64);
        // One step more than a turn: some lasers give the first direction twice.
        let sound = self.first_bearing.radians().is_finite()
            && step > S::of(0.0)
            && step <= S::of(FRAC_PI_4)
            && turn <= S::of(TAU) + step * S::of(1.5);
        if !sound {
            Err(ScanRefusal::BadBearings)
        } else if count > room {
            Err(ScanRefusal::TooManyBeams)
        } else {
            Ok(())
        }
    }
}
