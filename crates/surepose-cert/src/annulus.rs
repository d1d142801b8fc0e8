//! Search for the annulus in which W decreases, from the outside inward.

use crate::controller::SampledController;
use crate::counterexample::{Counterexample, find};
use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;
use crate::search::search;

/// Limits of the work, in numbers of boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// Boxes per range of distances.
    pub(crate) slice: usize,
    /// Boxes after which no further range starts, once `near_enough` is reached.
    pub(crate) enough: usize,
    /// Boxes after which no further range starts at all.
    pub(crate) total: usize,
}

/// Annulus in which W was shown to decrease.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Annulus {
    /// Inner radius \[m]. ∞: no decrease was shown anywhere.
    pub(crate) inner: f64,
    /// Upper bound of Ẇ \[1/s].
    pub(crate) rate: f64,
    /// Number of boxes evaluated.
    pub(crate) boxes: usize,
    /// Distances and box at which the proof failed. `None`: no failure.
    pub(crate) stuck: Option<(Interval, Region)>,
}

/// Shows the decrease of W from `outer` inward to `floor` \[m], or as far as the budget allows.
///
/// The `rates` \[1/s] are tried in order. The budget is larger down to `near_enough` \[m] than below it.
pub(crate) fn from_outside<L: SampledController>(
    descent: &mut Descent<'_, L>,
    outer: f64,
    (floor, near_enough): (f64, f64),
    rates: &[f64],
    budget: Budget,
) -> Annulus {
    search_inwards(descent, outer, (floor, near_enough), rates, budget, false)
}

/// [`from_outside`] for all reachable discrete states, as noise beyond any bound requires.
pub(crate) fn from_outside_any_past<L: SampledController>(
    descent: &mut Descent<'_, L>,
    outer: f64,
    near_enough: f64,
    rates: &[f64],
    budget: Budget,
) -> Annulus {
    search_inwards(descent, outer, (0.0, near_enough), rates, budget, true)
}

fn search_inwards<L: SampledController>(
    descent: &mut Descent<'_, L>,
    outer: f64,
    (floor, near_enough): (f64, f64),
    rates: &[f64],
    budget: Budget,
    any_past: bool,
) -> Annulus {
    let mut annulus = Annulus { inner: f64::INFINITY, rate: f64::NEG_INFINITY, boxes: 0, stuck: None };
    let mut far = outer;
    while far > floor {
        let most = if far > near_enough { budget.total } else { budget.enough };
        if annulus.boxes >= most {
            let rho = Interval::new(far / 2.0, far);
            annulus.stuck = Some((rho, Region::anywhere(rho, Interval::symmetric(descent.noise.position))));
            break;
        }
        let near = (far / ratio(far, descent.noise.position)).max(floor);
        let rho = Interval::new(near, far);
        if any_past {
            descent.prepare_for_any_past();
        } else {
            descent.prepare(rho);
        }
        let mut shown = None;
        // Below `near_enough`, a smaller radius is not worth a lower decrease rate.
        let least = if far > near_enough { 0.0 } else { 0.9 * -annulus.rate };
        for &required in rates.iter().filter(|required| **required >= least) {
            let found = search(descent, rho, required, budget.slice);
            annulus.boxes += found.boxes;
            shown = found.rate;
            annulus.stuck = found.stuck.map(|region| (rho, region));
            if shown.is_some() {
                break;
            }
        }
        let Some(rate) = shown else { break };
        annulus.rate = annulus.rate.max(rate);
        annulus.inner = near;
        far = near;
    }
    annulus
}

impl Annulus {
    /// Searches for a concrete violation from the failed box down to `floor` \[m]. `None`: none found.
    pub(crate) fn counterexample<L: SampledController>(
        &self,
        descent: &mut Descent<'_, L>,
        floor: f64,
    ) -> Option<Counterexample> {
        let (rho, region) = self.stuck?;
        let rho = Interval::new(floor.min(rho.lo()), rho.hi());
        descent.prepare(rho);
        find(descent, rho, &region)
    }
}

/// Ratio of successive radii in the search; small where the noise matters.
pub(crate) fn ratio(rho: f64, noise: f64) -> f64 {
    if rho > 0.6 && rho > 40.0 * noise {
        3.0
    } else if rho > 0.1 && rho > 10.0 * noise {
        1.5
    } else {
        1.12
    }
}
