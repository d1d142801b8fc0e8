//! CMU Wean Hall: odometry predicts, the laser corrects on walls made from the hall's occupancy grid.
//!
//! The recordings have no reference, so nothing is judged but how much of what the laser sees the walls explain.

use std::time::Instant;

use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::Motion;
use surepose::lidar::ScanMatcher;
use surepose::param;
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::recording::{Recording, StampedPose};
use surepose_sim::CancelToken;

use super::building_map::BuildingMap;
use super::grid_localizer::GridLocalizer;
use super::laser_replay::{LaserReplay, LaserReplaySettings, ScanOverlap};
use super::odometry::pose_of;
use super::report::ReplayReport;

/// A start that somebody pointed at on a map is not known to centimetres: standard deviations of x \[m], y \[m], θ \[rad].
const START_STD: [f64; 3] = [0.3, 0.3, 0.2];

/// The configuration that fits the format better than the defaults, before the user's own values.
///
/// Odometry is trusted more than in other formats, 3 cm and 3° over a metre: it comes with every scan, ten times a second,
/// and along the hall's corridors there is little else. The grid's cells are 10 cm, and a beam is taken to be as coarse.
pub fn preset() -> Config {
    LaserReplaySettings::with_rim_variance("wean", 0.002)
        .with_preset("wean", &[(&param::LASER_RANGE_STD, 0.1)])
}

/// The settings of a configuration: rooms drawn so coarsely are recognised by small faces, and by fewer of the beams.
pub fn settings(config: &Config) -> LaserReplaySettings {
    let common = LaserReplaySettings::from_config(config);
    let scan_matcher =
        ScanMatcher { min_beams_per_wall: 3, min_overlap: 0.2, wall_offset_std: 0.05, ..common.scan_matcher };
    LaserReplaySettings { scan_matcher, start_std: START_STD, ..common }
}

/// What came of a replay.
#[derive(Clone, Debug)]
pub struct WeanReplay {
    /// The figures.
    pub report: ReplayReport,
    /// Where the robot was at each scan, from when that was known.
    pub trajectory: Vec<Option<Pose<Map, Body, f64>>>,
    /// The way to where it was found, as that place saw it, at each look until then; empty if it was not found.
    pub before: Vec<Pose<Map, Body, f64>>,
    /// Where it may be at the end, the likeliest first, if it was not found.
    pub candidates: Vec<Pose<Map, Body, f64>>,
}

/// How well a pose that was found is known: standard deviations of x \[m], y \[m], θ \[rad]. Walls are drawn up to half a
/// metre thick, and along a corridor only the edges of its doorways tell where it is.
const FOUND_STD: [f64; 3] = [0.2, 0.2, 0.05];

/// Replays a log in `building` from `start` on, or from where the scans put it once one place is left.
///
/// A scan carries the odometry of its own moment, so the estimate goes from scan to scan. A place that was found is held
/// against what is seen from then on, and withdrawn if it does not explain that. `cancel` counts the scans, and may end it early.
pub fn replay(
    log: &Recording<StampedPose>,
    building: &BuildingMap,
    start: Option<Pose<Map, Body, f64>>,
    settings: &LaserReplaySettings,
    cancel: &CancelToken,
) -> WeanReplay {
    let begun = Instant::now();
    let mut report = ReplayReport { duration_s: log.duration(), ..ReplayReport::default() };
    let first = log.scans.first().map_or(0.0, |scan| scan.time);
    let follow = |stamp, at| LaserReplay::new(building.walls().to_vec(), *settings, stamp, at);
    let mut replay = start.map(|start| follow(Stamp::from_seconds(first), start));
    let mut grid_localizer = start.is_none().then(|| GridLocalizer::new(building.grid(), *settings));
    let mut overlap = ScanOverlap::default();
    let mut trajectory = Vec::new();
    let mut found_trajectory = Vec::new();
    let mut before: Option<Pose<Map, Body, f64>> = None;
    for scan in cancel.take_until_cancelled(&log.scans) {
        let stamp = Stamp::from_seconds(scan.time);
        if let Some(here) = scan.odometry.as_ref().map(pose_of) {
            if let Some(before) = before {
                let motion = Motion::between(before, here);
                if let Some(replay) = &mut replay {
                    replay.predict(stamp, motion);
                }
                if let Some(grid_localizer) = &mut grid_localizer {
                    grid_localizer.predict(motion);
                }
                report.distance_m += motion.length.abs();
                report.steps += 1;
            }
            before = Some(here);
        }
        if let Some(grid_localizer) = &mut grid_localizer
            && grid_localizer.update(scan)
        {
            if replay.is_none()
                && let Some(found) = grid_localizer.found()
            {
                report.found(scan.time - first, found);
                found_trajectory = grid_localizer.trajectory();
                let mut found_there = follow(stamp, found);
                found_there.localizer.reset(stamp, Belief::new(found, FOUND_STD));
                replay = Some(found_there);
            } else if replay.is_some() && grid_localizer.is_inconsistent() {
                report.withdraw();
                grid_localizer.reset();
                found_trajectory.clear();
                trajectory.fill(None);
                (replay, overlap) = (None, ScanOverlap::default());
            }
        }
        trajectory.push(replay.as_mut().map(|replay| {
            let seen = replay.correct(stamp, scan);
            overlap.add(&seen);
            report.skip(seen.skip_reason());
            replay.localizer.estimator().belief().pose
        }));
    }
    report.beams_on_walls = overlap.mean();
    let candidates = grid_localizer.as_ref().map_or_else(Vec::new, GridLocalizer::candidates);
    if let Some(grid_localizer) = &grid_localizer {
        report.hypotheses_left = Some(candidates.len());
        report.set_consistency(grid_localizer.shares());
    }
    if let Some(replay) = &replay {
        report.count(replay.localizer.estimator().measurement_stats());
    }
    report.wall_s = begun.elapsed().as_secs_f64();
    WeanReplay {
        report,
        trajectory,
        before: found_trajectory,
        candidates: if replay.is_some() { Vec::new() } else { candidates },
    }
}
