//! Report of a replay, named as in the command line's JSON, and its errors.

use std::collections::BTreeMap;

use serde::Serialize;
use surepose::estimation::{MeasurementStats, RejectReason};
use surepose::geometry::{Body, Map, Pose};
use surepose_io::DataError;
use surepose_sim::ErrorSummary;

use super::grid_localizer::ConsistencyShares;
use super::track::{AbsolutePoseError, RelativePoseError, Track};

/// Figures of one replay; those that need a reference are `None` for recordings without one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Odometry records with motion.
    pub steps: u64,
    /// Time from the first to the last of them \[s]; `None` if the recording's stamps are too coarse.
    #[serde(skip_serializing_if = "is_unknown")]
    pub duration_s: f64,
    /// Length of the path \[m].
    pub distance_m: f64,
    /// Processing time, including reading \[s].
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
    /// Mean of the normalized estimation error squared (NEES); 3 for a consistent filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_mean: Option<f64>,
    /// Median of the NEES; 2.37 for a consistent filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nees_median: Option<f64>,
    /// Root mean square position error of the recorded odometry alone \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead_reckoning_position_rmse_m: Option<f64>,
    /// Root mean square heading error of the recorded odometry alone \[°].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead_reckoning_heading_rmse_deg: Option<f64>,
    /// Absolute pose error of the judged estimates, without alignment.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ape: Option<AbsolutePoseError>,
    /// Relative pose error of the judged estimates over one meter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rpe: Option<RelativePoseError>,
    /// Fraction of the recording in which the estimate could be judged; `None` without reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub judged_share: Option<f64>,
    /// Fraction of the returns on walls of the map, mean over scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beams_on_walls: Option<f64>,
    /// Time of global localization since the start of the recording \[s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_s: Option<f64>,
    /// Localized pose: x \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_x_m: Option<f64>,
    /// Localized pose: y \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_y_m: Option<f64>,
    /// Localized pose: heading \[°].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found_heading_deg: Option<f64>,
    /// Number of remaining hypotheses at the end; 1 if the robot was localized.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hypotheses_left: Option<usize>,
    /// Number of localized poses that were withdrawn because later scans contradicted them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withdrawn: Option<u32>,
    /// Fraction of the observed surface on walls of the map, by the localized pose or the most likely
    /// hypothesis. Each surface cell counts once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained: Option<f64>,
    /// Fraction of the observed surface in front of walls: people and furniture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before_walls: Option<f64>,
    /// Fraction of the observed surface where the map allows no observation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_walls: Option<f64>,
    /// Delay of a scan's record in the log, in odometry records, and its standard error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan_lag_records: Option<f64>,
    /// Standard error of the delay, in odometry records.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan_lag_std_records: Option<f64>,
    /// Number of poses found by a search around an estimate that a scan contradicted; `None` without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relocalizations: Option<u32>,
    /// Measurements that corrected the estimate.
    pub accepted: u32,
    /// Measurements that the filter rejected, by reason.
    pub rejected: BTreeMap<&'static str, u32>,
    /// Records that did not reach the filter, by kind.
    pub skipped: BTreeMap<&'static str, u32>,
    /// Estimated trajectory, for files and pictures.
    #[serde(skip)]
    pub track: Track,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_unknown(duration: &f64) -> bool {
    *duration <= 0.0
}

impl ReplayReport {
    /// Sets the errors of the filter.
    pub fn set_filter_errors(&mut self, filter: Option<ErrorSummary>) {
        self.position_rmse_m = filter.map(|summary| summary.position_rmse);
        self.heading_rmse_deg = filter.map(|summary| summary.heading_rmse.to_degrees());
        self.position_median_m = filter.map(|summary| summary.position_median);
        self.nees_mean = filter.and_then(|summary| summary.nees_mean);
        self.nees_median = filter.and_then(|summary| summary.nees_median);
    }

    /// Sets the errors of the filter and keeps its trajectory. `reference_interval` is that of [`Track::judged_share`]; `None` for
    /// a recording without reference.
    pub fn set_track(&mut self, track: Track, reference_interval: Option<f64>) {
        self.set_filter_errors(track.summary());
        (self.ape, self.rpe) = (track.absolute_error(), track.relative_error());
        self.judged_share =
            reference_interval.map(|interval| track.judged_share(interval).unwrap_or_default());
        self.track = track;
    }

    /// Sets the errors of the odometry alone.
    pub fn set_odometry_errors(&mut self, odometry: Option<ErrorSummary>) {
        self.dead_reckoning_position_rmse_m = odometry.map(|summary| summary.position_rmse);
        self.dead_reckoning_heading_rmse_deg = odometry.map(|summary| summary.heading_rmse.to_degrees());
    }

    /// Records a localization at `pose`, `after` seconds from the start of the recording.
    pub(super) fn found(&mut self, after: f64, pose: Pose<Map, Body, f64>) {
        self.found_s = Some(after);
        (self.found_x_m, self.found_y_m) = (Some(pose.x), Some(pose.y));
        self.found_heading_deg = Some(pose.heading.degrees());
    }

    /// Records the withdrawal of a localized pose.
    pub(super) fn withdraw(&mut self) {
        self.withdrawn = Some(self.withdrawn.unwrap_or(0) + 1);
        (self.found_s, self.found_x_m, self.found_y_m, self.found_heading_deg) = (None, None, None, None);
    }

    /// Sets what a hypothesis explains.
    pub(super) fn set_consistency(&mut self, consistency: Option<ConsistencyShares>) {
        self.explained = consistency.map(|consistency| consistency.hits);
        self.before_walls = consistency.map(|consistency| consistency.short);
        self.beyond_walls = consistency.map(|consistency| consistency.behind_wall);
    }

    /// Counts a record that did not reach the filter; `None` counts nothing.
    pub fn skip(&mut self, kind: Option<&'static str>) {
        if let Some(kind) = kind {
            *self.skipped.entry(kind).or_default() += 1;
        }
    }

    /// Sets the measurement statistics; every reason has an entry, even if 0.
    pub fn count(&mut self, stats: &MeasurementStats) {
        self.accepted = stats.accepted;
        self.rejected =
            RejectReason::ALL.iter().map(|reason| (reason.name(), stats.rejected(*reason))).collect();
    }
}

/// Reasons for which a replay fails.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording cannot be read or is malformed.
    #[error(transparent)]
    Data(#[from] DataError),
    /// No odometry.
    #[error("recording: no odometry (no ODOM lines); replay a log with odometry")]
    NoOdometry,
    /// No map, and no reference poses to make one.
    #[error("recording: no reference poses, from which a map is made; give a map with --map")]
    NoMap,
    /// No pose to start from.
    #[error(
        "recording: no reference pose at the time of any odometry record, start unknown; check the stamps of odometry and reference"
    )]
    NoStart,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys that scripts rely on; missing values are absent, never 0 or null.
    #[test]
    fn the_json_has_the_documented_keys() {
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
