//! Boxes ordered by their priority for bisection.

use core::cmp::Ordering;

use crate::region::Region;

/// A box and its priority; the largest priority comes first, and the larger box at a tie.
pub(crate) struct PrioritizedBox {
    pub(crate) priority: f64,
    pub(crate) region: Region,
}

impl Ord for PrioritizedBox {
    fn cmp(&self, other: &Self) -> Ordering {
        self.priority.total_cmp(&other.priority).then(self.region.size().total_cmp(&other.region.size()))
    }
}

impl PartialOrd for PrioritizedBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for PrioritizedBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for PrioritizedBox {}
