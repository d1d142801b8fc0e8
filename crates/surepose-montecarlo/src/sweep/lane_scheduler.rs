//! Scheduler of a batch: a lane whose trial ends takes the next trial.

use std::sync::atomic::{AtomicUsize, Ordering};

use surepose_sim::CancelToken;
use surepose_simd::Element;

use super::any_held::any_held;
use super::belief_batch::BeliefBatch;
use super::bench::Termination;
use super::filter::PoseSource;
use super::spec::Sweep;
use super::trial::TrialResult;
use super::trial_batch::{LANES, TrialBatch};
use super::{estimating, phases};

/// Number of lanes that one check for ended trials covers.
const GROUP: usize = 16;

/// Maximum number of results allocated in advance; a sweep may be canceled long before its end.
const MAX_RESERVED: usize = 1 << 20;

/// Trial that a lane simulates.
#[derive(Clone, Copy, Debug)]
struct ActiveTrial {
    start_index: usize,
    /// Period of the batch at which it started.
    began: u64,
}

/// Trials of a scheduler.
pub(super) struct CompletedTrials {
    /// Ended trials, in any order.
    pub(super) ended: Vec<TrialResult>,
    /// First unfinished trial at cancellation; `None` if all ended.
    pub(super) under_way: Option<usize>,
}

/// Runs trials from `next` until none is left or until canceled.
pub(super) fn run_trials<T: Element>(
    sweep: &Sweep,
    termination: Termination,
    next: &AtomicUsize,
    cancel: &CancelToken,
) -> CompletedTrials {
    let mut scheduler = LaneScheduler {
        sweep,
        termination,
        next,
        batch: Box::new(TrialBatch::<T>::default()),
        beliefs: match sweep.estimate {
            PoseSource::Given => None,
            PoseSource::Filtered(filter) => Some(Box::new(BeliefBatch::new(filter))),
        },
        under: [None; LANES],
        active: 0,
        now: 0,
        deadline: u64::MAX,
    };
    for lane in 0..LANES {
        scheduler.take(lane);
    }
    let mut done = Vec::with_capacity((sweep.starts.len() / sweep.threads.max(1) + LANES).min(MAX_RESERVED));
    while scheduler.active > 0 && !cancel.is_cancelled() {
        scheduler.step(&mut done, cancel);
    }
    CompletedTrials {
        ended: done,
        under_way: scheduler.under.iter().flatten().map(|under| under.start_index).min(),
    }
}

struct LaneScheduler<'a, T: Element> {
    sweep: &'a Sweep,
    termination: Termination,
    next: &'a AtomicUsize,
    batch: Box<TrialBatch<T>>,
    /// Beliefs of the trials, if a filter estimates the pose.
    beliefs: Option<Box<BeliefBatch<T>>>,
    under: [Option<ActiveTrial>; LANES],
    active: usize,
    now: u64,
    /// Earliest period at which a trial times out.
    deadline: u64,
}

impl<T: Element> LaneScheduler<'_, T> {
    /// Starts the next trial in lane `lane`; the lane idles if there is none.
    fn take(&mut self, lane: usize) {
        let start_index = self.next.fetch_add(1, Ordering::Relaxed);
        let Some(start) = self.sweep.starts.nth(self.sweep.seed, start_index) else {
            self.under[lane] = None;
            self.batch.rest(lane);
            return;
        };
        self.under[lane] = Some(ActiveTrial { start_index, began: self.now });
        let number = self.sweep.starts.number(start_index) as u64;
        self.batch.begin(lane, &start, self.sweep.seed, number);
        if let Some(beliefs) = &mut self.beliefs {
            beliefs.begin(lane, &start, self.sweep.seed, number);
        }
        self.active += 1;
        self.deadline = self.deadline.min(self.now + self.termination.most);
    }

    /// Advances all trials by one period.
    fn step(&mut self, done: &mut Vec<TrialResult>, cancel: &CancelToken) {
        let Sweep { law, noise, period, .. } = self.sweep;
        match &mut self.beliefs {
            None => phases::step(&mut self.batch, law, noise, *period),
            Some(beliefs) => estimating::step(&mut self.batch, beliefs, law, noise, *period),
        }
        self.now += 1;
        let held = T::from_f64(self.termination.held);
        let due = self.now >= self.deadline;
        if due {
            self.deadline = u64::MAX;
        }
        // Usually no trial ends, which one check of all lanes detects; otherwise each group is checked.
        if !due && !any_held(&self.batch, held) {
            return;
        }
        for first in (0..LANES).step_by(GROUP) {
            let group = first..first + GROUP;
            let ending = |number: &T| due || *number >= held;
            if self.batch.score.held.0[group.clone()].iter().fold(false, |any, number| any | ending(number)) {
                for lane in group {
                    if ending(&self.batch.score.held.0[lane]) {
                        self.end(lane, done, cancel);
                    }
                }
            }
        }
    }

    /// Ends the trial of `lane` if it succeeded or timed out, and starts another.
    fn end(&mut self, lane: usize, done: &mut Vec<TrialResult>, cancel: &CancelToken) {
        let Some(ActiveTrial { start_index, began }) = self.under[lane] else { return };
        let steps = self.now - began;
        let (batch, score) = (&self.batch, &self.batch.score);
        let success = score.held.0[lane].to_f64() >= self.termination.held;
        if !success && steps < self.termination.most {
            self.deadline = self.deadline.min(began + self.termination.most);
            return;
        }
        done.push(TrialResult {
            start_index,
            steps,
            success,
            x: batch.x.0[lane].to_f64(),
            y: batch.y.0[lane].to_f64(),
            heading: batch.heading.0[lane].to_f64(),
            path: score.path(lane),
            cusps: score.cusps(lane),
            belief: self.beliefs.as_ref().map(|beliefs| Box::new(beliefs.consistency(lane, steps))),
        });
        cancel.count();
        self.active -= 1;
        self.take(lane);
    }
}
