//! Keeps the lanes of a fleet filled: a trial that ends makes room for the next.

use std::sync::atomic::{AtomicUsize, Ordering};

use surepose_lanes::Element;

use super::believing::Beliefs;
use super::bench::{HOLD, TIMEOUT};
use super::filter::Estimate;
use super::fleet::{Fleet, LANES};
use super::trial::Ended;
use super::{Sweep, estimating, phases};
use crate::Watch;

/// How many lanes are looked at together for one whose trial ends.
const GROUP: usize = 16;

/// For how many results there is room before the first one comes: Ctrl-C may end a sweep that asks for far more.
const MOST_AT_ONCE: usize = 1 << 20;

/// When a trial ends, in periods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// Instants in a row inside the tolerance that are success.
    pub(super) held: f64,
    /// Periods after which the trial is given up.
    pub(super) most: u64,
}

impl Ends {
    /// The bench's.
    pub(super) fn of_bench(period: f64) -> Self {
        Self { held: (HOLD / period - 1e-9).ceil() + 1.0, most: (TIMEOUT / period).round() as u64 }
    }
}

/// The trial that a lane is driving.
#[derive(Clone, Copy, Debug)]
struct Under {
    way: usize,
    /// The period at which it began, of the fleet's.
    began: u64,
}

/// What a crew has driven.
pub(super) struct Driven {
    /// The trials that have ended, in any order.
    pub(super) ended: Vec<Ended>,
    /// The first of those that were under way when the watch stopped it.
    pub(super) under_way: Option<usize>,
}

/// Takes trials from `next` until none is left, or the watch stops it.
pub(super) fn drive<T: Element>(sweep: &Sweep, ends: Ends, next: &AtomicUsize, watch: &Watch) -> Driven {
    let mut crew = Crew {
        sweep,
        ends,
        next,
        fleet: Box::new(Fleet::<T>::default()),
        beliefs: match sweep.estimate {
            Estimate::Given => None,
            Estimate::Filtered(filter) => Some(Box::new(Beliefs::new(filter))),
        },
        under: [None; LANES],
        active: 0,
        now: 0,
        deadline: u64::MAX,
    };
    for lane in 0..LANES {
        crew.take(lane);
    }
    let mut done = Vec::with_capacity((sweep.starts.len() / sweep.threads.max(1) + LANES).min(MOST_AT_ONCE));
    while crew.active > 0 && !watch.stopped() {
        crew.step(&mut done, watch);
    }
    Driven { ended: done, under_way: crew.under.iter().flatten().map(|under| under.way).min() }
}

struct Crew<'a, T: Element> {
    sweep: &'a Sweep,
    ends: Ends,
    next: &'a AtomicUsize,
    fleet: Box<Fleet<T>>,
    /// What the trials believe, where a filter tells the law where the robot is.
    beliefs: Option<Box<Beliefs<T>>>,
    under: [Option<Under>; LANES],
    active: usize,
    now: u64,
    /// No trial's time is up before this.
    deadline: u64,
}

impl<T: Element> Crew<'_, T> {
    /// Lane `lane` takes the next trial, or rests if there is none.
    fn take(&mut self, lane: usize) {
        let way = self.next.fetch_add(1, Ordering::Relaxed);
        let Some(start) = self.sweep.starts.nth(self.sweep.seed, way) else {
            self.under[lane] = None;
            self.fleet.rest(lane);
            return;
        };
        self.under[lane] = Some(Under { way, began: self.now });
        self.fleet.begin(lane, &start, self.sweep.seed, way as u64);
        if let Some(beliefs) = &mut self.beliefs {
            beliefs.begin(lane, &start, self.sweep.seed, way as u64);
        }
        self.active += 1;
        self.deadline = self.deadline.min(self.now + self.ends.most);
    }

    /// One period of all trials.
    fn step(&mut self, done: &mut Vec<Ended>, watch: &Watch) {
        let Sweep { law, noise, period, .. } = self.sweep;
        match &mut self.beliefs {
            None => phases::step(&mut self.fleet, law, noise, *period),
            Some(beliefs) => estimating::step(&mut self.fleet, beliefs, law, noise, *period),
        }
        self.now += 1;
        let held = T::of(self.ends.held);
        let due = self.now >= self.deadline;
        if due {
            self.deadline = u64::MAX;
        }
        // Often no trial ends: one look at all lanes says so. Else a look at each group of them finds whose it is.
        if !due && !phases::any_held(&self.fleet, held) {
            return;
        }
        for first in (0..LANES).step_by(GROUP) {
            let group = first..first + GROUP;
            let ending = |number: &T| due || *number >= held;
            if self.fleet.score.held.0[group.clone()].iter().fold(false, |any, number| any | ending(number)) {
                for lane in group {
                    if ending(&self.fleet.score.held.0[lane]) {
                        self.end(lane, done, watch);
                    }
                }
            }
        }
    }

    /// Ends the trial of `lane` if it is to end, and takes another.
    fn end(&mut self, lane: usize, done: &mut Vec<Ended>, watch: &Watch) {
        let Some(Under { way, began }) = self.under[lane] else { return };
        let steps = self.now - began;
        let (fleet, score) = (&self.fleet, &self.fleet.score);
        let success = score.held.0[lane].to_f64() >= self.ends.held;
        if !success && steps < self.ends.most {
            self.deadline = self.deadline.min(began + self.ends.most);
            return;
        }
        done.push(Ended {
            way,
            steps,
            success,
            x: fleet.x.0[lane].to_f64(),
            y: fleet.y.0[lane].to_f64(),
            heading: fleet.heading.0[lane].to_f64(),
            path: score.path(lane),
            cusps: score.cusps(lane),
            belief: self.beliefs.as_ref().map(|beliefs| Box::new(beliefs.consistency(lane, steps))),
        });
        watch.count();
        self.active -= 1;
        self.take(lane);
    }
}
