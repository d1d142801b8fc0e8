//! Many closed-loop drives to one goal at once: the bench trial that laws are compared by.
//!
//! One trial: a unicycle that moves on exact arcs, with wheels of 0.05 m on a track of 0.60 m that obey a speed limit of
//! 0.3 m/s and no acceleration limit. The goal is the origin, heading 0. The trial succeeds once the true pose has
//! been within 1 cm and 1° for 1 s without a break, and fails after 120 s. With bench noise the law sees the pose with
//! white Gaussian noise of 5 mm in x and y and 0.3°, and each wheel's speed is off by 5 % of itself (1 σ).
//!
//! In the full loop ([`PoseSource::Filtered`]) the law sees the belief of the core's filter instead. It begins with an error
//! of 1 cm in x and y and 0.5° (1 σ, known), is carried on by the encoders, which read what the wheels were told, and
//! is corrected each period by a compass (0.1°) and by two walls at x = 5 m and y = 5 m, each seen within 5 mm and 0.25°.
//! The report then says whether the filter is consistent.
//!
//! Every trial draws from its own stream of the seed: results do not depend on the number of threads.

mod any_held;
mod belief_batch;
mod bench;
mod estimating;
#[cfg(test)]
mod estimating_tests;
mod filter;
mod lane_scheduler;
mod phases;
mod report;
mod spec;
#[cfg(test)]
mod tests;
mod trial;
mod trial_batch;

use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use surepose_sim::CancelToken;

pub use bench::{DRIVE, HEADING_TOLERANCE, POSITION_TOLERANCE, Start, SweepNoise, fitted_law, limits};
pub use filter::{Filter, PoseSource};
pub use report::{Quantiles, SweepReport};
pub use spec::{Precision, Starts, Sweep};
pub use trial::Trial;

use bench::Termination;
use trial::TrialResult;

impl Sweep {
    /// Runs every trial, or those up to where `cancel` stops it. The trials come in the order of their starts; of a sweep that
    /// is stopped, up to the first that has not ended: those that end late are the ones that fail.
    pub fn run(&self, cancel: &CancelToken) -> SweepReport {
        let termination = Termination::for_benchmark(self.period);
        let (ended, wall) = self.drive(termination, cancel);
        // The least times take as long to work out as many periods in lanes take to drive: all threads do it.
        let share = ended.len().div_ceil(self.threads.max(1)).max(1);
        let bounded = |thread: usize| {
            let mine = ended.chunks(share).nth(thread).unwrap_or_default();
            mine.iter().filter_map(|ended| Trial::from_result(ended, self, termination)).collect::<Vec<_>>()
        };
        SweepReport::from_trials(self.on_threads(bounded).concat(), wall, self.seed)
    }

    /// How many periods a second are driven if every trial goes on for `periods`, on the goal too.
    pub fn periods_per_second(&self, periods: u64) -> f64 {
        let termination = Termination { held: f64::INFINITY, most: periods };
        let (ended, wall) = self.drive(termination, &CancelToken::default());
        ended.iter().map(|ended| ended.steps).sum::<u64>() as f64 / wall
    }

    /// Drives every trial to its end, in the order of the starts; also, how long that took \[s].
    fn drive(&self, termination: Termination, cancel: &CancelToken) -> (Vec<TrialResult>, f64) {
        let begin = Instant::now();
        let next = AtomicUsize::new(0);
        let parts = self.on_threads(|_| match self.precision {
            Precision::F32 => lane_scheduler::run_trials::<f32>(self, termination, &next, cancel),
            Precision::F64 => lane_scheduler::run_trials::<f64>(self, termination, &next, cancel),
        });
        let wall = begin.elapsed().as_secs_f64();
        let complete = parts.iter().filter_map(|part| part.under_way).min().unwrap_or(usize::MAX);
        let ended = parts.into_iter().flat_map(|part| part.ended);
        let mut ended: Vec<_> = ended.filter(|ended| ended.start_index < complete).collect();
        ended.sort_unstable_by_key(|ended| ended.start_index);
        (ended, wall)
    }

    /// What `work` gives on each thread.
    fn on_threads<T: Send>(&self, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
        std::thread::scope(|scope| {
            let work = &work;
            let threads: Vec<_> =
                (0..self.threads.max(1)).map(|thread| scope.spawn(move || work(thread))).collect();
            let joined = threads.into_iter().map(std::thread::ScopedJoinHandle::join);
            joined.map(|part| part.unwrap_or_else(|fault| std::panic::resume_unwind(fault))).collect()
        })
    }
}
