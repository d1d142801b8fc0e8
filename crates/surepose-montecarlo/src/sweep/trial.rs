//! What came of one trial.

use serde::Serialize;
use surepose::geometry::Angle;
use surepose::optimal;

use super::belief_batch::Consistency;
use super::bench::{DRIVE, Termination, limits};
use super::spec::Sweep;

/// A trial that ended, in few numbers: what can be worked out from them waits until all have ended.
#[derive(Clone, Debug)]
pub(super) struct TrialResult {
    /// Its place among the starts.
    pub(super) start_index: usize,
    /// Periods that were driven.
    pub(super) steps: u64,
    /// Whether the goal was held.
    pub(super) success: bool,
    /// The pose at the end.
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) heading: f64,
    /// Way \[m] and reversals until the robot came inside the tolerance.
    pub(super) path: f64,
    pub(super) cusps: f64,
    /// How good its beliefs were, if it had any.
    pub(super) belief: Option<Box<Consistency>>,
}

/// How a trial went.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// Start x \[m].
    pub start_x_m: f64,
    /// Start y \[m].
    pub start_y_m: f64,
    /// Start heading \[°].
    pub start_heading_deg: f64,
    /// Whether the goal was held before the time was up.
    pub success: bool,
    /// Periods that were driven.
    pub steps: u64,
    /// When the robot came inside the tolerance to stay \[s]; none where it failed.
    pub time_s: Option<f64>,
    /// The least time in which any controller could have been on the goal \[s].
    pub optimal_time_s: f64,
    /// How far it had driven by then \[m].
    pub path_m: Option<f64>,
    /// How often it had reversed by then.
    pub cusps: Option<f64>,
    /// Distance from the goal at the end of the hold, or of the time \[m].
    pub final_position_error_m: f64,
    /// Heading error then \[°].
    pub final_heading_error_deg: f64,
    /// The normalised estimation error squared, in the mean over the trial; none without a filter.
    pub nees_mean: Option<f64>,
    /// Root mean square of the error of the estimated position over the trial \[m]; none without a filter.
    pub position_rmse_m: Option<f64>,
    /// The same of the estimated heading \[°].
    pub heading_rmse_deg: Option<f64>,
    /// The part of the measurements that the gate kept out; none without a filter.
    pub refused_part: Option<f64>,
}

impl Trial {
    /// What came of a trial of `sweep`, with the least time that it could have taken; none where it has no start.
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

    /// Time over the least time; none for a failure, and for a start on the goal.
    pub fn time_ratio(&self) -> Option<f64> {
        self.time_s.filter(|_| self.optimal_time_s > 0.0).map(|time| time / self.optimal_time_s)
    }

    /// Way over the distance of the start; none for a failure, and for a start on the goal.
    pub fn path_ratio(&self) -> Option<f64> {
        let distance = self.start_x_m.hypot(self.start_y_m);
        self.path_m.filter(|_| distance > 0.0).map(|path| path / distance)
    }
}
