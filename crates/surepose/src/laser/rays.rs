//! What the beams of a scan say of the pose, each against the first wall in its way.

use crate::estimate::{Belief, PoseFix};
use crate::scalar::{Float, Scalar};

use super::glance::Glance;
use super::scan::{RangeFinder, Scan, ScanRefusal};
use super::wall::Wall;

/// Beams of a scan that are held against the map.
const BEAMS: usize = 128;

/// How scans are read ray by ray, see [`Glance::fix`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rays<S> {
    /// The least part of a scan that the map explains for it to say where the robot is, 0 to 1.
    pub least_share: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] that all beams of a scan share.
    pub scan_std: [S; 3],
}

impl<S: Float> Rays<S> {
    /// The pose that the explained beams of `scan` ask for; `None` where the map explains too few.
    ///
    /// # Errors
    /// [`ScanRefusal`], before anything is looked at.
    pub fn fix(
        &self,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> Result<Option<PoseFix<S>>, ScanRefusal> {
        let (agreement, fix) = Glance::<S, BEAMS>::of(laser, scan)?.fix(belief, walls);
        let is_enough = agreement.explained_share() >= self.least_share;
        Ok(fix.ok().filter(|_| is_enough).map(|fix| fix.blurred(self.scan_std.map(Scalar::squared))))
    }
}
