//! Result of one trial.

use serde::Serialize;
use surepose::geometry::Angle;
use surepose::optimal;

use super::belief_batch::Consistency;
use super::bench::{DRIVE, Termination, limits};
use super::spec::Sweep;

/// Raw result of a trial; derived figures are computed after all trials have ended.
#[derive(Clone, Debug)]
pub(super) struct TrialResult {
    /// Index of the start.
    pub(super) start_index: usize,
    /// Number of simulated periods.
    pub(super) steps: u64,
    /// Whether the goal was held.
    pub(super) success: bool,
    /// Pose at the end.
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) heading: f64,
    /// Path length \[m] and reversals until the final entry into the tolerance.
    pub(super) path: f64,
    pub(super) cusps: f64,
    /// Evaluation of the beliefs; `None` without a filter.
    pub(super) belief: Option<Box<Consistency>>,
}

/// Figures of one trial.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// Start x \[m].
    pub start_x_m: f64,
    /// Start y \[m].
    pub start_y_m: f64,
    /// Start heading \[°].
    pub start_heading_deg: f64,
    /// Whether the goal was held before the timeout.
    pub success: bool,
    /// Number of simulated periods.
    pub steps: u64,
    /// Time of the final entry into the tolerance \[s]; `None` for a failure.
    pub time_s: Option<f64>,
    /// Time of the time-optimal trajectory \[s].
    pub optimal_time_s: f64,
    /// Path length until then \[m]; `None` for a failure.
    pub path_m: Option<f64>,
    /// Number of reversals until then; `None` for a failure.
    pub cusps: Option<f64>,
    /// Distance to the goal at the end of the hold or at the timeout \[m].
    pub final_position_error_m: f64,
    /// Heading error at that time \[°].
    pub final_heading_error_deg: f64,
    /// Mean of the normalized estimation error squared (NEES) over the trial; `None` without a filter.
    pub nees_mean: Option<f64>,
    /// Root mean square error of the estimated position over the trial \[m]; `None` without a filter.
    pub position_rmse_m: Option<f64>,
    /// Root mean square error of the estimated heading over the trial \[°]; `None` without a filter.
    pub heading_rmse_deg: Option<f64>,
    /// Fraction of the measurements that the gate rejected; `None` without a filter.
    pub refused_part: Option<f64>,
}

impl Trial {
    /// Computes the figures of a trial of `sweep`; `None` if its start does not exist.
    pub(super) fn from_result(ended: &TrialResult, sweep: &Sweep, termination: Termination) -> Option<Self> {
        let start = sweep.starts.nth(sweep.seed, ended.start_index)?;
        let belief = ended.belief.as_deref();
        Some(Self {
            start_x_m: start.x,
            start_y_m: start.y,
            start_heading_deg: start.heading.degrees(),
            success: ended.success,
            steps: ended.steps,
            time_s: ended.success.then_some((ended.steps as f64 - (termination.held - 1.0)) * sweep.period),
            optimal_time_s: optimal::fastest(start, &DRIVE, limits().wheel_speed).time,
            path_m: ended.success.then_some(ended.path),
            cusps: ended.success.then_some(ended.cusps),
            final_position_error_m: ended.x.hypot(ended.y),
            final_heading_error_deg: Angle::from_radians(ended.heading).degrees().abs(),
            nees_mean: belief.map(|belief| belief.nees_mean),
            position_rmse_m: belief.map(|belief| belief.position_rmse),
            heading_rmse_deg: belief.map(|belief| belief.heading_rmse.to_degrees()),
            refused_part: belief.map(|belief| belief.refused),
        })
    }

    /// Returns time over optimal time; `None` for a failure and for a start at the goal.
    pub fn time_ratio(&self) -> Option<f64> {
        self.time_s.filter(|_| self.optimal_time_s > 0.0).map(|time| time / self.optimal_time_s)
    }

    /// Returns path length over start distance; `None` for a failure and for a start at the goal.
    pub fn path_ratio(&self) -> Option<f64> {
        let distance = self.start_x_m.hypot(self.start_y_m);
        self.path_m.filter(|_| distance > 0.0).map(|path| path / distance)
    }
}
