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

    /// `pieces`, counted as they are taken up, until the work shall end.
    pub(crate) fn over<T>(&self, pieces: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
        pieces.into_iter().take_while(|_| !self.stopped()).inspect(|_| self.count())
    }

    pub(crate) fn count(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::Watch;

    #[test]
    fn pieces_are_counted_until_the_work_shall_end() {
        let watch = Watch::default();
        let mut taken = Vec::new();
        for piece in watch.over(0..10) {
            taken.push(piece);
            if piece == 3 {
                watch.stop();
            }
        }
        assert_eq!((taken, watch.done()), (vec![0, 1, 2, 3], 4));
    }
}
