//! Boxes in the order in which they are worth halving.

use core::cmp::Ordering;

use crate::region::Region;

/// A box, and how bad what is known of it is: the worst is the greatest, and of two the larger box.
pub(crate) struct Ranked {
    pub(crate) badness: f64,
    pub(crate) region: Region,
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.badness.total_cmp(&other.badness).then(self.region.size().total_cmp(&other.region.size()))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ranked {}
