//! Statistics of many kidnapping trials.

use serde::Serialize;

use super::spawn_area::SpawnArea;
use super::trial::{KidnappingSetup, KidnappingTrial, run_trial};

/// Deadline for a kidnapping to be flagged \[s].
const FLAG_DEADLINE: f64 = 1.0;

/// Statistics of kidnapping trials.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KidnappingStats {
    /// Number of trials.
    pub trials: usize,
    /// Trials with a robot flagged as lost before its displacement.
    pub false_alarms: usize,
    /// Trials flagged within one second.
    pub flagged: usize,
    /// Trials never flagged whose estimate was right after five seconds.
    pub unflagged_but_right: usize,
    /// Trials with a right estimate, not lost, five seconds after the displacement.
    pub recovered: usize,
    /// Trials not recovered in which several poses explain the scans.
    pub ambiguous: usize,
    /// Trials in which a wrong pose was accepted, even if corrected later.
    pub wrongly_found: usize,
    /// Trials with an error of more than five standard deviations while healthy for two seconds.
    pub confidently_wrong: usize,
    /// Mean NEES of the accepted poses of recovered trials; 3 if the covariance is consistent.
    pub nees_mean: f64,
    /// Median time from displacement to acceptance \[s]; NaN if no pose was accepted.
    pub found_median_s: f64,
    /// Seeds of trials that were confidently wrong, or neither recovered nor ambiguous.
    pub failed_seeds: Vec<u64>,
    /// Seeds of the other trials that were not flagged in time.
    pub late_seeds: Vec<u64>,
}

impl KidnappingStats {
    /// Returns the fraction of unambiguous trials that recovered.
    pub fn recovered_share(&self) -> f64 {
        self.recovered as f64 / (self.trials - self.ambiguous).max(1) as f64
    }

    /// Returns the fraction flagged in time of the trials that required a flag.
    pub fn flagged_share(&self) -> f64 {
        self.flagged as f64 / (self.trials - self.unflagged_but_right).max(1) as f64
    }
}

/// Runs one trial in `area` for each of `seeds`.
pub fn run_trials(
    area: &SpawnArea,
    setup: &KidnappingSetup,
    seeds: impl Iterator<Item = u64>,
) -> KidnappingStats {
    let mut sum = KidnappingStats::default();
    let (mut nees, mut times) = (Vec::new(), Vec::new());
    for seed in seeds {
        let trial = run_trial(area, setup, seed);
        let flagged = trial.flagged.is_some_and(|time| time <= FLAG_DEADLINE + 1e-6);
        sum.trials += 1;
        sum.false_alarms += usize::from(trial.false_alarm);
        sum.flagged += usize::from(flagged);
        sum.unflagged_but_right += usize::from(trial.flagged.is_none() && trial.recovered);
        sum.recovered += usize::from(trial.recovered);
        sum.ambiguous += usize::from(is_excused(&trial));
        sum.wrongly_found += usize::from(trial.wrongly_found > 0);
        sum.confidently_wrong += usize::from(trial.confidently_wrong);
        if trial.confidently_wrong || !(trial.recovered || trial.ambiguous) {
            sum.failed_seeds.push(seed);
        } else if !flagged {
            sum.late_seeds.push(seed);
        }
        times.extend(trial.found);
        nees.extend(trial.found_nees.filter(|_| trial.recovered));
    }
    times.sort_by(f64::total_cmp);
    sum.found_median_s = times.get(times.len() / 2).copied().unwrap_or(f64::NAN);
    sum.nees_mean = nees.iter().sum::<f64>() / nees.len().max(1) as f64;
    sum
}

fn is_excused(trial: &KidnappingTrial) -> bool {
    trial.ambiguous && !trial.recovered
}
