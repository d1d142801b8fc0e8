//! What a replay found, under the names of the command line's JSON, and why it may fail.

use std::collections::BTreeMap;

use serde::Serialize;
use surepose::estimation::{MeasurementStats, RejectReason};
use surepose::geometry::{Body, Map, Pose};
use surepose_io::DataError;
use surepose_sim::ErrorSummary;

use super::grid_localizer::ConsistencyShares;

/// The figures of one replay; those that need a reference are absent where the recording has none.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Odometry records that moved the estimate.
    pub steps: u64,
    /// Time from the first to the last of them \[s]; absent where the recording's stamps are too coarse to tell.
    #[serde(skip_serializing_if = "is_unknown")]
    pub duration_s: f64,
    /// Length of the way \[m].
    pub distance_m: f64,
    /// Time that reading and replaying took \[s].
    pub wall_s: f64,
    /// Root mean square of the position error \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_rmse_m: Option<f64>,
    /// Root mean square of the heading error \[°].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_rmse_deg: Option<f64>,
    /// Median of the position error \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_median_m: Option<f64>,
    /// Mean of the normalised estimation error squared; 3 for a consistent filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_mean: Option<f64>,
    /// Median of the same; 2.37 for a consistent filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_median: Option<f64>,
    /// Position error of the recorded odometry alone \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead_reckoning_position_rmse_m: Option<f64>,
    /// Heading error of the recorded odometry alone \[°].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead_reckoning_heading_rmse_deg: Option<f64>,
    /// Part of the beams that came back which lie on walls of the map, mean over scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beams_on_walls: Option<f64>,
    /// When one place was left that explains the scans, for a recording that started anywhere \[s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_s: Option<f64>,
    /// Where that was: x \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_x_m: Option<f64>,
    /// Where that was: y \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_y_m: Option<f64>,
    /// Where that was: heading \[°].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_heading_deg: Option<f64>,
    /// How many places explain the scans in the end; 1 where the robot was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hypotheses_left: Option<usize>,
    /// How often a place was withdrawn because it did not explain what was seen from there afterwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withdrawn: Option<u32>,
    /// Part of the surface that was seen which lies on walls of the map, from where the robot was found or from the likeliest
    /// place; each piece as large as a cell counts once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained: Option<f64>,
    /// Part of it that stands before walls, as people and furniture do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before_walls: Option<f64>,
    /// Part of it where nothing could be seen if the map were right.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_walls: Option<f64>,
    /// Measurements that corrected the estimate.
    pub accepted: u32,
    /// Measurements that the filter refused, by reason.
    pub rejected: BTreeMap<&'static str, u32>,
    /// Records that are no measurement of the map, by kind; the filter never saw them.
    pub skipped: BTreeMap<&'static str, u32>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
fn is_unknown(duration: &f64) -> bool {
    *duration <= 0.0
}

impl ReplayReport {
    /// Fills in the figures of the filter.
    pub fn set_filter_errors(&mut self, filter: Option<ErrorSummary>) {
        self.position_rmse_m = filter.map(|summary| summary.position_rmse);
        self.heading_rmse_deg = filter.map(|summary| summary.heading_rmse.to_degrees());
        self.position_median_m = filter.map(|summary| summary.position_median);
        self.nees_mean = filter.and_then(|summary| summary.nees_mean);
        self.nees_median = filter.and_then(|summary| summary.nees_median);
    }

    /// Fills in the figures of the odometry alone.
    pub fn set_odometry_errors(&mut self, odometry: Option<ErrorSummary>) {
        self.dead_reckoning_position_rmse_m = odometry.map(|summary| summary.position_rmse);
        self.dead_reckoning_heading_rmse_deg = odometry.map(|summary| summary.heading_rmse.to_degrees());
    }

    /// The robot was found at `pose`, so many seconds after the recording began.
    pub(super) fn found(&mut self, after: f64, pose: Pose<Map, Body, f64>) {
        self.found_s = Some(after);
        (self.found_x_m, self.found_y_m) = (Some(pose.x), Some(pose.y));
        self.found_heading_deg = Some(pose.heading.degrees());
    }

    /// The robot is not where it was found.
    pub(super) fn withdraw(&mut self) {
        self.withdrawn = Some(self.withdrawn.unwrap_or(0) + 1);
        (self.found_s, self.found_x_m, self.found_y_m, self.found_heading_deg) = (None, None, None, None);
    }

    /// Fills in what a place explains.
    pub(super) fn set_consistency(&mut self, consistency: Option<ConsistencyShares>) {
        self.explained = consistency.map(|consistency| consistency.hits);
        self.before_walls = consistency.map(|consistency| consistency.short);
        self.beyond_walls = consistency.map(|consistency| consistency.behind_wall);
    }

    /// Counts a record that the filter never saw, if there is a name for why.
    pub fn skip(&mut self, kind: Option<&'static str>) {
        if let Some(kind) = kind {
            *self.skipped.entry(kind).or_default() += 1;
        }
    }

    /// Fills in what became of the measurements; every reason is named, also those that never occurred.
    pub fn count(&mut self, stats: &MeasurementStats) {
        self.accepted = stats.accepted;
        self.rejected =
            RejectReason::ALL.iter().map(|reason| (reason.name(), stats.rejected(*reason))).collect();
    }
}

/// Why a recording could not be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording is unreadable or malformed.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Nothing says where the robot starts.
    #[error("no reference pose at the time of any odometry record, so there is nowhere to start")]
    NoStart,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The keys that scripts rely on; what does not exist is absent, never 0 and never null.
    #[test]
    fn the_json_has_the_promised_keys() {
        let keys = |report: &ReplayReport| -> Vec<String> {
            let json = serde_json::to_value(report).unwrap();
            let mut keys: Vec<String> = json.as_object().unwrap().keys().cloned().collect();
            keys.sort();
            keys
        };
        let always = ["accepted", "distance_m", "duration_s", "rejected", "skipped", "steps", "wall_s"];
        let mut report = ReplayReport { duration_s: 60.0, ..ReplayReport::default() };
        assert_eq!(keys(&report), always);
        let without_stamps = keys(&ReplayReport::default());
        assert!(!without_stamps.iter().any(|key| key == "duration_s"), "{without_stamps:?}");

        let summary = ErrorSummary {
            position_rmse: 1.0,
            position_median: 1.0,
            heading_rmse: core::f64::consts::PI,
            nees_mean: Some(3.0),
            nees_median: Some(2.4),
        };
        report.set_filter_errors(Some(summary));
        report.set_odometry_errors(Some(summary));
        let with_reference = keys(&report);
        for key in [
            "position_rmse_m",
            "heading_rmse_deg",
            "position_median_m",
            "nees_mean",
            "nees_median",
            "dead_reckoning_position_rmse_m",
            "dead_reckoning_heading_rmse_deg",
        ] {
            assert!(with_reference.iter().any(|present| present == key), "{key}");
        }
        assert!((report.heading_rmse_deg.unwrap() - 180.0).abs() < 1e-12);
    }
}
