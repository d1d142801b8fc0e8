//! Pose measurements from a scan by ray casting to the first wall.

use crate::estimation::{Belief, PoseMeasurement};
use crate::map::Wall;
use crate::scalar::{Float, Scalar};

use super::beam_subset::BeamSubset;
use super::scan::{RangeFinder, Scan, ScanError};

/// Maximum number of beams of a scan that are compared with the map.
const BEAMS: usize = 128;

/// Scan matching by the beam model, see [`BeamSubset::measure_pose`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamModelMatcher<S> {
    /// Minimum fraction of beams that the map explains for a pose measurement, 0 to 1.
    pub min_hit_ratio: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] of the error common to all beams of a scan.
    pub scan_std: [S; 3],
}

impl<S: Float> BeamModelMatcher<S> {
    /// Pose measured by the explained beams of `scan`; `None` where the map explains too few beams.
    ///
    /// # Errors
    /// [`ScanError`] for a scan or laser that is invalid.
    pub fn match_scan(
        &self,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> Result<Option<PoseMeasurement<S>>, ScanError> {
        let (stats, fix) = BeamSubset::<S, BEAMS>::from_scan(laser, scan)?.measure_pose(belief, walls);
        let is_enough = stats.hit_ratio() >= self.min_hit_ratio;
        Ok(fix.ok().filter(|_| is_enough).map(|fix| fix.inflated(self.scan_std.map(Scalar::squared))))
    }
}
