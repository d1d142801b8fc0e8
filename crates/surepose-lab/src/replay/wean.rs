//! CMU Wean Hall: odometry predicts, the laser corrects on walls made from the hall's occupancy grid.
//!
//! The recordings have no reference, so nothing is judged but how much of what the laser sees the walls explain.

use std::time::Instant;

use surepose::{Aligner, Belief, Body, Map, Pose, Stamp, param};
use surepose_data::Config;
use surepose_data::recording::{Recording, StampedPose};

use super::follower::{Follower, FollowerSettings, Shares};
use super::hall::Hall;
use super::odometry::{motion_between, pose_of};
use super::report::ReplayReport;
use super::seeker::Seeker;
use crate::Watch;

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

/// What came of a replay.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The figures.
    pub report: ReplayReport,
    /// Where the robot was at each scan, from when that was known.
    pub way: Vec<Option<Pose<Map, Body, f64>>>,
    /// The way to where it was found, as that place saw it, at each look until then; empty if it was not found.
    pub before: Vec<Pose<Map, Body, f64>>,
    /// Where it may be at the end, the likeliest first, if it was not found.
    pub places: Vec<Pose<Map, Body, f64>>,
}

/// How well a pose that was found is known: standard deviations of x \[m], y \[m], θ \[rad]. Walls are drawn up to half a
/// metre thick, and along a corridor only the edges of its doorways tell where it is.
const FOUND_STD: [f64; 3] = [0.2, 0.2, 0.05];

/// Replays a log in `hall` from `start` on, or from where the scans put it once one place is left.
///
/// A scan carries the odometry of its own moment, so the estimate goes from scan to scan. A place that was found is held
/// against what is seen from then on, and withdrawn if it does not explain that. `watch` counts the scans, and may end it early.
pub fn replay(
    log: &Recording<StampedPose>,
    hall: &Hall,
    start: Option<Pose<Map, Body, f64>>,
    settings: &FollowerSettings,
    watch: &Watch,
) -> Followed {
    let begun = Instant::now();
    let mut report = ReplayReport { duration_s: log.duration(), ..ReplayReport::default() };
    let first = log.scans.first().map_or(0.0, |scan| scan.time);
    let follow = |stamp, at| Follower::new(hall.walls().to_vec(), *settings, stamp, at);
    let mut follower = start.map(|start| follow(Stamp::from_seconds(first), start));
    let mut seeker = start.is_none().then(|| Seeker::new(hall.grid(), *settings));
    let mut shares = Shares::default();
    let mut way = Vec::new();
    let mut led_there = Vec::new();
    let mut before: Option<Pose<Map, Body, f64>> = None;
    for scan in watch.over(&log.scans) {
        let stamp = Stamp::from_seconds(scan.time);
        if let Some(here) = scan.odometry.as_ref().map(pose_of) {
            if let Some(before) = before {
                let motion = motion_between(before, here);
                if let Some(follower) = &mut follower {
                    follower.roll(stamp, motion);
                }
                if let Some(seeker) = &mut seeker {
                    seeker.roll(motion);
                }
                report.distance_m += motion.length.abs();
                report.steps += 1;
            }
            before = Some(here);
        }
        if let Some(seeker) = &mut seeker
            && seeker.look(scan)
        {
            if follower.is_none()
                && let Some(found) = seeker.found()
            {
                report.found(scan.time - first, found);
                led_there = seeker.way();
                let mut found_there = follow(stamp, found);
                found_there.localiser.estimator.restart(stamp, Belief::new(found, FOUND_STD));
                follower = Some(found_there);
            } else if follower.is_some() && seeker.is_refuted() {
                report.withdraw();
                seeker.start_over();
                led_there.clear();
                way.fill(None);
                (follower, shares) = (None, Shares::default());
            }
        }
        way.push(follower.as_mut().map(|follower| {
            let seen = follower.see(stamp, scan);
            shares.add(&seen);
            report.skip(seen.skipped_as());
            follower.localiser.estimator.belief().pose
        }));
    }
    report.beams_on_walls = shares.mean();
    let places = seeker.as_ref().map_or_else(Vec::new, Seeker::places);
    if let Some(seeker) = &seeker {
        report.hypotheses_left = Some(places.len());
        report.account(seeker.account());
    }
    if let Some(follower) = &follower {
        report.count(follower.localiser.estimator.tally());
    }
    report.wall_s = begun.elapsed().as_secs_f64();
    Followed { report, way, before: led_there, places: if follower.is_some() { Vec::new() } else { places } }
}
