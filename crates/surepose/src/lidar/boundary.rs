//! Removal of beams near edges and corners, whose wall is ambiguous.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::grow::{WINDOW, count_inliers};
use super::merge::{BeamRun, BeamRuns, WallCandidate, WallCandidates};
use super::scan::Scan;

/// Minimum distance of a beam from a corner, in standard deviations of its bearing.
const MARGIN: f64 = 2.0;

/// Factor of the variance of the two lines in the corner test.
///
/// It exceeds 1 because the beams beyond the corner that a segment includes have turned its line toward them.
const LINE_VARIANCE_FACTOR: f64 = 2.0;

/// Search range for the corner of two runs, in beams from their ends at increments of [`NOMINAL_INCREMENT`] or more.
/// Growing includes no more beams beyond a corner.
const CORNER_REACH: usize = 6;

/// Beams removed at either end of the field of view, at increments of [`NOMINAL_INCREMENT`] or more.
///
/// A corner near the end has too few beams beyond it to seed a segment. The wall before it includes them, and they
/// bias its line equally in every scan from one pose. Over 20 000 scans of the arena of the paper from (2, 2, 30°),
/// the mean NEES of a wall at the end of the view was 3.3 with them and 2.2 without; it is 2 for true walls.
const VIEW_END: usize = 3;

/// Angle increment for which the numbers above hold, 0.5° \[rad]. At finer increments more beams lie between a corner
/// and the point where the distance of the walls exceeds range noise.
const NOMINAL_INCREMENT: f64 = 0.0087;

/// Maximum factor on the beam counts for finer increments, reached at 0.06°.
const MAX_FINE_STEPS: usize = 8;

/// Removes the beams of the runs whose wall is ambiguous.
pub(super) fn trim_ambiguous<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    scan: &Scan<'_, S>,
    walls: &WallCandidates<S>,
    runs: &BeamRuns,
) -> BeamRuns {
    let count = scan.ranges.len();
    let margins = Margins::from_noise(noise, scan);
    let mut result = BeamRuns::new();
    let Some(run) = runs.first() else { return result };
    let mut first = run.first + trimmed_beams(run, usize::from(beams[run.first].number), margins);
    for (k, run) in runs.iter().enumerate() {
        let (end, next_first) = if let Some(next) = runs.get(k + 1) {
            split_at_corner(noise, beams, walls, run, next, margins)
        } else {
            let beyond = count.saturating_sub(usize::from(beams[run.last].number) + 1);
            ((run.last + 1).saturating_sub(trimmed_beams(run, beyond, margins)), 0)
        };
        if first < end {
            result.push(BeamRun { first, last: end - 1, wall: run.wall });
        }
        first = next_first;
    }
    result
}

/// Number of beams to remove from the outermost run where the field of view has `beyond` more beams. It is one next to
/// a missing return and up to [`VIEW_END`] at the end. A short wall keeps its seed beams and so is not lost.
fn trimmed_beams(run: &BeamRun, beyond: usize, margins: Margins) -> usize {
    let spare = (run.last - run.first).saturating_sub(WINDOW);
    margins.view_end.saturating_sub(beyond).max(margins.edge).min(spare).max(1)
}

/// Margins in beams.
#[derive(Clone, Copy)]
struct Margins {
    /// Distance beyond which a beam has certainly met an edge.
    edge: usize,
    /// [`CORNER_REACH`], scaled by the increment.
    reach: usize,
    /// [`VIEW_END`], scaled by the increment.
    view_end: usize,
}

impl Margins {
    fn from_noise<S: Float>(noise: &BeamNoise<S>, scan: &Scan<'_, S>) -> Self {
        let steps = |angle: S, max_steps: usize| {
            let steps = angle / scan.angle_increment.abs();
            (1..max_steps).find(|&n| steps < S::from_f64(n as f64 + 0.5)).unwrap_or(max_steps)
        };
        let fine = steps(S::from_f64(NOMINAL_INCREMENT), MAX_FINE_STEPS);
        let edge = steps(noise.bearing.sqrt() * S::from_f64(MARGIN), CORNER_REACH * MAX_FINE_STEPS);
        Self { edge, reach: CORNER_REACH * fine, view_end: VIEW_END * fine }
    }
}

/// Returns the unambiguous end of `run` and the unambiguous start of `next`.
fn split_at_corner<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    walls: &WallCandidates<S>,
    run: &BeamRun,
    next: &BeamRun,
    margins: Margins,
) -> (usize, usize) {
    let off = |run: &BeamRun| margins.edge.min((run.last - run.first).saturating_sub(WINDOW) / 2).max(1);
    let at_edges = ((run.last + 1).saturating_sub(off(run)), next.first + off(next));
    if run.wall == next.wall {
        return at_edges;
    }
    let (this, other) = (&walls[run.wall], &walls[next.wall]);
    let low = run.last.saturating_sub(margins.reach).max(run.first);
    let high = (next.first + margins.reach).min(next.last);
    let difference = this.line.minus(other.line);
    let side = |i: usize| difference.at(&beams[i]).0 > S::from_f64(0.0);
    let crossing = (low..high).find(|&i| side(i) != side(i + 1)).map(|i| i + 1);
    let Some(corner) = crossing.filter(|&corner| is_corner(noise, beams, (run, this), (next, other), corner))
    else {
        return at_edges;
    };
    let is_clear = |i: usize| is_unambiguous(noise, &beams[i], this, other);
    let end = (low..corner).rev().find(|&i| is_clear(i)).map_or(low, |i| i + 1);
    let begin = (corner..high).find(|&i| is_clear(i)).unwrap_or(high);
    (end, begin)
}

/// Whether the two walls meet where their lines cross. Most beams that growing included beyond then lie on the other
/// line.
///
/// The extended line of a plate may cross the wall behind it near its end; the beams between belong to that wall.
fn is_corner<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    (run, this): (&BeamRun, &WallCandidate<S>),
    (next, other): (&BeamRun, &WallCandidate<S>),
    crossing: usize,
) -> bool {
    let (between, line) = if crossing <= run.last {
        (&beams[crossing..=run.last], &other.line)
    } else {
        (&beams[next.first.min(crossing)..crossing], &this.line)
    };
    2 * count_inliers(noise, between, line) >= between.len()
}

/// Whether the inverse ranges of the two walls at the beam differ by more than bearing noise and line uncertainty.
fn is_unambiguous<S: Float>(
    noise: &BeamNoise<S>,
    beam: &Beam<S>,
    this: &WallCandidate<S>,
    other: &WallCandidate<S>,
) -> bool {
    let (difference, slope) = this.line.minus(other.line).at(beam);
    let lines = this.covariance.plus(other.covariance).at(beam);
    let variance = noise.bearing * slope.squared() + S::from_f64(LINE_VARIANCE_FACTOR) * lines;
    difference.squared() > S::from_f64(MARGIN * MARGIN) * variance
}
