//! Merging of collinear segments into walls that are visible in several runs.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::fixed_vec::FixedVec;
use super::grow::count_inliers;
use super::inverse_range_line::InverseRangeLine;
use super::line_normal_equations::{LineCovariance, LineNormalEquations};
use super::segment::{LineSegments, MAX_SEGMENTS};

/// Threshold of collinear segments: the 99.9 % quantile of χ² with 2 degrees of freedom.
const SAME_LINE_THRESHOLD: f64 = 13.8;

/// Gate of an orphan beam at the wall that reclaims it, in standard deviations.
const GATE: f64 = 3.0;

/// Minimum number of beams in an orphan run.
const MIN_ORPHANS: usize = 3;

/// Normal equations and line of one straight wall, from all its runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WallCandidate<S> {
    pub equations: LineNormalEquations<S>,
    pub line: InverseRangeLine<S>,
    pub covariance: LineCovariance<S>,
}

/// A run of beams on the candidate of index `wall`; both ends are inclusive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BeamRun {
    pub first: usize,
    pub last: usize,
    pub wall: usize,
}

pub(super) type WallCandidates<S> = FixedVec<WallCandidate<S>, MAX_SEGMENTS>;
pub(super) type BeamRuns = FixedVec<BeamRun, MAX_SEGMENTS>;

impl<S: Float> WallCandidate<S> {
    fn from_equations(equations: LineNormalEquations<S>) -> Self {
        let (line, covariance) = equations.solve();
        Self { equations, line, covariance }
    }
}

/// Merges collinear segments.
pub(super) fn merge<S: Float>(segments: &LineSegments<S>) -> (WallCandidates<S>, BeamRuns) {
    let mut walls = WallCandidates::new();
    let mut runs = BeamRuns::new();
    for segment in segments.iter() {
        let new = WallCandidate::from_equations(segment.equations);
        let same = walls.iter().position(|wall| {
            let difference = wall.line.minus(new.line);
            wall.covariance.plus(new.covariance).mahalanobis_squared(difference)
                < S::from_f64(SAME_LINE_THRESHOLD)
        });
        let wall = same.unwrap_or(walls.len());
        if let Some(known) = walls.get_mut(wall) {
            *known = WallCandidate::from_equations(known.equations.merged(&segment.equations));
        } else {
            walls.push(new);
        }
        runs.push(BeamRun { first: segment.first, last: segment.last, wall });
    }
    (walls, runs)
}

/// Assigns the beams between the runs, too few for a segment, to the walls on which they lie.
pub(super) fn reclaim_orphans<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    walls: &WallCandidates<S>,
    runs: &mut BeamRuns,
) {
    let mut low = 0;
    let mut next = 0;
    while next <= runs.len() {
        let high = runs.get(next).map_or(beams.len(), |run| run.first);
        let found = (low + MIN_ORPHANS <= high && !runs.is_full())
            .then(|| best_run(noise, beams, walls, low, high))
            .flatten()
            .filter(|run| survives_refit(noise, &beams[run.first..=run.last], walls.get(run.wall)));
        if let Some(run) = found {
            runs.insert(next, run);
            next += 1;
        }
        low = runs.get(next).map_or(beams.len(), |run| run.last + 1);
        next += 1;
    }
}

/// Longest run among the beams `low..high` that lies on one wall, across single beams off the wall.
fn best_run<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    walls: &WallCandidates<S>,
    low: usize,
    high: usize,
) -> Option<BeamRun> {
    let mut best = (MIN_ORPHANS - 1, None);
    for (wall, candidate) in walls.iter().enumerate() {
        let (mut hits, mut misses, mut first) = (0, 0, low);
        for (i, beam) in beams.iter().enumerate().take(high).skip(low) {
            let (u, slope) = candidate.line.at(beam);
            let variance = noise.variance(u, slope) + candidate.covariance.at(beam);
            if u > S::from_f64(0.0) && (beam.inverse - u).squared() < S::from_f64(GATE * GATE) * variance {
                first = if hits == 0 { i } else { first };
                hits += 1;
                misses = 0;
                if hits > best.0 {
                    best = (hits, Some(BeamRun { first, last: i, wall }));
                }
            } else {
                misses += 1;
                hits = if misses > 1 { 0 } else { hits };
            }
        }
    }
    best.1
}

/// Whether beams on the extension of a wall remain on it after a fit that includes them.
///
/// The line of a short wall is uncertain far beyond its ends. Two or three beams of any object lie on it there, each by
/// itself, and one alone would turn it.
fn survives_refit<S: Float>(noise: &BeamNoise<S>, run: &[Beam<S>], wall: Option<&WallCandidate<S>>) -> bool {
    let Some(wall) = wall else { return false };
    let mut both = wall.equations;
    for beam in run {
        let (u, slope) = wall.line.at(beam);
        let variance = noise.variance(u, slope);
        if (beam.inverse - u).squared() < S::from_f64(GATE * GATE) * (variance + wall.covariance.at(beam)) {
            both.add(beam, S::from_f64(1.0) / variance, beam.inverse);
        }
    }
    let line = both.solve().0;
    wall.covariance.mahalanobis_squared(line.minus(wall.line)) < S::from_f64(SAME_LINE_THRESHOLD)
        && count_inliers(noise, run, &line) >= MIN_ORPHANS
}
