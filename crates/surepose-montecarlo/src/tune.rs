//! The gains with which the bench trial takes least time, among those that always arrive and that a certificate holds for.
//!
//! The search is random and local, as evolution strategies are [BeyerSchwefel2002]: each round draws candidates round the
//! best one known, drives all of them from the same starts with the same noise, the better ones from more starts, and
//! looks at the mean of the best as well. The sample grows from round to round and is new each time. A candidate
//! that is quicker than the best one known takes its place only once the certificate holds for it.
//!
//! That every trial of a few thousand arrives does not say that one of a million will not be lost, and the quickest gains
//! lie where trials begin to be lost: from starts so near the goal that few random ones are, or by more noise. So
//! no trial may be lost of as many that start near the goal with [`STRESS`] times the noise either.

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

/// What tuning found.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneResult {
    /// The gains to use: certified, and no slower than those to begin from. None where nothing was certified.
    pub best: Option<GainCandidate>,
    /// The gains that the search began with, and whether they are certified.
    pub start: GainCandidate,
    /// Whether those are certified.
    pub start_certified: bool,
    /// The trials with them.
    pub before: SweepReport,
    /// The trials with the best: from the same starts with the same noise. None where nothing was certified.
    pub after: Option<SweepReport>,
    /// The parts of the trials that succeed from near the goal with [`STRESS`] times the noise: with the gains to begin
    /// from, and with the best.
    pub stressed_success: (Option<f64>, Option<f64>),
    /// How many candidates were driven.
    pub candidates: usize,
    /// How often the certificate was asked for.
    pub certificates: usize,
}

/// How far a search is, and whether it shall end early. Shared with whoever watches.
#[derive(Debug, Default)]
pub struct TuneProgress {
    sweeps: surepose_sim::CancelToken,
    steps: AtomicUsize,
}

/// Trials that judge the result of a search that was stopped: whoever stopped it does not want to wait.
const RUNS_AFTER_STOP: usize = 2000;

impl TuneProgress {
    /// How many of the rounds, and the judgement after them, are done.
    pub fn completed(&self) -> usize {
        self.steps.load(Ordering::Relaxed)
    }

    /// Ends the search: the best that was certified so far is still judged.
    pub fn cancel(&self) {
        self.sweeps.cancel();
    }

    fn count(&self) {
        self.steps.fetch_add(1, Ordering::Relaxed);
    }
}

impl Tune {
    /// Searches. `certified` says whether a law may be used.
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

    /// The best candidates on trials that the search has not seen: the first that stands the test is taken.
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
            // Gains that are not certified are no rival: whatever they take, they may not be used.
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

/// Whether no figure that counts is worse: success, the median and 95 % quantile of the time ratio, and the slowest trial,
/// which neither of them sees.
fn no_worse(report: &SweepReport, than: &SweepReport) -> bool {
    let (Some(now), Some(then)) = (report.time_ratio, than.time_ratio) else {
        return than.time_ratio.is_none();
    };
    report.success_rate >= than.success_rate
        && now.p50 <= then.p50
        && now.p95 <= then.p95
        && slowest(report) <= slowest(than)
}
