//! Replay of CMU Wean Hall: odometry predicts, the laser corrects on walls from the occupancy grid.
//!
//! The recordings have no reference. The only figure is the fraction of the beams that the walls explain.

use std::time::Instant;

use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::Motion;
use surepose::param;
use surepose::time::Stamp;
use surepose_config::{Config, beam_model};
use surepose_io::recording::{Recording, StampedPose};
use surepose_sim::CancelToken;

use super::building_map::BuildingMap;
use super::grid_localizer::GridLocalizer;
use super::laser_replay::{LaserReplay, LaserReplaySettings, ScanOverlap};
use super::odometry::pose_of;
use super::report::ReplayReport;

/// Standard deviations of a start pose picked on a map: x \[m], y \[m], θ \[rad].
const START_STD: [f64; 3] = [0.3, 0.3, 0.2];

/// Returns the format's preset, which the user's values override.
///
/// Odometry has a smaller standard deviation than in other formats, 3 cm and 3° over one meter: it comes with
/// every scan, ten times per second, and corridors offer little else. The range noise is that of the grid's
/// 10 cm cells.
pub fn preset() -> Config {
    LaserReplaySettings::with_rim_variance("wean", 0.002)
        .with_preset("wean", &[(&param::LASER_RANGE_STD, 0.1)])
}

/// Returns the settings of a configuration; the scans come as fast as those of a robot.
pub fn settings(config: &Config) -> LaserReplaySettings {
    let common = LaserReplaySettings::from_config(config);
    LaserReplaySettings { beam_model: beam_model(), start_std: START_STD, ..common }
}

/// Result of a replay.
#[derive(Clone, Debug)]
pub struct WeanReplay {
    /// Figures.
    pub report: ReplayReport,
    /// Pose at each scan; `None` before localization.
    pub trajectory: Vec<Option<Pose<Map, Body, f64>>>,
    /// Path of the accepted hypothesis up to localization, one pose per update; empty if the robot was not
    /// localized.
    pub before: Vec<Pose<Map, Body, f64>>,
    /// Remaining hypotheses, the most likely first, if the robot was not localized.
    pub candidates: Vec<Pose<Map, Body, f64>>,
}

/// Standard deviations of a localized pose: x \[m], y \[m], θ \[rad]. Drawn walls are up to 0.5 m thick, and
/// along a corridor only the edges of doorways determine the position.
const FOUND_STD: [f64; 3] = [0.2, 0.2, 0.05];

/// Replays a log in `building`, from `start` or from global localization if it is `None`.
///
/// A scan carries the odometry of its time, so the estimate advances from scan to scan. A localized pose is
/// checked against later scans and withdrawn if it does not explain them. `cancel` counts the scans.
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
                report.track.points.clear();
                (replay, overlap) = (None, ScanOverlap::default());
            }
        }
        trajectory.push(replay.as_mut().map(|replay| {
            let seen = replay.correct(stamp, scan);
            overlap.add(&seen);
            report.skip(seen.skip_reason());
            let belief = replay.localizer.estimator().belief();
            report.track.add(scan.time, &belief, None, true);
            belief.pose
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
