//! Replay of CARMEN logs: raw odometry predicts, the laser corrects, SLAM poses are the reference.
//!
//! Without a given map, every second scan at its reference pose makes the map. The estimate uses, and is
//! evaluated at, the other scans only.

use std::time::Instant;

use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::Motion;
use surepose::lidar::BeamModelMatcher;
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::recording::{Recording, ScanRecord, StampedPose};
use surepose_io::wall_map::{WallMap, walls_from_map};
use surepose_mapping::{MappingResult, from_log};
use surepose_sim::{CancelToken, ErrorAccumulator};

use super::laser_replay::{LaserReplay, LaserReplaySettings};
use super::odometry::{pose_after, pose_of};
use super::report::{ReplayError, ReplayReport};

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
    /// Delay of a scan's record, in odometry records.
    ///
    /// The loggers stamped a scan with the odometry received last. During turns, the corrected poses lag raw
    /// odometry by 0.64 records in `freiburg-101` and 0.47 in `belgioioso`. The figures are the regression of
    /// the heading difference over the turn rate, which reduces it from 2.2° to 0.7° and from 4.4° to 2.4°.
    pub lag_records: f64,
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
        Self { replay: LaserReplaySettings { beam_model, ..common }, lag_records: 0.55, mapping }
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

/// Replays a log from the reference pose of its first scan, on `map` or on a map of its own.
///
/// `cancel` counts the scans.
///
/// # Errors
/// [`ReplayError::NoStart`] if there are fewer than two scans.
pub fn replay_log(
    log: &Recording<StampedPose>,
    map: Option<&WallMap>,
    settings: &CarmenSettings,
    cancel: &CancelToken,
) -> Result<ReplayReport, ReplayError> {
    let begun = Instant::now();
    // The map's own scans would repeat the reference.
    let (walls, every) = match map {
        Some(map) => (walls_from_map(map), 1),
        None => (walls_from_map(&map_from_log(log, 2, &settings.mapping).map), 2),
    };
    let taken = |before: usize| (before as f64 - settings.lag_records).max(0.0);
    let (Some(first), Some(start)) = (log.scans.first(), log.reference.first().map(pose_of)) else {
        return Err(ReplayError::NoStart);
    };
    // The clock counts odometry records: in some logs the stamps are unusable, but the order is right.
    let mut rolled = taken(first.odometry_before);
    let Some(raw_start) = pose_after(&log.odometry, rolled).filter(|_| log.scans.len() > 1) else {
        return Err(ReplayError::NoStart);
    };
    let mut raw = raw_start;
    let mut replay = LaserReplay::new(walls, settings.replay, Stamp::from_seconds(rolled), start);
    let mut report = ReplayReport::default();
    let (mut score, mut dead_reckoning) = (ErrorAccumulator::default(), ErrorAccumulator::default());
    let mut before = start;
    let judged = log.scans.iter().zip(log.reference.iter().map(pose_of)).enumerate().skip(1);
    for (number, (scan, truth)) in cancel.take_until_cancelled(judged) {
        let until = scan.odometry_before as f64;
        while rolled < until {
            rolled = (libm::floor(rolled) + 1.0).min(until);
            if let Some(next) = pose_after(&log.odometry, rolled) {
                replay.predict(Stamp::from_seconds(rolled), Motion::between(raw, next));
                raw = next;
            }
            report.steps += 1;
        }
        report.distance_m += before.origin().distance(truth.origin());
        before = truth;
        if number % every != every - 1 {
            continue;
        }
        let at = taken(scan.odometry_before);
        let stamp = Stamp::from_seconds(at);
        let seen = replay.correct(stamp, scan);
        report.skip(seen.skip_reason());
        if let Some(belief) = replay.localizer.estimator().belief_at(stamp) {
            score.add(belief.error(truth));
            score.add_nees(belief.nees(truth));
        }
        if let Some(now) = pose_after(&log.odometry, at) {
            let dead = start * (raw_start.inverse() * now);
            let heading = (dead.heading - truth.heading).radians();
            dead_reckoning.add([dead.x - truth.x, dead.y - truth.y, heading]);
        }
    }
    report.duration_s = log.duration();
    report.set_filter_errors(score.summary());
    report.set_odometry_errors(dead_reckoning.summary());
    report.count(replay.localizer.estimator().measurement_stats());
    report.wall_s = begun.elapsed().as_secs_f64();
    Ok(report)
}
