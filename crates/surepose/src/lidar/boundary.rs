//! Which beams see which wall for certain: those next to an edge or a corner may have slipped past it.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::grow::{WINDOW, count_inliers};
use super::merge::{BeamRun, BeamRuns, WallCandidate, WallCandidates};
use super::scan::Scan;

/// How far from a corner a beam must be to be sure of its wall, in standard deviations of its bearing.
const MARGIN: f64 = 2.0;

/// What the uncertainty of the two lines counts in it, as a factor of its variance.
///
/// Greater than 1, because the beams beyond the corner that a segment took in have turned its line towards them.
const LINE_VARIANCE_FACTOR: f64 = 2.0;

/// How many beams from the ends of two runs their corner is looked for, at steps of [`NOMINAL_INCREMENT`] or more: growing takes in
/// no more beyond it.
const CORNER_REACH: usize = 6;

/// How many beams at either end of the field of view are left out, at steps of [`NOMINAL_INCREMENT`] or more.
///
/// A corner so near the end has too few beams beyond it to start a segment of their own: the wall before it takes
/// them in, and they turn its line the same way at every scan from one place. Over 20 000 scans of the paper's arena
/// from (2, 2, 30°) the mean NEES of a wall at the end of the view was 3.3 with them and 2.2 without; it is 2 for true walls.
const VIEW_END: usize = 3;

/// Steps for which the numbers above are, 0.5° \[rad]. With finer ones more beams lie between a corner and where the walls
/// are apart by more than range noise.
const NOMINAL_INCREMENT: f64 = 0.0087;

/// The most beams that one of finer steps counts for here: 0.06°.
const MAX_FINE_STEPS: usize = 8;

/// The runs without the beams that are not certain to see their walls.
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

/// How many beams the outermost run loses where the field of view has `beyond` more: one next to what did not come
/// back, up to [`VIEW_END`] at its end. A short wall keeps the beams it was found by, or it would be lost altogether.
fn trimmed_beams(run: &BeamRun, beyond: usize, margins: Margins) -> usize {
    let spare = (run.last - run.first).saturating_sub(WINDOW);
    margins.view_end.saturating_sub(beyond).max(margins.edge).min(spare).max(1)
}

/// Distances in beams.
#[derive(Clone, Copy)]
struct Margins {
    /// To where a beam is certain to have met an edge.
    edge: usize,
    /// As [`CORNER_REACH`].
    reach: usize,
    /// As [`VIEW_END`].
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

/// Where `run` ends for certain, and where `next` begins.
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

/// Whether the two walls meet where their lines cross: then most beams that growing took in beyond lie on the other line.
///
/// The line of a plate may go on to cross the wall behind it near its end; the beams between are the wall's own.
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

/// Whether the two walls' inverse ranges differ at the beam by more than bearing noise and their own errors do.
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
