//! Parameters of tuning, and the trials and figures that evaluate candidates.

use crate::sweep::{Starts, Sweep, SweepReport};

use super::candidate::GainCandidate;

/// Parameters of tuning.
#[derive(Clone, Debug, PartialEq)]
pub struct Tune {
    /// Trials of the final evaluation, with the initial law; the search uses other seeds.
    pub sweep: Sweep,
    /// Initial gains if those of the law are not certified.
    pub fallback: GainCandidate,
    /// Lower bounds of gains and capture radius.
    pub least: GainCandidate,
    /// Upper bounds of gains and capture radius.
    pub most: GainCandidate,
    /// Number of rounds.
    pub rounds: usize,
}

/// Noise factor of the stress trials, none of which may fail.
pub const STRESS: f64 = 1.3;

/// Returns an equal number of trials near the goal with [`STRESS`] times the noise.
pub(super) fn stressed(sweep: &Sweep) -> Sweep {
    Sweep {
        starts: Starts::near_goal(sweep.starts.len(), sweep.seed),
        noise: sweep.noise.scaled(STRESS),
        ..sweep.clone()
    }
}

/// Returns the maximum time of the successful trials \[s]; `None` without one.
pub(super) fn slowest(report: &SweepReport) -> Option<f64> {
    report.time_s.map(|time| time.max)
}
