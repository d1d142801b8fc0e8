//! Branch and bound: bisects boxes until the decrease of W is shown in each, or one box fails.

use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;

/// Width \[rad] below which a box is not bisected; a failure there is a violation or too close to decide.
const MIN_WIDTH: f64 = 2e-3;

/// Result of the search at one range of distances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchResult {
    /// Upper bound of Ẇ over all boxes \[1/s]. `None`: not shown in every box.
    pub(crate) rate: Option<f64>,
    /// Number of boxes evaluated.
    pub(crate) boxes: usize,
    /// Box that failed. `None`: no box failed.
    pub(crate) stuck: Option<Region>,
}

/// Shows that W decreases at `required` \[1/s] or faster at all distances `rho`, with at most `most` boxes.
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
