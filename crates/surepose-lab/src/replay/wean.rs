//! CMU Wean Hall: odometry predicts, the laser corrects on walls made from the hall's occupancy grid.
//!
//! The recordings have no reference, so nothing is judged but how much of what the laser sees the walls explain.

use std::path::Path;
use std::time::Instant;

use surepose::{Aligner, Body, Map, Pose, Stamp, param};
use surepose_data::Config;
use surepose_data::recording::{Recording, StampedPose};
use surepose_data::wall_map::WallMap;
use surepose_data::wean as data;

use super::follower::{Follower, FollowerSettings, Shares, walls_of};
use super::odometry::{motion_between, pose_of};
use super::report::{ReplayError, ReplayReport};

/// A start that somebody pointed at on a map is not known to centimetres: standard deviations of x \[m], y \[m], θ \[rad].
const START_STD: [f64; 3] = [0.3, 0.3, 0.2];

/// The configuration that fits the format better than the defaults, before the user's own values.
///
/// Odometry is trusted more than in other formats, 3 cm and 3° over a metre: it comes with every scan, ten times a second,
/// and along the hall's corridors there is little else. The grid's cells are 10 cm, and a beam is taken to be as coarse.
pub fn preset() -> Config {
    FollowerSettings::scattering("wean", 0.002).with_preset("wean", &[(&param::LASER_RANGE_STD, 0.1)])
}

/// The settings of a configuration: rooms drawn so coarsely are recognised by small faces, and by fewer of the beams.
pub fn settings(config: &Config) -> FollowerSettings {
    let common = FollowerSettings::of(config);
    let aligner = Aligner { fewest_beams: 3, least_share: 0.2, wall_offset_std: 0.05, ..common.aligner };
    FollowerSettings { aligner, start_std: START_STD, ..common }
}

/// Reads a log and replays it on `map` from `start` on.
///
/// # Errors
/// A log that cannot be read, or [`ReplayError::StartUnknown`] without a start.
pub fn replay(
    path: &Path,
    map: &WallMap,
    start: Option<Pose<Map, Body, f64>>,
    settings: &FollowerSettings,
) -> Result<ReplayReport, ReplayError> {
    let begun = Instant::now();
    let log = data::read(path)?;
    let start = start.ok_or(ReplayError::StartUnknown)?;
    let mut report = replay_log(&log, map, start, settings).0;
    report.wall_s = begun.elapsed().as_secs_f64();
    Ok(report)
}

/// Replays a log, and says where the robot was at each scan.
///
/// A scan carries the odometry of its own moment, so the estimate goes from scan to scan.
pub fn replay_log(
    log: &Recording<StampedPose>,
    map: &WallMap,
    start: Pose<Map, Body, f64>,
    settings: &FollowerSettings,
) -> (ReplayReport, Vec<Pose<Map, Body, f64>>) {
    let begun = Instant::now();
    let mut report = ReplayReport { duration_s: log.duration(), ..ReplayReport::default() };
    let first = log.scans.first().map_or(0.0, |scan| scan.time);
    let mut follower = Follower::new(walls_of(map), *settings, Stamp::from_seconds(first), start);
    let mut shares = Shares::default();
    let mut way = Vec::new();
    let mut before: Option<Pose<Map, Body, f64>> = None;
    for scan in &log.scans {
        let stamp = Stamp::from_seconds(scan.time);
        if let Some(here) = scan.odometry.as_ref().map(pose_of) {
            if let Some(before) = before {
                let motion = motion_between(before, here);
                follower.roll(stamp, motion);
                report.distance_m += motion.length.abs();
                report.steps += 1;
            }
            before = Some(here);
        }
        let seen = follower.see(stamp, scan);
        shares.add(&seen);
        report.skip(seen.skipped_as());
        way.push(follower.localiser.estimator.belief().pose);
    }
    report.beams_on_walls = shares.mean();
    report.count(follower.localiser.estimator.tally());
    report.wall_s = begun.elapsed().as_secs_f64();
    (report, way)
}
