//! A scan laid on the walls of the map: for rooms in which few walls are long enough to be found without a map.
//!
//! [`LineExtractor`](super::LineExtractor) needs six beams and a quarter of a metre to believe in a wall. Offices, and
//! halls full of furniture, have few of those in sight and many short faces. With a map, and a belief that is right to
//! within half a metre, each beam can be given to the wall that it hit, and short faces count too.

mod initial_beliefs;
mod map_beam;
mod wall_residual;

use map_beam::MapBeam;
use wall_residual::WallResidual;

use crate::estimation::{Belief, Ekf, Gate, PoseMeasurement};
use crate::geometry::{Laser, Map, Pose};
use crate::linalg::InvalidCovariance;
use crate::map::Wall;
use crate::scalar::Float;

use super::pose_normal_equations::PoseNormalEquations;
use super::scan::{RangeFinder, Scan, ScanError};

/// How often beams are given to walls anew, each time from the pose that the iteration before found.
const MAX_ITERATIONS: usize = 6;

/// In all iterations but this many at the end, the pose is taken to be twice as uncertain as it is found to be.
const FINAL_ITERATIONS: usize = 2;

/// What is assumed when a scan is laid on walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanMatcher<S> {
    /// How far off a wall may be, all its beams together.
    pub gate: Gate<S>,
    /// The farthest that a beam may end from its wall, whatever the belief \[m].
    pub max_correspondence_distance: S,
    /// The fewest beams that make a wall count.
    pub min_beams_per_wall: u16,
    /// The least part of the beams that must lie on walls, 0 to 1.
    pub min_overlap: S,
    /// Standard deviation of a wall's place, on top of what its own covariance says \[m].
    pub wall_offset_std: S,
    /// Standard deviation of a wall's direction, on top of what its own covariance says \[rad].
    pub wall_direction_std: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] that all beams of a scan share.
    pub scan_std: [S; 3],
}

/// What a scan says of the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanMatchResult<S> {
    /// The pose, as far as the walls in sight show it.
    pub fix: PoseMeasurement<S>,
    /// How many walls took part.
    pub walls: u16,
    /// How many beams lie on these.
    pub beams: u16,
    /// How many beams came back.
    pub returns: u16,
    /// How many walls had beams but were outside the gate.
    pub rejected_walls: u16,
}

/// What came of laying a scan on walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanMatch<S> {
    /// It lies on them.
    Matched(ScanMatchResult<S>),
    /// Too small a part of it does for it to be more than chance.
    LowOverlap(ScanMatchResult<S>),
    /// No wall is where a beam ended.
    NoOverlap,
}

/// The workspace that laying scans of up to `BEAMS` beams on walls needs; it holds nothing from one scan to the next.
#[derive(Clone, Debug)]
pub struct ScanMatcherWorkspace<S, const BEAMS: usize> {
    beams: [MapBeam<S>; BEAMS],
}

impl<S: Float, const BEAMS: usize> Default for ScanMatcherWorkspace<S, BEAMS> {
    fn default() -> Self {
        Self { beams: [MapBeam::default(); BEAMS] }
    }
}

/// A scan to be laid on walls, and what is believed before.
struct MatchProblem<'a, S> {
    ekf: &'a Ekf<S>,
    belief: &'a Belief<S>,
    laser: &'a RangeFinder<S>,
    walls: &'a [Wall<S>],
    /// The longest beam \[m].
    max_range: S,
}

/// Where a scan came to lie.
struct Converged<S> {
    /// How much beams and belief disagree there: squared normalised distances.
    cost: S,
    matched: ScanMatchResult<S>,
}

impl<S: Float> ScanMatcher<S> {
    /// Lays `scan` on `walls`, starting at what is believed at the time of the scan.
    ///
    /// Each iteration gives every beam to the nearest wall that it may have hit, fits an offset and a direction of each
    /// wall to its beams, and moves the pose to where belief and walls agree best. Where the heading is so uncertain
    /// that beams may start at wrong walls, this is done from several headings and the best agreement counts. The
    /// belief serves to find the walls; the fix is what the walls say without it.
    ///
    /// The work is bounded: six iterations for each of at most 21 headings, times beams times walls within reach.
    ///
    /// # Errors
    /// [`ScanError`], before anything is looked at.
    pub fn match_scan<const BEAMS: usize>(
        &self,
        workspace: &mut ScanMatcherWorkspace<S, BEAMS>,
        ekf: &Ekf<S>,
        belief: &Belief<S>,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        walls: &[Wall<S>],
    ) -> Result<ScanMatch<S>, ScanError> {
        laser.check()?;
        scan.check(BEAMS.min(usize::from(u16::MAX)))?;
        let returns = map_beam::read_returns(laser, scan, &mut workspace.beams);
        let beams = &mut workspace.beams[..returns];
        let max_range = beams.iter().fold(S::from_f64(0.0), |longest, beam| longest.max(beam.range));
        let problem = MatchProblem { ekf, belief, laser, walls, max_range };

        let mut best: Option<Converged<S>> = None;
        for initial in initial_beliefs::initial_beliefs(belief) {
            let is_better =
                |converged: &Converged<S>| best.as_ref().is_none_or(|best| converged.cost < best.cost);
            if let Some(converged) = self.iterate(&problem, initial, beams).filter(is_better) {
                best = Some(converged);
            }
        }
        let min_beams_on_walls = self.min_overlap * S::from_f64(returns as f64);
        Ok(match best.map(|converged| converged.matched) {
            None => ScanMatch::NoOverlap,
            Some(matched) if S::from_f64(f64::from(matched.beams)) < min_beams_on_walls => {
                ScanMatch::LowOverlap(matched)
            }
            Some(matched) => ScanMatch::Matched(matched),
        })
    }

