//! Report of a sweep, named as in the command line's JSON.

use serde::Serialize;

use super::trial::Trial;

/// Median, 95 % quantile and maximum over the trials.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quantiles {
    /// Median.
    pub p50: f64,
    /// 95 % quantile.
    pub p95: f64,
    /// Maximum.
    pub max: f64,
}

impl Quantiles {
    /// Computes the quantiles of `values`; `None` if there are no values.
    pub fn from_values(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        // The smallest value that is not below a fraction `q` of all.
        let quantile = |q: f64| {
            let rank = (q * sorted.len() as f64).ceil() as usize;
            sorted.get(rank.saturating_sub(1)).copied().unwrap_or(max)
        };
        Some(Self { p50: quantile(0.5), p95: quantile(0.95), max })
    }
}

/// Results of a sweep.
///
/// `time_s`, `time_ratio`, `path_ratio` and `cusps_mean` are over the successful trials, up to the final
/// entry into the tolerance. Final errors are over all trials, at their end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepReport {
    /// Number of trials.
    pub runs: usize,
    /// Fraction of successful trials; `None` without trials.
    pub success_rate: Option<f64>,
    /// Simulated periods of all trials.
    pub steps: u64,
    /// Duration of the simulation \[s], without the computation of optimal times.
    pub wall_s: f64,
    /// Periods per second of `wall_s`.
    pub steps_per_s: f64,
    /// Time to the goal \[s].
    pub time_s: Option<Quantiles>,
    /// Time to the goal over the optimal time.
    pub time_ratio: Option<Quantiles>,
    /// Path length over the distance of start and goal.
    pub path_ratio: Option<Quantiles>,
    /// Distance to the goal at the end \[m].
    pub final_position_error_m: Option<Quantiles>,
    /// Heading error at the end \[°].
    pub final_heading_error_deg: Option<Quantiles>,
    /// Mean number of reversals.
    pub cusps_mean: Option<f64>,
    /// Mean of the normalized estimation error squared (NEES) over all periods, 3 for a consistent filter;
    /// `None` without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_mean: Option<f64>,
    /// Root mean square error of the estimated position over all periods \[m]; `None` without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_rmse_m: Option<f64>,
    /// Root mean square error of the estimated heading over all periods \[°]; `None` without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_rmse_deg: Option<f64>,
    /// Fraction of the measurements that the gate rejected; `None` without a filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused_part: Option<f64>,
    /// Seed of all randomness.
    pub seed: u64,
    /// All trials, ordered by start.
    #[serde(skip)]
    pub trials: Vec<Trial>,
}

impl SweepReport {
    /// Computes the figures of `trials`, which took `wall_s` \[s].
    pub fn from_trials(trials: Vec<Trial>, wall_s: f64, seed: u64) -> Self {
        let steps = trials.iter().map(|trial| trial.steps).sum::<u64>();
        let spread =
            |value: fn(&Trial) -> Option<f64>| Quantiles::from_values(trials.iter().filter_map(value));
        let mean =
            |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        // A trial is weighted by its number of periods.
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
