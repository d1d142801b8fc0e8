//! Straight segments of a scan, in the order of its beams.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::fixed_vec::FixedVec;
use super::grow::{LineSegment, WINDOW, count_inliers, grow, refit, seed};
use super::line_normal_equations::{LineNormalEquations, chi2_limit};

/// Maximum number of segments of one scan.
pub(super) const MAX_SEGMENTS: usize = 32;

/// Minimum number of beams of a segment.
const MIN_BEAMS: u16 = 5;

/// Minimum number of own beams of a segment; with fewer it is absorbed by the line that explains the others.
const MIN_OWN_BEAMS: usize = 7;

/// Maximum χ² per degree of freedom of a wall.
///
/// Plaster, skirting boards and door frames deviate from a straight line by more than laser noise. The covariance of
/// such a line is multiplied by its reduced χ² (see `fit`). Curves, and two walls under one line, misfit by far more.
pub(super) const MAX_REDUCED_CHI2: f64 = 4.0;

pub(super) type LineSegments<S> = FixedVec<LineSegment<S>, MAX_SEGMENTS>;

/// Finds the segments of a scan.
pub(super) fn find<S: Float>(noise: &BeamNoise<S>, beams: &[Beam<S>]) -> LineSegments<S> {
    let mut segments = LineSegments::new();
    let mut start = 0;
    // End of the previous segment, whose beams are not available to the next.
    let mut first_free = 0;
    while start + WINDOW <= beams.len() && !segments.is_full() {
        let end = start + WINDOW;
        let Some(equations) = seed(noise, &beams[start..end]) else {
            start += 1;
            continue;
        };
        let line = equations.solve().0;
        let mut segment = LineSegment { first: start, last: end - 1, equations, line };
        grow(noise, beams, &mut segment, end..beams.len());
        grow(noise, beams, &mut segment, (first_free..start).rev());
        refit(noise, beams, &mut segment);
        if !is_straight(&segment.equations) {
            start += 1;
            continue;
        }
        resolve_overlap(noise, beams, &mut segments, &mut segment);
        first_free = segment.last + 1;
        start = first_free;
        segments.push(segment);
    }
    segments
}

/// Whether the χ² of the segment is plausible for one straight line.
fn is_straight<S: Float>(equations: &LineNormalEquations<S>) -> bool {
    let rough =
        S::from_f64(if equations.count < 20 { 0.0 } else { MAX_REDUCED_CHI2 * f64::from(equations.count) });
    equations.count >= MIN_BEAMS && equations.chi2 <= chi2_limit::<S>(equations.count).max(rough)
}

/// Takes over beams of the previous segments that lie on this line, where few of their own would remain.
///
/// A steep line through a few beams on either side of an edge passes every test by itself. It starts before the wall
/// behind it and so would keep the first beams of that wall. The same holds for a line around a corner with a short
/// near leg. Where the previous segment keeps enough own beams, shared beams go to the line with more beams.
fn resolve_overlap<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    segments: &mut LineSegments<S>,
    segment: &mut LineSegment<S>,
) {
    while let Some(before) = segments.last().copied() {
        if segment.first > before.last + 2 {
            return;
        }
        let mut longer = *segment;
        grow(noise, beams, &mut longer, (before.first..segment.first).rev());
        if longer.first > before.last {
            return;
        }
        let own = count_inliers(noise, &beams[before.first..longer.first], &before.line);
        if own >= MIN_OWN_BEAMS && before.equations.count >= longer.equations.count {
            return;
        }
        segments.pop();
        refit(noise, beams, &mut longer);
        *segment = longer;
        if own >= MIN_OWN_BEAMS {
            let mut shorter = LineSegment { last: longer.first - 1, ..before };
            refit(noise, beams, &mut shorter);
            segments.push(shorter);
            return;
        }
    }
}
