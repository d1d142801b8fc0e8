//! One experiment for many seeds, on all processors.

use std::num::NonZero;
use std::thread;

use surepose_sim::Seed;

/// What `experiment` gives for each of the seeds 1 to `count`, in their order: `run` counts seeds from 1 too.
///
/// The order is that of the seeds, whatever the processors did: sums over it have the same bits every time.
pub(super) fn for_each<T: Send>(count: u64, experiment: impl Fn(Seed) -> T + Sync) -> Vec<T> {
    let workers = thread::available_parallelism().map_or(1, NonZero::get) as u64;
    let experiment = &experiment;
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let share = count.div_ceil(workers).max(1);
    thread::scope(|scope| {
        for (worker, slots) in results.chunks_mut(share as usize).enumerate() {
            let first = worker as u64 * share + 1;
            scope.spawn(move || {
                for (seed, slot) in (first..).zip(slots) {
                    *slot = Some(experiment(Seed(seed)));
                }
            });
        }
    });
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::for_each;

    #[test]
    fn every_seed_is_tried_once_and_in_order() {
        for count in [0, 1, 2, 7, 64] {
            let seeds: Vec<u64> = for_each(count, |seed| seed.0);
            assert_eq!(seeds, (1..=count).collect::<Vec<_>>());
        }
    }
}
