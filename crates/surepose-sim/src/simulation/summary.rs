//! Figures of a drive, named as in the JSON of the command line.

use serde::{Serialize, Serializer};
use surepose::estimation::{MeasurementStats, RejectReason};

/// Outcome of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SimulationOutcome {
    /// The robot rests at the goal, by its true pose.
    Reached,
    /// The robot rests within the tolerance by its estimate, and outside by its true pose.
    Missed,
    /// Time ran out.
    Timeout,
    /// It was stopped on the way.
    Stopped,
    /// It was interrupted before its end.
    Interrupted,
}

/// The figures of one drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SimulationSummary {
    /// Outcome.
    pub outcome: SimulationOutcome,
    /// Reason of a stop or an abort; `None` without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_reason: Option<&'static str>,
    /// Reason of a stop or an abort; `stop_reason` is its previous name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'static str>,
    /// Duration, including the hold time.
    pub time_s: f64,
    /// True distance to the goal at the end.
    pub final_position_error_m: f64,
    /// True heading error at the end.
    pub final_heading_error_deg: f64,
    /// True speed at the end.
    pub final_speed_m_s: f64,
    /// True turn rate at the end.
    pub final_turn_rate_deg_s: f64,
    /// Root mean square of the estimate's position error over the drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_rmse_m: Option<f64>,
    /// Root mean square of the estimate's heading error over the drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_rmse_deg: Option<f64>,
    /// Mean of the normalized estimation error squared (NEES); 3 for a consistent filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_mean: Option<f64>,
    /// Length of the true path.
    pub path_length_m: f64,
    /// Time of the time-optimal trajectory for these wheel speeds, without acceleration limits.
    pub optimal_time_s: f64,
    /// Least distance of the robot's center from a wall; negative outside of the arena.
    pub closest_wall_m: f64,
    /// Largest commanded rim speed.
    pub wheel_speed_max_m_s: f64,
    /// Largest commanded acceleration of a rim.
    pub wheel_acceleration_max_m_s2: f64,
    /// Measurements that corrected the estimate.
    pub accepted: u32,
    /// Number of these that were walls.
    pub walls: u32,
    /// Measurements that the filter rejected, by reason.
    pub rejected: RejectedCounts,
    /// Sensor that disagreed with the others beyond noise and considered errors: `compass`, `laser` or `map`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disagreeing_sensor: Option<&'static str>,
    /// Time at which the disagreement was first noticed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inconsistent_from_s: Option<f64>,
    /// Seed of all randomness; the same seed repeats the drive.
    pub seed: u64,
}

/// Counts of rejected measurements; serialized as an object, reason to count, with every reason.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RejectedCounts(MeasurementStats);

impl RejectedCounts {
    /// Takes the counts from the statistics of a filter.
    pub fn from_stats(stats: &MeasurementStats) -> Self {
        Self(*stats)
    }

    /// Number of all rejected measurements.
    pub fn total(&self) -> u32 {
        self.0.rejected_total()
    }

    /// Number of measurements rejected for `reason`.
    pub fn get(&self, reason: RejectReason) -> u32 {
        self.0.rejected(reason)
    }
}

impl Serialize for RejectedCounts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(RejectReason::ALL.iter().map(|reason| (reason.name(), self.get(*reason))))
    }
}
