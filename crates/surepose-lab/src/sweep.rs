//! Many closed-loop drives to one goal at once: the bench trial that laws are compared by.
//!
//! One trial: a unicycle that moves on exact arcs, with wheels of 0.05 m on a track of 0.60 m that obey a speed limit of
//! 0.3 m/s and no acceleration limit. The goal is the origin, heading 0. The trial succeeds once the true pose has
//! been within 1 cm and 1° for 1 s without a break, and fails after 120 s. With bench noise the law sees the pose with
//! white Gaussian noise of 5 mm in x and y and 0.3°, and each wheel's speed is off by 5 % of itself (1 σ).
//!
//! Every trial draws from its own stream of the seed: results do not depend on the number of threads.

mod bench;
mod course;
mod report;
#[cfg(test)]
mod tests;
mod trial;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use surepose::Law;
use surepose_sim::Seed;

pub use bench::{DRIVE, Noise, fitted_law, limits};
pub use report::{Spread, SweepReport};
pub use trial::Trial;

use bench::Bench;

/// A start pose, seen from the goal.
pub type Start = surepose::Pose<surepose::Goal, surepose::Body, f64>;

/// Where the trials start.
#[derive(Clone, Debug, PartialEq)]
pub enum Starts {
    /// This many, uniform in [−3, 3]² × [−180°, 180°].
    Random(usize),
    /// These.
    Given(Vec<Start>),
}

impl Starts {
    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Self::Random(count) => *count,
            Self::Given(starts) => starts.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The numbers that the loop is computed with. What the trials are judged by is always `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Four bytes: the microcontroller's.
    F32,
    /// Eight bytes: the robot's.
    #[default]
    F64,
}

/// What to sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Where the trials start.
    pub starts: Starts,
    /// The law, its gains included.
    pub law: Law<f64>,
    /// Time between ticks \[s], positive.
    pub period: f64,
    /// What is wrong with the estimate and the wheels.
    pub noise: Noise,
    /// What the loop is computed with.
    pub precision: Precision,
    /// How many threads, at least 1.
    pub threads: usize,
    /// What all randomness comes from.
    pub seed: u64,
}

/// How far a running sweep is, and whether it shall end early. Shared with whoever watches.
#[derive(Debug, Default)]
pub struct Watch {
    done: AtomicUsize,
    stop: AtomicBool,
}

impl Watch {
    /// How many trials are done.
    pub fn done(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }

    /// Ends the sweep after the trials under way: what is done is kept.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Trials that a thread takes at a time: enough to make taking cheap, few enough to end together.
const SHARE: usize = 64;

impl Sweep {
    /// Runs every trial, or those up to where `watch` stops it. The trials come in the order of their starts.
    pub fn run(&self, watch: &Watch) -> SweepReport {
        let begin = Instant::now();
        let (next, results) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        std::thread::scope(|scope| {
            for _ in 0..self.threads.max(1) {
                scope.spawn(|| {
                    let mine = match self.precision {
                        Precision::F32 => self.share::<f32>(&next, watch),
                        Precision::F64 => self.share::<f64>(&next, watch),
                    };
                    // A thread that panicked has poisoned nothing that matters: the trials are whole.
                    results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).extend(mine);
                });
            }
        });
        let wall = begin.elapsed().as_secs_f64();
        let mut trials = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        trials.sort_by_key(|(index, _)| *index);
        SweepReport::of(trials.into_iter().map(|(_, trial)| trial).collect(), wall, self.seed)
    }

    /// Takes trials until none is left.
    fn share<S: surepose::Float>(&self, next: &AtomicUsize, watch: &Watch) -> Vec<(usize, Trial)> {
        let bench = Bench::<S>::new(self);
        let mut mine = Vec::new();
        loop {
            let from = next.fetch_add(SHARE, Ordering::Relaxed);
            let share = from..self.starts.len().min(from + SHARE);
            if share.is_empty() {
                return mine;
            }
            for index in share {
                if watch.stopped() {
                    return mine;
                }
                let mut stream = Seed(self.seed).stream(&format!("trial {index}"));
                let start = match &self.starts {
                    Starts::Random(_) => bench::random_start(&mut stream),
                    Starts::Given(starts) => starts[index],
                };
                mine.push((index, trial::run(&bench, start, &mut stream)));
                watch.done.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}
