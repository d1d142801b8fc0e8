//! Scan matching against the walls of the map, for rooms with few walls long enough for line extraction.
//!
//! [`LineExtractor`](super::LineExtractor) requires six beams and a quarter of a meter for a wall. Offices and halls
//! full of furniture have few such walls and many short faces. With a map, and a belief within half a meter of the
//! truth, each beam can be associated with its wall, and short faces contribute as well.

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

/// Number of iterations; each associates the beams with walls from the pose of the previous one.
const MAX_ITERATIONS: usize = 6;

/// Number of final iterations with the estimated covariance; earlier ones use twice the standard deviation.
const FINAL_ITERATIONS: usize = 2;

/// Parameters of scan matching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanMatcher<S> {
    /// Gate of the joint innovation of all beams on a wall.
    pub gate: Gate<S>,
    /// Maximum distance of the end of a beam from its wall, whatever the belief \[m].
    pub max_correspondence_distance: S,
    /// Minimum number of beams on a wall.
    pub min_beams_per_wall: u16,
    /// Minimum fraction of the beams on walls, 0 to 1.
    pub min_overlap: S,
    /// Standard deviation of the position of a wall \[m], in addition to its own covariance.
    pub wall_offset_std: S,
    /// Standard deviation of the direction of a wall \[rad], in addition to its own covariance.
    pub wall_direction_std: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] of the error common to all beams of a scan.
    pub scan_std: [S; 3],
}

/// Result of a match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanMatchResult<S> {
    /// Pose measurement from the visible walls.
    pub fix: PoseMeasurement<S>,
    /// Number of walls in the match.
    pub walls: u16,
    /// Number of beams on these walls.
    pub beams: u16,
    /// Number of beams with a return.
    pub returns: u16,
    /// Number of walls with beams that lay outside the gate.
    pub rejected_walls: u16,
}

/// Outcome of a match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanMatch<S> {
    /// The scan matches the walls.
    Matched(ScanMatchResult<S>),
    /// The fraction of matched beams is too small to exclude a chance match.
    LowOverlap(ScanMatchResult<S>),
    /// No wall lies near the end of any beam.
    NoOverlap,
}

/// Workspace for matching scans of up to `BEAMS` beams; it keeps no state from one scan to the next.
#[derive(Clone, Debug)]
pub struct ScanMatcherWorkspace<S, const BEAMS: usize> {
    beams: [MapBeam<S>; BEAMS],
}

impl<S: Float, const BEAMS: usize> Default for ScanMatcherWorkspace<S, BEAMS> {
    fn default() -> Self {
        Self { beams: [MapBeam::default(); BEAMS] }
    }
}

/// A scan to be matched, and the prior belief.
struct MatchProblem<'a, S> {
    ekf: &'a Ekf<S>,
    belief: &'a Belief<S>,
    laser: &'a RangeFinder<S>,
    walls: &'a [Wall<S>],
    /// Longest range \[m].
    max_range: S,
}

/// Converged pose of a match.
struct Converged<S> {
    /// Misfit of beams and belief: sum of squared normalized residuals.
    cost: S,
    matched: ScanMatchResult<S>,
}

impl<S: Float> ScanMatcher<S> {
    /// Matches `scan` with `walls`, starting at the belief at the time of the scan.
    ///
    /// Each iteration associates every beam with the nearest plausible wall, and fits the offset and direction of each
    /// wall to its beams. It then moves the pose to the best agreement of belief and walls. Where the heading
    /// uncertainty permits wrong associations, several initial headings are tried and the best agreement is kept. The
    /// belief only guides the association; the pose measurement does not include it.
    ///
    /// The work is bounded: six iterations for each of at most 21 headings, times beams times walls within reach.
    ///
    /// # Errors
    /// [`ScanError`] for a scan or laser that is invalid.
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

    /// Iterates from `initial`, [`MAX_ITERATIONS`] times.
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

    /// Associates the beams with walls at `estimate`, and sums the information on the pose.
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

/// Sums over walls: the information on the pose, and the information times the step.
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
