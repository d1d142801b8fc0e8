//! Parallel runs of one experiment for many seeds.

use std::num::NonZero;
use std::ops::Range;
use std::thread;

use surepose_sim::{CancelToken, Seed};

/// Returns the results of `experiment` for `seeds`, or for those completed when `cancel` was canceled.
///
/// Results are in the order of the seeds, so that sums over them are bit-identical in every run.
pub(super) fn for_each<T: Send>(
    seeds: Range<u64>,
    cancel: &CancelToken,
    experiment: impl Fn(Seed) -> T + Sync,
) -> Vec<T> {
    let workers = thread::available_parallelism().map_or(1, NonZero::get) as u64;
    let experiment = &experiment;
    let mut results: Vec<Option<T>> = seeds.clone().map(|_| None).collect();
    let share = (results.len() as u64).div_ceil(workers).max(1);
    thread::scope(|scope| {
        for (worker, slots) in results.chunks_mut(share as usize).enumerate() {
            let first = seeds.start + worker as u64 * share;
            scope.spawn(move || {
                for (seed, slot) in (first..).zip(slots) {
                    if cancel.is_cancelled() {
                        break;
                    }
                    *slot = Some(experiment(Seed(seed)));
                    cancel.count();
                }
            });
        }
    });
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::{CancelToken, for_each};

    #[test]
    fn every_seed_runs_once_and_in_order() {
        for count in [0, 1, 2, 7, 64] {
            let cancel = CancelToken::default();
            let seeds: Vec<u64> = for_each(5..5 + count, &cancel, |seed| seed.0);
            assert_eq!(seeds, (5..5 + count).collect::<Vec<_>>());
            assert_eq!(cancel.completed() as u64, count);
        }
    }

    #[test]
    fn completed_results_are_kept() {
        let cancel = CancelToken::default();
        let seeds: Vec<u64> = for_each(1..1001, &cancel, |seed| {
            if seed.0 == 3 {
                cancel.cancel();
            }
            seed.0
        });
        assert!(seeds.len() < 1000 && seeds.starts_with(&[1, 2, 3]), "{seeds:?}");
    }
}
