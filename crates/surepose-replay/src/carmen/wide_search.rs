//! Searches the pose of a robot around an estimate that a scan contradicts: odometry missed a turn, a stretch or a sign.

use core::f64::consts::PI;

use surepose::estimation::{Belief, Ekf};
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::lidar::{BeamModelMatcher, BeamSubset, RangeFinder, Scan};
use surepose::linalg::Covariance;
use surepose::map::Wall;

/// Maximum number of beams of a scan that are compared with the map.
const BEAMS: usize = 64;

/// Distances between the poses that are tried \[m], \[rad].
const SPACING: f64 = 0.4;
const TURN: f64 = 0.14;
/// Standard deviations of a pose that is tried.
const TRIED_STD: [f64; 3] = [0.2, 0.2, 0.07];
/// Number of the best poses that are refined, and their standard deviations.
const REFINED: usize = 12;
const REFINED_STD: [f64; 3] = [0.2, 0.2, 0.06];

/// Standard deviations of a refined pose, by which its scan is judged: those of a map extracted from a log.
const FOUND_STD: [f64; 3] = [0.03, 0.03, 0.015];

/// Weight of −2 log of the beams' likelihood against the displacement: a scan counts as a few independent measurements.
const LIKELIHOOD_WEIGHT: f64 = 0.03;
/// Maximum fraction of beams behind walls, and minimum cost difference to any other pose.
const MAX_BEHIND_WALL_RATIO: f64 = 0.15;
const MIN_MARGIN: f64 = 1.0;
/// Poses nearer to each other than this are one \[m], \[rad].
const SAME: (f64, f64) = (0.3, 0.2);

/// Search around an estimate.
pub(super) struct WideSearch<'a> {
    pub(super) matcher: BeamModelMatcher<f64>,
    pub(super) ekf: &'a Ekf<f64>,
    pub(super) laser: &'a RangeFinder<f64>,
    pub(super) walls: &'a [Wall<f64>],
    /// Minimum fraction of explained beams.
    pub(super) min_hit_ratio: f64,
    /// Standard deviation of the heading's displacement \[rad].
    pub(super) heading_std: f64,
    /// Largest displacement \[m]; the heading may be any.
    pub(super) radius: f64,
}

impl WideSearch<'_> {
    /// Returns the pose that explains `scan` far better than any other; `None` if there is none.
    pub(super) fn find(&self, scan: &Scan<'_, f64>, at: Pose<Map, Body, f64>) -> Option<Belief<f64>> {
        let beams = BeamSubset::<f64, BEAMS>::from_scan(self.laser, scan).ok()?;
        let tried = Covariance::from_std(TRIED_STD);
        let prior = |pose: Pose<Map, Body, f64>| {
            let moved = pose.origin().distance(at.origin()) / self.radius.max(SPACING);
            let turned = (pose.heading - at.heading).radians() / self.heading_std;
            moved * moved + turned * turned
        };
        let refined_covariance = Covariance::from_std(FOUND_STD);
        let steps = libm::ceil(self.radius / SPACING) as i32;
        let turns = (PI / TURN) as i32;
        let mut poses = Vec::new();
        for (column, row) in
            (-steps..=steps).flat_map(|column| (-steps..=steps).map(move |row| (column, row)))
        {
            let (x, y) = (f64::from(column) * SPACING, f64::from(row) * SPACING);
            if libm::hypot(x, y) > self.radius + SPACING {
                continue;
            }
            for turn in -turns..=turns {
                let heading = at.heading.rotated_by(f64::from(turn) * TURN);
                let pose = Pose::new(at.x + x, at.y + y, Angle::from_radians(heading.radians()));
                let stats = beams.evaluate(pose, &tried, self.walls);
                poses.push((stats.neg2_log_likelihood * LIKELIHOOD_WEIGHT + prior(pose), pose));
            }
        }
        poses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Vec<Pose<Map, Body, f64>> = Vec::new();
        for (_, pose) in poses {
            if best.len() < REFINED && !best.iter().any(|other| is_same(*other, pose)) {
                best.push(pose);
            }
        }
        let mut found: Vec<(f64, Belief<f64>)> = Vec::new();
        for pose in best {
            let belief = Belief::new(pose, REFINED_STD);
            let Ok(matched) = self.matcher.match_scan(self.ekf, self.laser, scan, &belief, self.walls) else {
                continue;
            };
            let Some(fix) = matched.fix else { continue };
            let refined = self.ekf.correct(belief, &fix.innovation(&belief), f64::MAX).belief;
            let stats = beams.evaluate(refined.pose, &refined_covariance, self.walls);
            if stats.hit_ratio() >= self.min_hit_ratio && stats.behind_wall_ratio() <= MAX_BEHIND_WALL_RATIO {
                let cost = stats.neg2_log_likelihood * LIKELIHOOD_WEIGHT + prior(refined.pose);
                found.push((cost, refined));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (cost, first) = *found.first()?;
        let here =
            beams.evaluate(at, &refined_covariance, self.walls).neg2_log_likelihood * LIKELIHOOD_WEIGHT;
        if here - cost < MIN_MARGIN && !is_same(first.pose, at) {
            return None;
        }
        let rival = found.iter().find(|(_, other)| !is_same(first.pose, other.pose));
        rival.is_none_or(|(other, _)| other - cost >= MIN_MARGIN).then_some(first)
    }
}

fn is_same(a: Pose<Map, Body, f64>, b: Pose<Map, Body, f64>) -> bool {
    a.origin().distance(b.origin()) < SAME.0 && (a.heading - b.heading).radians().abs() < SAME.1
}
