//! Detection of trials in a batch that have held their goal long enough.

use surepose_simd::{Element, Kernel, dispatch_simd};

use super::trial_batch::{BatchArray, TrialBatch};

/// Returns whether any trial has been `held` that long.
pub(super) fn any_held<T: Element>(batch: &TrialBatch<T>, held: T) -> bool {
    dispatch_simd(Anyone(&batch.score.held, held))
}

/// Kernel: whether any element is at least as large as a threshold.
struct Anyone<'a, T: Element>(&'a BatchArray<T>, T);

impl<T: Element> Kernel for Anyone<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let mut any = false;
        for number in &self.0.0 {
            any |= *number >= self.1;
        }
        any
    }
}