    /// Lets the pose converge from `initial` within [`MAX_ITERATIONS`].
    fn iterate(
        &self,
        problem: &MatchProblem<'_, S>,
        initial: Belief<S>,
        beams: &mut [MapBeam<S>],
    ) -> Option<Converged<S>> {
        let belief = problem.belief;
        let mut estimate = initial;
        let mut result = None;
        for iteration in 0..MAX_ITERATIONS {
            let sums = self.associate(problem, &estimate, beams);
            let fix = sums.solve(&estimate).ok().filter(|_| sums.walls > 0)?;
            let cost = map_beam::total_cost(problem.laser, beams)
                + belief.covariance.mahalanobis_squared(estimate.error(belief.pose));
            let matched = ScanMatchResult {
                fix: fix.inflated(self.scan_std.map(S::squared)),
                walls: sums.walls,
                beams: sums.beams,
                returns: beams.len() as u16,
                rejected_walls: sums.rejected_walls,
            };
            estimate = problem.ekf.correct(*belief, &fix.innovation(belief), S::from_f64(f64::MAX)).belief;
            if iteration + FINAL_ITERATIONS < MAX_ITERATIONS {
                estimate.covariance = estimate.covariance.scaled(S::from_f64(4.0));
            }
            result = Some(Converged { cost, matched });
        }
        result
    }

    /// One iteration: which beams are on which walls, seen from `estimate`, and what these say of the pose.
    fn associate(
        &self,
        problem: &MatchProblem<'_, S>,
        estimate: &Belief<S>,
        beams: &mut [MapBeam<S>],
    ) -> WallSums<S> {
        let map_from_laser: Pose<Map, Laser, S> = estimate.pose * problem.laser.body_from_laser;
        map_beam::project(
            estimate,
            map_from_laser,
            problem.laser.range_std,
            self.max_correspondence_distance,
            beams,
        );
        let max_distance = problem.max_range + self.max_correspondence_distance;
        let indexed_walls = || problem.walls.iter().take(usize::from(u16::MAX)).zip(0_u16..);
        for (wall, number) in indexed_walls() {
            if wall.distance(map_from_laser.origin()) < max_distance {
                for beam in beams.iter_mut() {
                    beam.try_associate(number, wall);
                }
            }
        }
        let mut sums = WallSums::new();
        for (wall, number) in indexed_walls() {
            if wall.distance(map_from_laser.origin()) >= max_distance {
                continue;
            }
            let associated = beams.iter().filter(|beam| beam.is_associated_with(number));
            let Some(residual) =
                WallResidual::from_beams(problem.laser, estimate, wall, associated, self.min_beams_per_wall)
            else {
                continue;
            };
            let residual = residual
                .with_added_variance(self.wall_offset_std.squared(), self.wall_direction_std.squared());
            if residual.nis(&estimate.covariance) < self.gate.threshold(2) {
                sums.add(&residual);
            } else {
                sums.rejected_walls += 1;
            }
        }
        sums
    }
}

/// Sums over walls: the information on the pose, and that times the step they ask for.
struct WallSums<S> {
    equations: PoseNormalEquations<S>,
    walls: u16,
    beams: u16,
    rejected_walls: u16,
}

impl<S: Float> WallSums<S> {
    fn new() -> Self {
        Self { equations: PoseNormalEquations::new(), walls: 0, beams: 0, rejected_walls: 0 }
    }

    fn add(&mut self, residual: &WallResidual<S>) {
        let (information, gradient) = residual.normal_equations();
        self.equations.add_block(&information, &gradient);
        self.walls += 1;
        self.beams += residual.beams;
    }

    fn solve(&self, estimate: &Belief<S>) -> Result<PoseMeasurement<S>, InvalidCovariance> {
        self.equations.solve(estimate.pose)
    }
}
