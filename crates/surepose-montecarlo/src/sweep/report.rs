//! What a sweep found, in the keys of the command line's contract.

use serde::Serialize;

use super::trial::Trial;

/// Median, 95 % quantile and largest of a number over the trials.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quantiles {
    /// Half of the trials have at most this.
    pub p50: f64,
    /// 95 % of the trials have at most this.
    pub p95: f64,
    /// No trial has more.
    pub max: f64,
}

impl Quantiles {
    /// The spread of `values`; none of nothing.
    pub fn from_values(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        // The smallest value that a part `q` of all does not exceed.
        let quantile = |q: f64| {
            let rank = (q * sorted.len() as f64).ceil() as usize;
            sorted.get(rank.saturating_sub(1)).copied().unwrap_or(max)
        };
        Some(Self { p50: quantile(0.5), p95: quantile(0.95), max })
    }
}

/// What a sweep found.
///
/// `time_s`, `time_ratio`, `path_ratio` and `cusps_mean` are over the trials that succeeded, up to the moment when the
/// robot came inside the tolerance to stay; the final errors are over all trials, when they ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepReport {
    /// Trials that were run.
    pub runs: usize,
    /// The part of them that succeeded; absent where none was run.
    pub success_rate: Option<f64>,
    /// Periods that were driven in all of them.
    pub steps: u64,
    /// How long that took \[s]; the bounds that the times are compared with are worked out after it.
    pub wall_s: f64,
    /// Periods per second of wall time.
    pub steps_per_s: f64,
    /// Time to the goal \[s].
    pub time_s: Option<Quantiles>,
    /// That time over the least possible.
    pub time_ratio: Option<Quantiles>,
    /// The way over the distance.
    pub path_ratio: Option<Quantiles>,
    /// Distance from the goal in the end \[m].
    pub final_position_error_m: Option<Quantiles>,
    /// Heading error in the end \[°].
    pub final_heading_error_deg: Option<Quantiles>,
    /// Changes of the speed's sign, in the mean.
    pub cusps_mean: Option<f64>,
    /// The normalised estimation error squared in the mean over all periods, 3 where the filter is consistent; none
    /// without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_mean: Option<f64>,
    /// Root mean square of the error of the estimated position over all periods \[m]; none without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_rmse_m: Option<f64>,
    /// The same of the estimated heading \[°].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_rmse_deg: Option<f64>,
    /// The part of the measurements that the gate kept out; none without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused_part: Option<f64>,
    /// What all randomness came from.
    pub seed: u64,
    /// Every trial, in the order of the starts.
    #[serde(skip)]
    pub trials: Vec<Trial>,
}

impl SweepReport {
    pub(super) fn from_trials(trials: Vec<Trial>, wall_s: f64, seed: u64) -> Self {
        let steps = trials.iter().map(|trial| trial.steps).sum::<u64>();
        let spread =
            |value: fn(&Trial) -> Option<f64>| Quantiles::from_values(trials.iter().filter_map(value));
        let mean =
            |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        // A trial weighs as much as it has periods.
        let over_periods = |value: fn(&Trial) -> Option<f64>| {
            let sum: Option<f64> = trials.iter().map(|trial| Some(value(trial)? * trial.steps as f64)).sum();
            sum.filter(|_| steps > 0).map(|sum| sum / steps as f64)
        };
        let nees_mean = over_periods(|trial| trial.nees_mean);
        let position = over_periods(|trial| trial.position_rmse_m.map(|rmse| rmse * rmse));
        let heading = over_periods(|trial| trial.heading_rmse_deg.map(|rmse| rmse * rmse));
        let refused_part = over_periods(|trial| trial.refused_part);
        Self {
            runs: trials.len(),
            success_rate: mean(trials.iter().map(|trial| f64::from(u8::from(trial.success))).collect()),
            steps,
            wall_s,
            steps_per_s: steps as f64 / wall_s.max(1e-9),
            time_s: spread(|trial| trial.time_s),
            time_ratio: spread(Trial::time_ratio),
            path_ratio: spread(Trial::path_ratio),
            final_position_error_m: spread(|trial| Some(trial.final_position_error_m)),
            final_heading_error_deg: spread(|trial| Some(trial.final_heading_error_deg)),
            cusps_mean: mean(trials.iter().filter_map(|trial| trial.cusps).collect()),
            nees_mean,
            position_rmse_m: position.map(f64::sqrt),
            heading_rmse_deg: heading.map(f64::sqrt),
            refused_part,
            seed,
            trials,
        }
    }
}
