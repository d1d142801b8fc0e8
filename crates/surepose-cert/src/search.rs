//! Branch and bound: regions are cut until the fall of W is shown in each, or one resists.

use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;

/// Regions narrower than this \[rad] are not cut again: what is not shown there is not true, or too close to call.
const MIN_WIDTH: f64 = 2e-3;

/// What came of the search at some distances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchResult {
    /// Upper bound of Ẇ in all regions \[1/s], if it was shown in each.
    pub(crate) rate: Option<f64>,
    /// Regions looked at.
    pub(crate) boxes: usize,
    /// The region that resisted.
    pub(crate) stuck: Option<Region>,
}

/// Shows that W falls at `required` \[1/s] or faster at all true distances in `rho`, with at most `most` regions.
pub(crate) fn search<L: SampledController>(
    descent: &Descent<'_, L>,
    rho: Interval,
    required: f64,
    most: usize,
) -> SearchResult {
    let mut open: Vec<Region> = Region::around(rho, &descent.noise).collect();
    let mut boxes = 0;
    let mut rate = f64::NEG_INFINITY;
    let mut discrete_states = descent.discrete_states.clone();
    while let Some(region) = open.pop() {
        boxes += 1;
        let fall = descent.fall(&region, required, &mut discrete_states);
        if fall.rate <= -required && fall.jump <= 0.0 {
            rate = rate.max(fall.rate);
        } else if boxes >= most || region.size() < MIN_WIDTH {
            return SearchResult { rate: None, boxes, stuck: Some(region) };
        } else {
            let (low, high) = region.halves();
            open.push(low);
            open.push(high);
        }
    }
    SearchResult { rate: Some(rate), boxes, stuck: None }
}
