//! Cancellation and progress of long computations.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Progress counter and cancel flag, shared between a computation and its caller.
#[derive(Debug, Default)]
pub struct CancelToken {
    done: AtomicUsize,
    stop: AtomicBool,
}

impl CancelToken {
    /// Returns the number of completed work items.
    pub fn completed(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }

    /// Requests cancellation: completed items are kept, unfinished ones are dropped.
    pub fn cancel(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Iterates over `pieces` and counts them until canceled.
    pub fn take_until_cancelled<T>(&self, pieces: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
        pieces.into_iter().take_while(|_| !self.is_cancelled()).inspect(|_| self.count())
    }

    /// Counts a piece as taken up.
    pub fn count(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Whether the work shall end.
    pub fn is_cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::CancelToken;

    #[test]
    fn items_are_counted_until_cancelled() {
        let cancel = CancelToken::default();
        let mut taken = Vec::new();
        for piece in cancel.take_until_cancelled(0..10) {
            taken.push(piece);
            if piece == 3 {
                cancel.cancel();
            }
        }
        assert_eq!((taken, cancel.completed()), (vec![0, 1, 2, 3], 4));
    }
}
