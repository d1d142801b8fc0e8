//! Wheel ticks and laser without a map: the walls are made from the scans on the way, and later scans laid on them.
//!
//! The recordings have neither a map nor a reference, so nothing is judged but how much of what the laser sees the walls
//! that were made before explain. The estimate starts at the origin; its covariance is against its own map, and does not
//! hold what the map itself has drifted.

use std::time::Instant;

use surepose::{Body, Drive, Integration, Map, Motion, Pose, Stamp, Wheels};
use surepose_data::Config;
use surepose_data::recording::{Recording, Scan, StampedTicks};
use surepose_data::ticks as data;

use super::follower::{Follower, FollowerSettings, Shares, walls_of};
use super::report::ReplayReport;
use crate::Watch;
use crate::mapping::{Mapped, from_log};

/// A scan becomes part of the map where the robot has come this far \[m] or turned this far \[rad] since the last one.
const NEW_VIEW: (f64, f64) = (0.3, 0.4);

/// The configuration that fits the format better than the defaults, before the user's own values.
pub fn preset() -> Config {
    FollowerSettings::preset("ticks")
}

/// What came of a replay that makes its own map.
#[derive(Clone, Debug)]
pub struct Explored {
    /// The figures.
    pub report: ReplayReport,
    /// The walls in the end.
    pub mapped: Mapped,
    /// Where the robot was at each scan.
    pub way: Vec<Pose<Map, Body, f64>>,
    /// Where its wheels alone would have it.
    pub dead_reckoning: Vec<Pose<Map, Body, f64>>,
}

/// Replays a recording of the rover; `watch` counts its scans, and may end it early.
pub fn replay_log(log: &Recording<StampedTicks>, settings: &FollowerSettings, watch: &Watch) -> Explored {
    let begun = Instant::now();
    let mapping = from_log::Settings::default();
    let start = Pose::identity();
    let first = log.scans.first().map_or(0.0, |scan| scan.time);
    let mut follower = Follower::new(Vec::new(), *settings, Stamp::from_seconds(first), start);
    let mut report = ReplayReport { duration_s: log.duration(), ..ReplayReport::default() };
    let mut shares = Shares::default();
    let mut views: Vec<(&Scan, Pose<Map, Body, f64>)> = Vec::new();
    let (mut way, mut dead_reckoning) = (Vec::new(), Vec::new());
    let mut dead = start;
    let mut before: Option<StampedTicks> = None;
    for (scan, ticks) in watch.over(log.scans.iter().zip(&log.odometry)) {
        let stamp = Stamp::from_seconds(scan.time);
        if let Some(before) = before {
            let motion = motion(&before, ticks);
            follower.roll(stamp, motion);
            dead = dead.moved(motion, Integration::Arc);
            report.distance_m += motion.length.abs();
            report.steps += 1;
        }
        before = Some(*ticks);
        if !views.is_empty() {
            let seen = follower.see(stamp, scan);
            shares.add(&seen);
            report.skip(seen.skipped_as());
        }
        let pose = follower.localiser.estimator.belief().pose;
        way.push(pose);
        dead_reckoning.push(dead);
        let is_new = views.last().is_none_or(|(_, at)| {
            let turned = (pose.heading - at.heading).radians().abs();
            pose.origin().distance(at.origin()) > NEW_VIEW.0 || turned > NEW_VIEW.1
        });
        if is_new {
            views.push((scan, pose));
            follower.know(walls_of(&from_log::walls_of(views.iter().copied(), &mapping).map));
        }
    }
    report.beams_on_walls = shares.mean();
    report.count(follower.localiser.estimator.tally());
    report.wall_s = begun.elapsed().as_secs_f64();
    Explored { report, mapped: from_log::walls_of(views, &mapping), way, dead_reckoning }
}

/// The motion that the wheels' counters tell.
fn motion(before: &StampedTicks, after: &StampedTicks) -> Motion<f64> {
    let rover = data::ROVER;
    let drive = Drive::new(rover.wheel_radius, rover.track);
    let turned = |from: i64, to: i64| (to - from) as f64 / rover.ticks_per_turn * std::f64::consts::TAU;
    let angles = Wheels::new(turned(before.right, after.right), turned(before.left, after.left));
    // Angles instead of rates: the period is one.
    drive.motion_from_travel(drive.rims_from_turns(angles))
}
