//! Whether any trial of a batch has held its goal for long enough.

use surepose_simd::{Element, Kernel, dispatch_simd};

use super::trial_batch::{BatchArray, TrialBatch};

/// Whether any trial has been `held` for so long.
pub(super) fn any_held<T: Element>(batch: &TrialBatch<T>, held: T) -> bool {
    dispatch_simd(Anyone(&batch.score.held, held))
}

/// Whether any number is as large as another.
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
