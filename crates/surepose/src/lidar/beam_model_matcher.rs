//! What the beams of a scan say of the pose, each against the first wall in its way.

use crate::estimation::{Belief, PoseMeasurement};
use crate::map::Wall;
use crate::scalar::{Float, Scalar};

use super::beam_subset::BeamSubset;
use super::scan::{RangeFinder, Scan, ScanError};

/// Beams of a scan that are held against the map.
const BEAMS: usize = 128;

/// How scans are read ray by ray, see [`BeamSubset::fix`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamModelMatcher<S> {
    /// The least part of a scan that the map explains for it to say where the robot is, 0 to 1.
    pub min_hit_ratio: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] that all beams of a scan share.
    pub scan_std: [S; 3],
}

impl<S: Float> BeamModelMatcher<S> {
    /// The pose that the explained beams of `scan` ask for; `None` where the map explains too few.
    ///
    /// # Errors
    /// [`ScanError`], before anything is looked at.
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
