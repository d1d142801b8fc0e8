//! The rounds of the search.

use surepose::control::Law;
use surepose_sim::CancelToken;

use crate::sweep::{Starts, Sweep, SweepReport};

use super::candidate::{GainCandidate, NUMBERS, deviates, seed_of_round};
use super::spec::{Tune, slowest, stressed};

/// Candidates that a round draws.
const DRAWN: usize = 16;
/// How many of them are driven from all starts; the others only from a quarter.
const FINALISTS: usize = 4;
/// Certificates that a round asks for at most: where that many of its best are refused, it was too bold.
const ASKED: usize = 2;
/// Starts of the first round, and of the longest.
const STARTS: (usize, usize) = (1000, 16_000);
/// Standard deviation of the steps in the first round and in the last, in logarithms.
const STEP: (f64, f64) = (0.35, 0.05);

pub(super) struct Search<'a> {
    tune: &'a Tune,
    accepts: &'a dyn Fn(&Law<f64>) -> bool,
    cancel: &'a CancelToken,
    /// Round what the next candidates are drawn.
    centre: GainCandidate,
    /// Every best one so far, all of them certified; the last is the best.
    certified: Vec<GainCandidate>,
    candidates: usize,
    certificates: usize,
}

/// A candidate, and what it takes.
#[derive(Clone, Copy)]
struct Rated {
    candidate: GainCandidate,
    /// Less is better.
    cost: f64,
    /// The time of the slowest trial \[s].
    slowest: Option<f64>,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        tune: &'a Tune,
        accepts: &'a dyn Fn(&Law<f64>) -> bool,
        cancel: &'a CancelToken,
    ) -> Self {
        let centre = GainCandidate::from_law(&tune.sweep.law);
        Self { tune, accepts, cancel, centre, certified: Vec::new(), candidates: 0, certificates: 0 }
    }

    /// Every best one so far; the last is the best.
    pub(super) fn certified(&self) -> impl DoubleEndedIterator<Item = &GainCandidate> {
        self.certified.iter()
    }

    pub(super) fn candidates(&self) -> usize {
        self.candidates
    }

    pub(super) fn certificates(&self) -> usize {
        self.certificates
    }

    /// Asks for the certificate of the gains to begin from, and of the fallback where it is refused; whether the former
    /// has one.
    pub(super) fn begin(&mut self) -> bool {
        let start = self.centre;
        let mut asked = vec![start];
        if self.tune.fallback != start {
            asked.push(self.tune.fallback);
        }
        let found = asked.into_iter().find(|candidate| self.is_certified(candidate));
        self.centre = found.unwrap_or(start);
        self.certified.extend(found);
        found == Some(start)
    }

    /// Draws, drives, and moves to the best that is certified.
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
        // Without one, whatever always arrives is welcome.
        let better = better(&rated, incumbent).into_iter().take(ASKED);
        let found = better
            .map(|it| it.candidate)
            .find(|candidate| !self.cancel.is_cancelled() && self.is_certified(candidate));
        if let Some(candidate) = found {
            self.certified.push(candidate);
            self.centre = candidate;
        }
    }

    fn drawn(&self, round: usize, number: usize) -> GainCandidate {
        let deviates = deviates(self.tune.sweep.seed, round, number);
        let centre = self.centre.logarithms();
        // From the first step to the last in equal ratios.
        let done = round as f64 / self.tune.rounds.max(2).saturating_sub(1) as f64;
        let step = STEP.0 * libm::pow(STEP.1 / STEP.0, done);
        self.inside(core::array::from_fn(|k| centre[k] + step * deviates[k]))
    }

    /// The candidate of these logarithms, brought inside the bounds.
    fn inside(&self, logarithms: [f64; NUMBERS]) -> GainCandidate {
        let (least, most) = (self.tune.least.logarithms(), self.tune.most.logarithms());
        GainCandidate::from_logarithms(core::array::from_fn(|k| logarithms[k].max(least[k]).min(most[k])))
    }

    /// Drives every candidate from the same starts with the same noise; the best first. A search that was stopped rates
    /// nothing.
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

/// Those of `rated`, which the best begins, that may take the place of the incumbent, the best first.
///
/// The quantiles do not see the slowest trial, but the judgement in the end does: it is not to get slower on the way.
fn better(rated: &[Rated], incumbent: Option<GainCandidate>) -> Vec<Rated> {
    let before = rated.iter().find(|it| Some(it.candidate) == incumbent);
    let quicker = rated.iter().take_while(|it| Some(it.candidate) != incumbent && it.cost < LOST);
    quicker.filter(|it| before.is_none_or(|before| it.slowest <= before.slowest)).copied().collect()
}

/// No time ratios add up to this: beyond it lie the candidates that do not always arrive.
const LOST: f64 = 1e6;

/// The median and the 95 % quantile of the time ratio, added; for gains that lose trials, how many they lose.
fn cost(report: &SweepReport) -> f64 {
    let time = report.time_ratio.map_or(LOST, |ratio| ratio.p50 + ratio.p95);
    time + LOST * losses(report)
}

/// 0 where every trial arrived, and more than 1 where one did not.
fn losses(report: &SweepReport) -> f64 {
    match report.success_rate {
        Some(success) if success >= 1.0 => 0.0,
        success => 2.0 - success.unwrap_or(0.0),
    }
}

/// The mean of the logarithms of several candidates.
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
    fn what_is_quicker_but_slower_at_its_slowest_does_not_take_the_incumbent_s_place() {
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
