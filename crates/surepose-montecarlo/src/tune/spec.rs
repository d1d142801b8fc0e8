//! What to tune, and the trials and figures that candidates are judged by.

use crate::sweep::{Starts, Sweep, SweepReport};

use super::candidate::GainCandidate;

/// What to tune.
#[derive(Clone, Debug, PartialEq)]
pub struct Tune {
    /// The trials by which gains are judged in the end, with the law to begin from. The search has seeds of its own.
    pub sweep: Sweep,
    /// Other gains to begin from where the law's are not certified.
    pub fallback: GainCandidate,
    /// Least gains and capture radius that are tried.
    pub least: GainCandidate,
    /// The largest.
    pub most: GainCandidate,
    /// Rounds of the search.
    pub rounds: usize,
}

/// How much larger the noise is under which no trial may be lost either.
pub const STRESS: f64 = 1.3;

/// As many trials from near the goal, with [`STRESS`] times the noise.
pub(super) fn stressed(sweep: &Sweep) -> Sweep {
    Sweep {
        starts: Starts::near_goal(sweep.starts.len(), sweep.seed),
        noise: sweep.noise.scaled(STRESS),
        ..sweep.clone()
    }
}

/// The longest time of a trial that arrived \[s].
pub(super) fn slowest(report: &SweepReport) -> Option<f64> {
    report.time_s.map(|time| time.max)
}
