//! How far out one tick can lead from inside the capture radius.

use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;

/// Regions narrower than this \[rad] are taken as they are.
const FINE: f64 = 0.06;
/// Into how many rings the disc is cut.
const RINGS: usize = 8;
/// Ways through the law that are followed here: on the goal itself no cutting decides which end of the robot is ahead, so
/// that a law which remembers its travel has hundreds.
const MAX_BRANCHES: usize = 1024;

impl<L: SampledController> Descent<'_, L> {
    /// The largest true distance after one tick that began at most `radius` \[m] from the goal, at any time in it.
    pub(crate) fn one_step_reach(&self, radius: f64) -> Option<f64> {
        let mut edge = radius;
        for ring in 0..RINGS {
            let rho = Interval::new(0.0, radius).piece(ring, RINGS);
            let mut open: Vec<Region> = Region::around(rho, &self.noise).collect();
            while let Some(region) = open.pop() {
                match self.farthest(&region) {
                    Some(reach) if reach <= edge => {}
                    Some(reach) if region.alpha.width() < FINE => edge = reach,
                    None if region.alpha.width() < 0.1 * FINE => return None,
                    None => {
                        let (alpha, phi) = (region.alpha.halves(), region.phi.halves());
                        open.extend([alpha.0, alpha.1].map(|alpha| Region { alpha, phi: phi.0, ..region }));
                        open.extend([alpha.0, alpha.1].map(|alpha| Region { alpha, phi: phi.1, ..region }));
                    }
                    Some(_) => {
                        let (low, high) = region.alpha.halves();
                        open.extend([low, high].map(|alpha| Region { alpha, ..region }));
                    }
                }
            }
        }
        Some(edge)
    }

    /// The largest distance on the way of one tick, if the law's ways can be told.
    fn farthest(&self, region: &Region) -> Option<f64> {
        let time = Interval::new(0.0, self.period);
        let turn = Interval::symmetric(region.turn(&self.noise));
        let mut outcomes = Vec::new();
        for discrete_state in self.known_states() {
            if !self.branch_outcomes(region, discrete_state, MAX_BRANCHES, &mut outcomes) {
                return None;
            }
        }
        let mut farthest = f64::NEG_INFINITY;
        for outcome in outcomes {
            let twist = self.noise.driven(&self.drive.cast(), outcome.twist);
            let straight = (region.rho + time * twist.v.hull(-twist.v)).hi();
            let truth = self.truth(region, outcome.discrete_state, turn);
            let along = truth.swept(twist, self.period).map_or(straight, |swept| swept.rho.hi());
            farthest = farthest.max(straight.min(along));
        }
        Some(farthest)
    }
}
