//! Rounds of the search.

use surepose::control::Law;
use surepose_sim::CancelToken;

use crate::sweep::{Starts, Sweep, SweepReport};

use super::candidate::{GainCandidate, NUMBERS, deviates, seed_of_round};
use super::spec::{Tune, slowest, stressed};

/// Number of candidates per round.
const DRAWN: usize = 16;
/// Number of candidates simulated from all starts; the others use a quarter of them.
const FINALISTS: usize = 4;
/// Maximum number of certificates per round; if that many candidates are refused, the step was too large.
const ASKED: usize = 2;
/// Number of starts of the first and of the largest round.
const STARTS: (usize, usize) = (1000, 16_000);
/// Standard deviation of the steps in the first and in the last round, in logarithms.
const STEP: (f64, f64) = (0.35, 0.05);

pub(super) struct Search<'a> {
    tune: &'a Tune,
    accepts: &'a dyn Fn(&Law<f64>) -> bool,
    cancel: &'a CancelToken,
    /// Center of the next candidates.
    center: GainCandidate,
    /// All certified best candidates so far; the last is the best.
    certified: Vec<GainCandidate>,
    candidates: usize,
    certificates: usize,
}

/// A candidate with its figures.
#[derive(Clone, Copy)]
struct Rated {
    candidate: GainCandidate,
    /// Cost; lower is better.
    cost: f64,
    /// Maximum time of a trial \[s]; `None` if no trial succeeded.
    slowest: Option<f64>,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        tune: &'a Tune,
        accepts: &'a dyn Fn(&Law<f64>) -> bool,
        cancel: &'a CancelToken,
    ) -> Self {
        let center = GainCandidate::from_law(&tune.sweep.law);
        Self { tune, accepts, cancel, center, certified: Vec::new(), candidates: 0, certificates: 0 }
    }

    /// Iterates over all certified best candidates so far; the last is the best.
    pub(super) fn certified(&self) -> impl DoubleEndedIterator<Item = &GainCandidate> {
        self.certified.iter()
    }

    pub(super) fn candidates(&self) -> usize {
        self.candidates
    }

    pub(super) fn certificates(&self) -> usize {
        self.certificates
    }

    /// Requests the certificate of the initial gains, and of the fallback if it is refused. Returns whether
    /// the initial gains have one.
    pub(super) fn begin(&mut self) -> bool {
        let start = self.center;
        let mut asked = vec![start];
        if self.tune.fallback != start {
            asked.push(self.tune.fallback);
        }
        let found = asked.into_iter().find(|candidate| self.is_certified(candidate));
        self.center = found.unwrap_or(start);
        self.certified.extend(found);
        found == Some(start)
    }

    /// Draws and simulates candidates, and moves to the best certified one.
    pub(super) fn round(&mut self, round: usize) {
        let starts = (STARTS.0 << (round / 3)).min(STARTS.1);
        let seed = seed_of_round(self.tune.sweep.seed, round);
        let drawn = (0..DRAWN).map(|number| self.drawn(round, number)).collect();
        let mut few = self.rated(drawn, starts / 4, seed);
        few.truncate(FINALISTS);
        let mut finalists: Vec<GainCandidate> = few.iter().map(|rated| rated.candidate).collect();
        finalists.extend(mean(&finalists).map(|mean| self.inside(mean)));
        finalists.extend(self.certified.last().copied());
        let rated = self.rated(finalists, starts, seed);

        let incumbent = self.certified.last().copied();
        // Without an incumbent, any candidate without failed trials is accepted.
        let better = better(&rated, incumbent).into_iter().take(ASKED);
        let found = better
            .map(|it| it.candidate)
            .find(|candidate| !self.cancel.is_cancelled() && self.is_certified(candidate));
        if let Some(candidate) = found {
            self.certified.push(candidate);
            self.center = candidate;
        }
    }

    fn drawn(&self, round: usize, number: usize) -> GainCandidate {
        let deviates = deviates(self.tune.sweep.seed, round, number);
        let center = self.center.logarithms();
        // Step sizes decrease geometrically from the first to the last round.
        let done = round as f64 / self.tune.rounds.max(2).saturating_sub(1) as f64;
        let step = STEP.0 * libm::pow(STEP.1 / STEP.0, done);
        self.inside(core::array::from_fn(|k| center[k] + step * deviates[k]))
    }

    /// Returns the candidate of these logarithms, clamped to the bounds.
    fn inside(&self, logarithms: [f64; NUMBERS]) -> GainCandidate {
        let (least, most) = (self.tune.least.logarithms(), self.tune.most.logarithms());
        GainCandidate::from_logarithms(core::array::from_fn(|k| logarithms[k].max(least[k]).min(most[k])))
    }

    /// Simulates every candidate from the same starts with the same noise, and sorts by cost. A canceled
    /// search returns nothing.
    fn rated(&mut self, candidates: Vec<GainCandidate>, starts: usize, seed: u64) -> Vec<Rated> {
        let mut rated = Vec::with_capacity(candidates.len());
        for candidate in candidates {
            let law = candidate.with(&self.tune.sweep.law);
            let sweep = Sweep { law, seed, starts: Starts::Random(starts), ..self.tune.sweep.clone() };
            let report = sweep.run(self.cancel);
            let cost = cost(&report) + LOST * losses(&stressed(&sweep).run(self.cancel));
            if self.cancel.is_cancelled() {
                return Vec::new();
            }
            self.candidates += 1;
            rated.push(Rated { candidate, cost, slowest: slowest(&report) });
        }
        rated.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        rated
    }

    fn is_certified(&mut self, candidate: &GainCandidate) -> bool {
        self.certificates += 1;
        (self.accepts)(&candidate.with(&self.tune.sweep.law))
    }
}

