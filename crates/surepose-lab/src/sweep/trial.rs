//! What came of one trial.

use serde::Serialize;
use surepose::Angle;

use super::Start;
use super::bench::{DRIVE, limits};
use crate::optimal;

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
    /// Works out the least time: it takes as long as many periods in lanes, so it is done after them.
    pub(super) fn bounded(mut self) -> Self {
        let start = Start::new(self.start_x_m, self.start_y_m, Angle::from_degrees(self.start_heading_deg));
        self.optimal_time_s = optimal::fastest(start, &DRIVE, limits().wheel_speed).time;
        self
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
