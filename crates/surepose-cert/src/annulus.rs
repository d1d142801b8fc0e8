//! The distances at which W falls: from far away inwards, as near to the goal as it goes.

use crate::controller::SampledController;
use crate::counterexample::{Counterexample, find};
use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;
use crate::search::search;

/// How much work may be done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// Regions at one range of distances.
    pub(crate) slice: usize,
    /// Regions after which no nearer distances are begun, where what was shown is near enough.
    pub(crate) enough: usize,
    /// Regions after which none are begun at all.
    pub(crate) total: usize,
}

/// The distances at which W was shown to fall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Annulus {
    /// Nearest \[m]; infinite if W was shown to fall nowhere.
    pub(crate) inner: f64,
    /// Upper bound of Ẇ \[1/s].
    pub(crate) rate: f64,
    /// Regions looked at.
    pub(crate) boxes: usize,
    /// Where the proof got stuck, if it did.
    pub(crate) stuck: Option<(Interval, Region)>,
}

/// Shows the fall of W from `outer` inwards, to `floor` \[m] or as near as the budget allows, trying the `rates` \[1/s]
/// one after the other. More work is done until `near_enough` \[m] than after it.
pub(crate) fn from_outside<L: SampledController>(
    descent: &mut Descent<'_, L>,
    outer: f64,
    (floor, near_enough): (f64, f64),
    rates: &[f64],
    budget: Budget,
) -> Annulus {
    search_inwards(descent, outer, (floor, near_enough), rates, budget, false)
}

/// The same for every discrete state that the law may have come to be in, by noise beyond any bound.
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
        // Nearer than near enough is not worth a slower fall than farther out.
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
    /// A concrete violation where the proof got stuck, or nearer down to `floor` \[m], if one is found.
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

/// By what factor the distances of one search differ: little where the noise makes the difference.
pub(crate) fn ratio(rho: f64, noise: f64) -> f64 {
    if rho > 0.6 && rho > 40.0 * noise {
        3.0
    } else if rho > 0.1 && rho > 10.0 * noise {
        1.5
    } else {
        1.12
    }
}
