//! Largest distance from the goal after one tick that begins within the capture radius.

use std::collections::BinaryHeap;

use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::prioritized_box::PrioritizedBox;
use crate::region::Region;

/// Angular width below which a box is not bisected \[rad].
const FINE: f64 = 0.06;
/// Width of the distance, and of its error, below which a box is not bisected, as a fraction of the position noise.
const FINE_DISTANCE: f64 = 0.15;
/// Number of rings of the disc.
const RINGS: usize = 8;
/// Maximum number of boxes.
const MAX_BOXES: usize = 6000;
/// Maximum number of branches. At the goal, no bisection decides which end of the robot leads. A law that
/// stores its drive direction therefore has hundreds of branches.
const MAX_BRANCHES: usize = 1024;

impl<L: SampledController> Descent<'_, L> {
    /// Bounds the true distance during one tick that begins within `radius` \[m]. `None`: not shown.
    pub(crate) fn one_step_reach(&self, radius: f64) -> Option<f64> {
        let ranked = |region: Region| {
            let priority = self.farthest(&region).unwrap_or(f64::INFINITY);
            PrioritizedBox { priority, region }
        };
        let rings = (0..RINGS).map(|ring| Interval::new(0.0, radius).piece(ring, RINGS));
        let mut open: BinaryHeap<PrioritizedBox> =
            rings.flat_map(|rho| Region::around(rho, &self.noise)).map(ranked).collect();
        for _ in 0..MAX_BOXES {
            let Some(parts) = open.peek().filter(|worst| worst.priority > radius).and_then(|worst| {
                let is_known = worst.priority.is_finite();
                worst.region.halves_within_reach(is_known, self.noise.position)
            }) else {
                break;
            };
            open.pop();
            open.extend(parts.into_iter().map(ranked));
        }
        open.peek().map(|worst| worst.priority.max(radius)).filter(|reach| reach.is_finite())
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
            let twist = self.noise.driven(&self.drive.cast(), outcome.twist).all;
            let straight = (region.rho + time * twist.v.hull(-twist.v)).hi();
            let truth = self.truth(region, outcome.discrete_state, turn);
            let along = truth.swept(twist, self.period).map_or(straight, |swept| swept.rho.hi());
            farthest = farthest.max(straight.min(along));
        }
        Some(farthest)
    }
}

impl Region {
    /// Bisects the coarsest side; the direction of approach only where the outcomes are not known. `None`: all sides are fine.
    ///
    /// The control law sees the estimated distance: a wide box combines the mode of one distance with the speed of another.
    fn halves_within_reach(&self, is_known: bool, position_noise: f64) -> Option<[Self; 2]> {
        let fine = (FINE_DISTANCE * position_noise).max(f64::MIN_POSITIVE);
        let scale = if is_known { 1.0 } else { 0.1 };
        let approach = if is_known { 0.0 } else { self.phi.width() / (scale * FINE) };
        let sides = [
            self.alpha.width() / (scale * FINE),
            approach,
            self.drift.width() / fine,
            self.rho.width() / fine,
        ];
        let coarsest = (1..sides.len()).fold(0, |most, k| if sides[k] > sides[most] { k } else { most });
        if sides[coarsest] <= 1.0 {
            return None;
        }
        let (mut low, mut high) = (*self, *self);
        match coarsest {
            0 => (low.alpha, high.alpha) = self.alpha.halves(),
            1 => (low.phi, high.phi) = self.phi.halves(),
            2 => (low.drift, high.drift) = self.drift.halves(),
            _ => (low.rho, high.rho) = self.rho.halves(),
        }
        Some([low, high])
    }
}
