//! Work that somebody watches, and may end early.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How far long work is, and whether it shall end early. Shared between the work and whoever watches.
#[derive(Debug, Default)]
pub struct Watch {
    done: AtomicUsize,
    stop: AtomicBool,
}

impl Watch {
    /// How many pieces of it are done.
    pub fn done(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }

    /// Ends the work at once: pieces that are done are kept, those under way are not.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(crate) fn count(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
