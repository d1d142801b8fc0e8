//! Batches of closed-loop drives to one goal: the benchmark trial that compares control laws.
//!
//! In a trial a unicycle moves on exact arcs. Its wheels have a radius of 0.05 m and a separation of 0.60 m,
//! a speed limit of 0.3 m/s and no acceleration limit. The goal is the origin with heading 0. A trial
//! succeeds once the true pose has been within 1 cm and 1° for 1 s without interruption, and fails after 120
//! s. With bench noise the law receives the pose with white Gaussian noise of 5 mm in x and y and 0.3°. Each
//! wheel's speed has a relative error of 5 % (1 σ).
//!
//! In the full loop ([`PoseSource::Filtered`]) the law receives the belief of the core's filter. Its initial
//! error is 1 cm in x and y and 0.5° (1 σ, known). Encoders, which read the commanded wheel speeds, predict
//! it. A compass (0.1°) and two walls at x = 5 m and y = 5 m, each measured to 5 mm and 0.25°, correct it in
//! every period. The report then includes the consistency of the filter.
//!
//! In a [`PlantSweep`] the robot has the shipped controller with its actuator stage, on a base with dead bands,
//! delay, lag and limits of its own.
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
mod plant_robot;
mod plant_spec;
mod plant_sweep;
#[cfg(test)]
mod plant_tests;
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
pub use plant_spec::PlantSweep;
pub use plant_sweep::PlantReport;
pub use report::{Quantiles, SweepReport};
pub use spec::{Precision, Starts, Sweep};
pub use trial::Trial;

use bench::Termination;
use trial::TrialResult;

impl Sweep {
    /// Runs all trials, or those before cancellation, ordered by start. A canceled sweep keeps the trials
    /// before the first unfinished one: unfinished trials are often failures, so other selections are biased.
    pub fn run(&self, cancel: &CancelToken) -> SweepReport {
        let termination = Termination::for_benchmark(self.period);
        let (ended, wall) = self.drive(termination, cancel);
        // Optimal times take as long to compute as many simulated periods, so all threads share them.
        let share = ended.len().div_ceil(self.threads.max(1)).max(1);
        let bounded = |thread: usize| {
            let mine = ended.chunks(share).nth(thread).unwrap_or_default();
            mine.iter().filter_map(|ended| Trial::from_result(ended, self, termination)).collect::<Vec<_>>()
        };
        SweepReport::from_trials(self.on_threads(bounded).concat(), wall, self.seed)
    }

    /// Measures the periods per second if every trial runs for `periods`, including time at the goal.
    pub fn periods_per_second(&self, periods: u64) -> f64 {
        let termination = Termination { held: f64::INFINITY, most: periods };
        let (ended, wall) = self.drive(termination, &CancelToken::default());
        ended.iter().map(|ended| ended.steps).sum::<u64>() as f64 / wall
    }

    /// Runs every trial to its end, ordered by start; also returns the duration \[s].
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

    /// Returns the results of `work` on each thread.
    fn on_threads<T: Send>(&self, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
        on_threads(self.threads, work)
    }
}

/// Returns the results of `work` on each of several threads, at least one.
fn on_threads<T: Send>(threads: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = (0..threads.max(1)).map(|thread| scope.spawn(move || work(thread))).collect();
        let joined = threads.into_iter().map(std::thread::ScopedJoinHandle::join);
        joined.map(|part| part.unwrap_or_else(|fault| std::panic::resume_unwind(fault))).collect()
    })
}
