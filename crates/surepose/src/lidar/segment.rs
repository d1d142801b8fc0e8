//! The straight runs of a scan, in the order of its beams.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::fixed_vec::FixedVec;
use super::grow::{WINDOW, count_inliers, grow, refit, seed};
use super::inverse_range_line::InverseRangeLine;
use super::line_normal_equations::{LineNormalEquations, chi2_limit};

/// The most segments that are kept of one scan.
pub(super) const MAX_SEGMENTS: usize = 32;

/// The fewest beams of a segment.
const MIN_BEAMS: u16 = 5;

/// A segment left with fewer beams of its own than this loses them all to the line that explains the others.
const MIN_OWN_BEAMS: usize = 7;

/// How much rougher than its noise a wall may be before it is none: χ² per degree of freedom.
///
/// Plaster, skirting boards and door frames are not straight to a laser's noise. The covariance of such a line is
/// widened by its reduced χ² (see the fit); a curve or two walls under one line misfit by far more.
pub(super) const MAX_REDUCED_CHI2: f64 = 4.0;

/// A run of beams on one line; both ends belong to it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineSegment<S> {
    pub first: usize,
    pub last: usize,
    pub equations: LineNormalEquations<S>,
    pub line: InverseRangeLine<S>,
}

pub(super) type LineSegments<S> = FixedVec<LineSegment<S>, MAX_SEGMENTS>;

/// Finds the segments of a scan.
pub(super) fn find<S: Float>(noise: &BeamNoise<S>, beams: &[Beam<S>]) -> LineSegments<S> {
    let mut segments = LineSegments::new();
    let mut start = 0;
    // Where the segment before ends: its beams are its own.
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

/// Whether so many beams of one line would misfit it so much.
fn is_straight<S: Float>(equations: &LineNormalEquations<S>) -> bool {
    let rough =
        S::from_f64(if equations.count < 20 { 0.0 } else { MAX_REDUCED_CHI2 * f64::from(equations.count) });
    equations.count >= MIN_BEAMS && equations.chi2 <= chi2_limit::<S>(equations.count).max(rough)
}

/// Takes the beams of the segments before that lie on this one's line, where these then have too few of their own.
///
/// A steep line through a few beams on either side of an edge passes every test by itself. It starts before the
/// wall behind it and so would keep that wall's first beams. So does a line round a corner whose near leg is short:
/// where the segment before has enough beams of its own, those that both explain go to the one that more beams know.
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
