//! Many kidnappings, summed up.

use serde::Serialize;

use super::spawn_area::SpawnArea;
use super::trial::{KidnappingSetup, KidnappingTrial, run_trial};

/// The time in which a kidnapping must be flagged \[s].
const FLAG_DEADLINE: f64 = 1.0;

/// What came of many kidnappings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KidnappingStats {
    /// How many there were.
    pub trials: usize,
    /// Flagged as lost although nobody had touched the robot.
    pub false_alarms: usize,
    /// Flagged within one second.
    pub flagged: usize,
    /// Never flagged, because the estimate was right all the same after five seconds.
    pub unflagged_but_right: usize,
    /// Healthy and right five seconds after.
    pub recovered: usize,
    /// Not so, because several poses explain what was seen.
    pub ambiguous: usize,
    /// Found somewhere else than where it was; each may have been mended since.
    pub wrongly_found: usize,
    /// Wrong by five standard deviations while healthy for two seconds.
    pub confidently_wrong: usize,
    /// The mean of NEES where it was found right; 3 for an honest covariance.
    pub nees_mean: f64,
    /// The median time until it was found \[s].
    pub found_median_s: f64,
    /// The seeds of the trials that were neither recovered nor ambiguous, and of those confidently wrong.
    pub failed_seeds: Vec<u64>,
    /// The seeds of the other trials that were not flagged in time.
    pub late_seeds: Vec<u64>,
}

impl KidnappingStats {
    /// The part that was recovered, of those whose place is not ambiguous.
    pub fn recovered_share(&self) -> f64 {
        self.recovered as f64 / (self.trials - self.ambiguous).max(1) as f64
    }

    /// The part that was flagged in time, of those that had to be.
    pub fn flagged_share(&self) -> f64 {
        self.flagged as f64 / (self.trials - self.unflagged_but_right).max(1) as f64
    }
}

/// Kidnaps a robot in `area` once for each of `seeds`.
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
