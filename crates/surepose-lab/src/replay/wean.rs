//! CMU Wean Hall: odometry predicts, the laser corrects on walls made from the hall's occupancy grid.
//!
//! The recordings have no reference, so nothing is judged but how much of what the laser sees the walls explain.

use std::time::Instant;

use surepose::{Aligner, Belief, Body, Certainty, Map, Motion, Pose, Stamp, Wall, param};
use surepose_data::Config;
use surepose_data::grid::Grid;
use surepose_data::recording::{Recording, StampedPose};
use surepose_data::wall_map::WallMap;

use super::follower::{Follower, FollowerSettings, Shares, walls_of};
use super::odometry::{motion_between, pose_of};
use super::report::ReplayReport;
use super::seeker::Seeker;
use crate::mapping::from_grid::{self, is_free, is_solid};
use crate::survey::Survey;

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

/// The hall: its walls, and where in it a robot can be.
#[derive(Clone, Debug)]
pub struct Hall {
    walls: Vec<Wall<f64>>,
    survey: Survey,
    /// The middles of the solid cells of its grid, if it has one.
    solid: Vec<(f64, f64)>,
}

impl Hall {
    /// The hall of a wall map, in which a robot can be anywhere.
    pub fn of_map(map: &WallMap) -> Self {
        let walls = walls_of(map);
        let survey = Survey::of(&walls, |_| true);
        Self { walls, survey, solid: Vec::new() }
    }

    /// The hall of an occupancy grid: its walls, and its free cells.
    pub fn of_grid(grid: &Grid) -> Self {
        let walls = walls_of(&from_grid::walls_of(grid).map);
        let survey = Survey::of(&walls, |at| {
            let cell = grid.cell_at(at.x, at.y);
            is_free(cell.and_then(|(column, row)| grid.occupancy(column, row)))
        });
        let cells = (0..grid.height).flat_map(|row| (0..grid.width).map(move |column| (column, row)));
        let solid = cells.filter(|(column, row)| is_solid(grid.occupancy(*column, *row)));
        let solid = solid.map(|(column, row)| grid.center(column, row)).collect();
        Self { walls, survey, solid }
    }

    /// The middles of the solid cells of its grid; none for a wall map.
    pub fn solid(&self) -> &[(f64, f64)] {
        &self.solid
    }

    /// The walls.
    pub fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }
}

/// What came of a replay.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The figures.
    pub report: ReplayReport,
    /// Where the robot was at each scan, from when that was known.
    pub way: Vec<Option<Pose<Map, Body, f64>>>,
    /// Where it may be at the end, the likeliest first, if it was not found.
    pub places: Vec<Pose<Map, Body, f64>>,
}

/// What must hold of the pose that is found.
///
/// Doors, people and glass are on no map, walls are drawn to half a cell: the right place leaves beams unexplained, and
/// some of them beyond the walls. So more must speak for a place than where the map is exact.
const CERTAINTY: Certainty<f64> = Certainty {
    explained: 0.6,
    beyond: 0.2,
    clearance: 0.15,
    margin: 60.0,
    share: 0.5,
    scans: 5,
    turned: core::f64::consts::FRAC_PI_2,
};

/// How often a robot that is lost looks \[s]: it moves by centimetres from scan to scan.
const LOOK_EVERY: f64 = 1.0;

/// How well a pose that was found is known at best: x \[m], y \[m], θ \[rad].
const FOUND_STD: [f64; 3] = [0.1, 0.1, 0.05];

/// Replays a log in `hall` from `start` on, or from where the scans put it once one place is left.
///
/// A scan carries the odometry of its own moment, so the estimate goes from scan to scan.
pub fn replay(
    log: &Recording<StampedPose>,
    hall: &Hall,
    start: Option<Pose<Map, Body, f64>>,
    settings: &FollowerSettings,
) -> Followed {
    let begun = Instant::now();
    let mut report = ReplayReport { duration_s: log.duration(), ..ReplayReport::default() };
    let first = log.scans.first().map_or(0.0, |scan| scan.time);
    let stamp = Stamp::from_seconds(first);
    let follow = |at| Box::new(Follower::new(hall.walls.clone(), *settings, stamp, at));
    let mut robot = match start {
        Some(start) => Robot::Followed(follow(start)),
        None => Robot::Sought(Seeker::new(&hall.walls, &hall.survey, *settings, CERTAINTY, stamp)),
    };
    let mut look_at = first;
    let mut shares = Shares::default();
    let mut way = Vec::new();
    let mut before: Option<Pose<Map, Body, f64>> = None;
    for scan in &log.scans {
        let stamp = Stamp::from_seconds(scan.time);
        if let Some(here) = scan.odometry.as_ref().map(pose_of) {
            if let Some(before) = before {
                let motion = motion_between(before, here);
                robot.roll(stamp, motion);
                report.distance_m += motion.length.abs();
                report.steps += 1;
            }
            before = Some(here);
        }
        if let Robot::Sought(seeker) = &mut robot
            && scan.time >= look_at
        {
            look_at = scan.time + LOOK_EVERY;
            let found = seeker.see(stamp, scan);
            let known = seeker.hypotheses();
            report.hypotheses_left = Some(known.len());
            report.explained = known.first().map(|likeliest| likeliest.agreement.explained_share());
            if let Some(found) = found {
                report.found(scan.time - first, found.pose);
                let mut follower = follow(found.pose);
                let std = [0, 1, 2].map(|i| found.covariance.std(i).max(FOUND_STD[i]));
                follower.localiser.estimator.restart(stamp, Belief::new(found.pose, std));
                robot = Robot::Followed(follower);
            }
        }
        way.push(match &mut robot {
            Robot::Sought(_) => None,
            Robot::Followed(follower) => {
                let seen = follower.see(stamp, scan);
                shares.add(&seen);
                report.skip(seen.skipped_as());
                Some(follower.localiser.estimator.belief().pose)
            }
        });
    }
    report.beams_on_walls = shares.mean();
    let places = match &robot {
        Robot::Sought(seeker) => seeker.hypotheses().iter().map(|known| known.belief.pose).collect(),
        Robot::Followed(follower) => {
            report.count(follower.localiser.estimator.tally());
            Vec::new()
        }
    };
    report.wall_s = begun.elapsed().as_secs_f64();
    Followed { report, way, places }
}

/// What is known of the robot.
enum Robot<'a> {
    /// Nothing yet.
    Sought(Seeker<'a>),
    /// Where it is.
    Followed(Box<Follower>),
}

impl Robot<'_> {
    fn roll(&mut self, stamp: Stamp, motion: Motion<f64>) {
        match self {
            Self::Sought(seeker) => seeker.roll(stamp, motion),
            Self::Followed(follower) => follower.roll(stamp, motion),
        }
    }
}