/// Returns the candidates of `rated`, sorted by cost, that may replace the incumbent.
///
/// The quantiles do not include the slowest trial, but the final evaluation does, so it must not become
/// slower.
fn better(rated: &[Rated], incumbent: Option<GainCandidate>) -> Vec<Rated> {
    let before = rated.iter().find(|it| Some(it.candidate) == incumbent);
    let quicker = rated.iter().take_while(|it| Some(it.candidate) != incumbent && it.cost < LOST);
    quicker.filter(|it| before.is_none_or(|before| it.slowest <= before.slowest)).copied().collect()
}

/// Cost offset of candidates with failed trials; no sum of time ratios reaches it.
const LOST: f64 = 1e6;

/// Returns median plus 95 % quantile of the time ratio; for gains with failed trials, their number plus an
/// offset.
fn cost(report: &SweepReport) -> f64 {
    let time = report.time_ratio.map_or(LOST, |ratio| ratio.p50 + ratio.p95);
    time + LOST * losses(report)
}

/// Returns 0 if every trial succeeded, otherwise a value above 1.
fn losses(report: &SweepReport) -> f64 {
    match report.success_rate {
        Some(success) if success >= 1.0 => 0.0,
        success => 2.0 - success.unwrap_or(0.0),
    }
}

/// Returns the mean of the candidates' logarithms; `None` without candidates.
fn mean(candidates: &[GainCandidate]) -> Option<[f64; NUMBERS]> {
    let logarithms: Vec<_> = candidates.iter().map(GainCandidate::logarithms).collect();
    let count = logarithms.len() as f64;
    (count > 0.0).then(|| core::array::from_fn(|k| logarithms.iter().map(|l| l[k]).sum::<f64>() / count))
}

#[cfg(test)]
mod tests {
    use surepose::control::Gains;

    use super::*;

    #[test]
    fn a_candidate_with_a_slower_slowest_trial_does_not_replace_the_incumbent() {
        let rated = |capture_radius: f64, cost: f64, slowest: f64| Rated {
            candidate: GainCandidate { gains: Gains::tran2012(), capture_radius },
            cost,
            slowest: Some(slowest),
        };
        let (hasty, sound, incumbent) =
            (rated(0.05, 2.0, 112.0), rated(0.04, 2.1, 18.0), rated(0.03, 2.3, 18.5));
        let all = [hasty, sound, incumbent, rated(0.02, 2.4, 17.0)];
        let found = |incumbent: Option<GainCandidate>| -> Vec<f64> {
            better(&all, incumbent).iter().map(|it| it.candidate.capture_radius).collect()
        };
        assert_eq!(found(Some(incumbent.candidate)), [0.04]);
        assert_eq!(found(None), [0.05, 0.04, 0.03, 0.02]);
    }
}
