//! Replay of wheel ticks and laser without a map: walls are mapped from the scans on the way.
//!
//! The recordings have neither a map nor a reference. The only figure is the fraction of the returns that
//! previously mapped walls explain. The estimate starts at the origin. Its covariance is relative to its own
//! map and excludes the map's drift.

use std::time::Instant;

use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, Motion, WheelPair};
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::mines_rover as data;
use surepose_io::recording::{Recording, ScanRecord, StampedTicks};
use surepose_io::wall_map::walls_from_map;
use surepose_mapping::{MappingResult, from_log};
use surepose_sim::CancelToken;

use super::laser_replay::{LaserReplay, LaserReplaySettings, ScanOverlap};
use super::report::ReplayReport;

/// Minimum travel \[m] or turn \[rad] between two scans that are added to the map.
const NEW_VIEW: (f64, f64) = (0.3, 0.4);

/// Returns the format's preset, which the user's values override.
pub fn preset() -> Config {
    LaserReplaySettings::preset("ticks")
}

/// Result of a replay that makes its own map.
#[derive(Clone, Debug)]
pub struct RoverReplay {
    /// Figures.
    pub report: ReplayReport,
    /// Final walls.
    pub mapped: MappingResult,
    /// Pose at each scan.
    pub way: Vec<Pose<Map, Body, f64>>,
    /// Dead-reckoned pose at each scan.
    pub dead_reckoning: Vec<Pose<Map, Body, f64>>,
}

/// Replays a recording of the rover; `cancel` counts its scans.
pub fn replay_log(
    log: &Recording<StampedTicks>,
    settings: &LaserReplaySettings,
    cancel: &CancelToken,
) -> RoverReplay {
    let begun = Instant::now();
    let mapping = from_log::LogMappingSettings::default();
    let start = Pose::identity();
    let first = log.scans.first().map_or(0.0, |scan| scan.time);
    let mut replay = LaserReplay::new(Vec::new(), *settings, Stamp::from_seconds(first), start);
    let mut report = ReplayReport { duration_s: log.duration(), ..ReplayReport::default() };
    let mut overlap = ScanOverlap::default();
    let mut views: Vec<(&ScanRecord, Pose<Map, Body, f64>)> = Vec::new();
    let (mut way, mut dead_reckoning) = (Vec::new(), Vec::new());
    let mut dead = start;
    let mut before: Option<StampedTicks> = None;
    for (scan, ticks) in cancel.take_until_cancelled(log.scans.iter().zip(&log.odometry)) {
        let stamp = Stamp::from_seconds(scan.time);
        if let Some(before) = before {
            let motion = motion(&before, ticks);
            replay.predict(stamp, motion);
            dead = dead.integrate(motion, Integration::Arc);
            report.distance_m += motion.length.abs();
            report.steps += 1;
        }
        before = Some(*ticks);
        if !views.is_empty() {
            let seen = replay.correct(stamp, scan);
            overlap.add(&seen);
            report.skip(seen.skip_reason());
        }
        let belief = replay.localizer.estimator().belief();
        report.track.add(scan.time, &belief, None, true);
        let pose = belief.pose;
        way.push(pose);
        dead_reckoning.push(dead);
        let is_new = views.last().is_none_or(|(_, at)| {
            let turned = (pose.heading - at.heading).radians().abs();
            pose.origin().distance(at.origin()) > NEW_VIEW.0 || turned > NEW_VIEW.1
        });
        if is_new {
            views.push((scan, pose));
            replay.set_map(walls_from_map(&from_log::extract_walls(views.iter().copied(), &mapping).map));
        }
    }
    report.beams_on_walls = overlap.mean();
    report.count(replay.localizer.estimator().measurement_stats());
    report.wall_s = begun.elapsed().as_secs_f64();
    RoverReplay { report, mapped: from_log::extract_walls(views, &mapping), way, dead_reckoning }
}

/// Returns the motion between two records of the wheel counters.
fn motion(before: &StampedTicks, after: &StampedTicks) -> Motion<f64> {
    let rover = data::ROVER;
    let drive = DiffDrive::new(rover.wheel_radius, rover.wheel_separation);
    let turned = |from: i64, to: i64| (to - from) as f64 / rover.ticks_per_turn * std::f64::consts::TAU;
    let angles = WheelPair::new(turned(before.right, after.right), turned(before.left, after.left));
    // Angles instead of rates: the period is one.
    drive.motion_from_travel(drive.wheel_travel_from_angle(angles))
}
