//! Replay of CARMEN logs: raw odometry predicts, the laser corrects, SLAM poses are the reference.
//!
//! Without a given map, every second scan at its reference pose makes the map. The estimate uses, and is
//! evaluated at, the other scans only.

mod lag;
mod supervised_replay;
mod wide_search;

use std::time::Instant;

use surepose::geometry::{Body, Map, Pose};
use surepose::lidar::BeamModelMatcher;
use surepose_config::Config;
use surepose_io::recording::{Recording, ScanRecord, StampedPose};
use surepose_io::wall_map::{WallMap, walls_from_map};
use surepose_mapping::{MappingResult, from_log};
use surepose_sim::CancelToken;

use super::laser_replay::LaserReplaySettings;
use super::odometry::{RecordedOdometry, pose_of};
use super::report::{ReplayError, ReplayReport};
pub use lag::ScanLag;
use supervised_replay::SupervisedReplay;

/// Standard deviations of x \[m], y \[m] and θ \[rad] of the error common to all beams of a scan.
///
/// The errors of consecutive scans are correlated on a robot that takes ten per second. In these logs consecutive
/// scans are a meter apart.
const SCAN_STD: [f64; 3] = [0.02, 0.02, 0.3_f64.to_radians()];

/// Settings of the replay, the same for all logs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarmenSettings {
    /// Odometry and laser.
    pub replay: LaserReplaySettings,
    /// Delay of a scan's record; `None` to estimate it from the log.
    pub lag: Option<ScanLag>,
    /// Start pose; `None` for the reference pose of the first scan.
    pub start: Option<Pose<Map, Body, f64>>,
    /// Settings of the map extraction, if no map is given.
    pub mapping: from_log::LogMappingSettings,
}

impl CarmenSettings {
    /// Returns the format's preset, which the user's values override.
    pub fn preset() -> Config {
        LaserReplaySettings::preset("carmen")
    }

    /// Reads the settings of a configuration.
    pub fn from_config(config: &Config) -> Self {
        let mapping = from_log::LogMappingSettings::default();
        let common = LaserReplaySettings::from_config(config);
        let beam_model = BeamModelMatcher { scan_std: SCAN_STD, ..common.beam_model };
        Self { replay: LaserReplaySettings { beam_model, ..common }, lag: None, start: None, mapping }
    }
}

impl Default for CarmenSettings {
    fn default() -> Self {
        Self::from_config(&Self::preset())
    }
}

/// Extracts the walls of a log at its reference poses: from all scans, or from every second one, starting
/// with the first.
pub fn map_from_log(
    log: &Recording<StampedPose>,
    every: usize,
    settings: &from_log::LogMappingSettings,
) -> MappingResult {
    from_log::extract_walls(views(log).step_by(every.max(1)), settings)
}

/// Iterates over the scans of a log and their reference poses.
pub fn views(log: &Recording<StampedPose>) -> impl Iterator<Item = (&ScanRecord, Pose<Map, Body, f64>)> {
    log.scans.iter().zip(log.reference.iter().map(pose_of))
}

/// Replays a log on `map` or on a map of its own, supervised and with relocalization.
///
/// It starts at `settings.start`, else at the reference pose of the first scan, else with global localization on `map`.
/// `cancel` counts the scans.
///
/// # Errors
/// [`ReplayError::NoOdometry`]; [`ReplayError::NoStart`] if there are fewer than two scans; [`ReplayError::NoMap`] for a log
/// without reference poses if `map` is `None`.
pub fn replay_log(
    log: &Recording<StampedPose>,
    map: Option<&WallMap>,
    settings: &CarmenSettings,
    cancel: &CancelToken,
) -> Result<ReplayReport, ReplayError> {
    let begun = Instant::now();
    if log.odometry.is_empty() {
        return Err(ReplayError::NoOdometry);
    }
    if log.scans.len() < 2 {
        return Err(ReplayError::NoStart);
    }
    // The map's own scans would repeat the reference.
    let (walls, every) = match map {
        Some(map) => (walls_from_map(map), 1),
        None if log.reference.is_empty() => return Err(ReplayError::NoMap),
        None => (walls_from_map(&map_from_log(log, 2, &settings.mapping).map), 2),
    };
    let odometry = RecordedOdometry::new(&log.odometry);
    let lag = settings.lag.unwrap_or_else(|| ScanLag::estimate(log, &odometry));
    let mut replay = SupervisedReplay::new(log, odometry, lag, walls, settings.replay, settings.start);
    for (number, scan) in cancel.take_until_cancelled(log.scans.iter().enumerate().skip(1)) {
        replay.roll(scan.odometry_before);
        let truth = log.reference.get(number).map(pose_of);
        replay.drive_to(truth);
        if number % every == every - 1 {
            replay.see(scan, truth);
        }
    }
    Ok(replay.finish(log, begun))
}
