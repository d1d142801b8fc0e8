//! Largest distance from the goal after one tick that begins within the capture radius.

use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;

/// Angular width below which a box is not bisected \[rad].
const FINE: f64 = 0.06;
/// Number of rings of the disc.
const RINGS: usize = 8;
/// Maximum number of branches. At the goal, no bisection decides which end of the robot leads. A law that
/// stores its drive direction therefore has hundreds of branches.
const MAX_BRANCHES: usize = 1024;

impl<L: SampledController> Descent<'_, L> {
    /// Bounds the true distance during one tick that begins within `radius` \[m]. `None`: not shown.
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

    /// Largest distance during one tick from `region` \[m]. `None`: the outcomes are not determined.
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
