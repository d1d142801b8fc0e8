//! Tuning of gains for minimum trial time, subject to success of all trials and to a certificate.
//!
//! The search is random and local, an evolution strategy [BeyerSchwefel2002]. Each round draws candidates
//! around the current best and simulates them from the same starts with the same noise, the better ones from
//! more starts. The mean of the best candidates is a candidate, too. The sample grows from round to round and
//! is new in each. A faster candidate replaces the current best only if its certificate holds.
//!
//! Success of a few thousand trials does not imply success of a million, and the fastest gains are near the
//! limit at which trials fail. Failures start close to the goal, where few random starts are, or with more
//! noise. Therefore no trial may fail in an equal number of starts near the goal with [`STRESS`] times the
//! noise.

mod candidate;
mod search;
mod spec;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use surepose::control::Law;

pub use candidate::GainCandidate;
pub use spec::{STRESS, Tune};

use search::Search;
use spec::{slowest, stressed};

use crate::sweep::{Starts, Sweep, SweepReport};

/// Result of tuning.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneResult {
    /// Certified gains, no slower than the initial ones; `None` if no candidate was certified.
    pub best: Option<GainCandidate>,
    /// Initial gains.
    pub start: GainCandidate,
    /// Whether the initial gains are certified.
    pub start_certified: bool,
    /// Trials with the initial gains.
    pub before: SweepReport,
    /// Trials with the best gains from the same starts with the same noise; `None` if no candidate was
    /// certified.
    pub after: Option<SweepReport>,
    /// Success rates near the goal with [`STRESS`] times the noise: with the initial gains, and with the
    /// best.
    pub stressed_success: (Option<f64>, Option<f64>),
    /// Number of simulated candidates.
    pub candidates: usize,
    /// Number of requested certificates.
    pub certificates: usize,
}

/// Progress and cancel flag of a search, shared with its caller.
#[derive(Debug, Default)]
pub struct TuneProgress {
    sweeps: surepose_sim::CancelToken,
    steps: AtomicUsize,
}

/// Number of trials that evaluate the result of a canceled search, for a quick end.
const RUNS_AFTER_STOP: usize = 2000;

impl TuneProgress {
    /// Returns the number of completed rounds, including the evaluation.
    pub fn completed(&self) -> usize {
        self.steps.load(Ordering::Relaxed)
    }

    /// Cancels the search: the best certified candidate so far is still evaluated.
    pub fn cancel(&self) {
        self.sweeps.cancel();
    }

    fn count(&self) {
        self.steps.fetch_add(1, Ordering::Relaxed);
    }
}

impl Tune {
    /// Runs the search. `certified` returns whether a certificate holds for a law.
    pub fn run(&self, certified: &dyn Fn(&Law<f64>) -> bool, progress: &TuneProgress) -> TuneResult {
        let mut search = Search::new(self, certified, &progress.sweeps);
        let start_certified = search.begin();
        for round in 0..self.rounds {
            if progress.sweeps.is_cancelled() {
                break;
            }
            search.round(round);
            progress.count();
        }
        self.judged(&search, start_certified, progress)
    }

    /// Evaluates the best candidates on new trials and returns the first that passes.
    fn judged(&self, search: &Search<'_>, start_certified: bool, progress: &TuneProgress) -> TuneResult {
        let start = GainCandidate::from_law(&self.sweep.law);
        let starts = match &self.sweep.starts {
            Starts::Random(runs) if progress.sweeps.is_cancelled() => {
                Starts::Random(RUNS_AFTER_STOP.min(*runs))
            }
            starts => starts.clone(),
        };
        let fresh = Sweep { starts, ..self.sweep.clone() };
        let drive = |candidate: &GainCandidate| {
            let sweep = Sweep { law: candidate.with(&self.sweep.law), ..fresh.clone() };
            let stressed = stressed(&sweep).run(&surepose_sim::CancelToken::default());
            let report = sweep.run(&surepose_sim::CancelToken::default());
            (report, stressed.success_rate)
        };
        let before = drive(&start);
        let found = search.certified().rev().filter(|candidate| **candidate != start).find_map(|candidate| {
            let after = drive(candidate);
            // If the initial gains are not certified, they are no alternative, whatever their time.
            let stands = !start_certified || no_worse(&after.0, &before.0) && after.1 >= before.1;
            stands.then_some((*candidate, after))
        });
        progress.count();
        let (best, (after, stressed_after)) = match found {
            Some((best, (report, stressed))) => (Some(best), (Some(report), stressed)),
            None if start_certified => (Some(start), (Some(before.0.clone()), before.1)),
            None => (None, (None, None)),
        };
        let (before, stressed_before) = before;
        TuneResult {
            best,
            start,
            start_certified,
            before,
            after,
            stressed_success: (stressed_before, stressed_after),
            candidates: search.candidates(),
            certificates: search.certificates(),
        }
    }
}

/// Returns whether no figure is worse: success, median and 95 % quantile of the time ratio, and maximum time.
fn no_worse(report: &SweepReport, than: &SweepReport) -> bool {
    let (Some(now), Some(then)) = (report.time_ratio, than.time_ratio) else {
        return than.time_ratio.is_none();
    };
    report.success_rate >= than.success_rate
        && now.p50 <= then.p50
        && now.p95 <= then.p95
        && slowest(report) <= slowest(than)
}
