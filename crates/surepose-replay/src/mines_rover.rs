//! Wheel ticks and laser without a map: the walls are made from the scans on the way, and later scans laid on them.
//!
//! The recordings have neither a map nor a reference, so nothing is judged but how much of what the laser sees the walls
//! that were made before explain. The estimate starts at the origin; its covariance is against its own map, and does not
//! hold what the map itself has drifted.

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

/// A scan becomes part of the map where the robot has come this far \[m] or turned this far \[rad] since the last one.
const NEW_VIEW: (f64, f64) = (0.3, 0.4);

/// The configuration that fits the format better than the defaults, before the user's own values.
pub fn preset() -> Config {
    LaserReplaySettings::preset("ticks")
}

/// What came of a replay that makes its own map.
#[derive(Clone, Debug)]
pub struct RoverReplay {
    /// The figures.
    pub report: ReplayReport,
    /// The walls in the end.
    pub mapped: MappingResult,
    /// Where the robot was at each scan.
    pub way: Vec<Pose<Map, Body, f64>>,
    /// Where its wheels alone would have it.
    pub dead_reckoning: Vec<Pose<Map, Body, f64>>,
}

/// Replays a recording of the rover; `cancel` counts its scans, and may end it early.
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
        let pose = replay.localizer.estimator().belief().pose;
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

/// The motion that the wheels' counters tell.
fn motion(before: &StampedTicks, after: &StampedTicks) -> Motion<f64> {
    let rover = data::ROVER;
    let drive = DiffDrive::new(rover.wheel_radius, rover.wheel_separation);
    let turned = |from: i64, to: i64| (to - from) as f64 / rover.ticks_per_turn * std::f64::consts::TAU;
    let angles = WheelPair::new(turned(before.right, after.right), turned(before.left, after.left));
    // Angles instead of rates: the period is one.
    drive.motion_from_travel(drive.wheel_travel_from_angle(angles))
}
