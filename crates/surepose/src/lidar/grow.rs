//! Line segments that grow from a seed of a few beams.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::inverse_range_line::InverseRangeLine;
use super::line_normal_equations::LineNormalEquations;

/// Number of neighboring beams in a seed window, and the number of them that must agree on a line.
///
/// Five of seven: with a fifth of the beams occluded, six of seven seeds succeed.
pub(super) const WINDOW: usize = 7;
const MIN_INLIERS: u16 = 5;

/// Gate of a beam of the line, in standard deviations.
const GATE: f64 = 3.0;

/// Maximum consecutive beams without a return on the line inside a segment.
const MAX_MISSES: usize = 5;

/// Pairs of beams of the window that are tried as the ends of a line, wide pairs first.
const PAIRS: [(usize, usize); 6] =
    [(0, WINDOW - 1), (0, WINDOW - 2), (1, WINDOW - 1), (1, WINDOW - 2), (0, WINDOW - 3), (2, WINDOW - 1)];

/// A run of beams on one line; both ends are inclusive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineSegment<S> {
    pub first: usize,
    pub last: usize,
    pub equations: LineNormalEquations<S>,
    pub line: InverseRangeLine<S>,
}

/// Seeds a line from the window: the first pair with which enough beams agree. `None` where no pair succeeds.
pub(super) fn seed<S: Float>(noise: &BeamNoise<S>, window: &[Beam<S>]) -> Option<LineNormalEquations<S>> {
    if window.first()?.number.abs_diff(window.last()?.number) as usize >= WINDOW + MAX_MISSES {
        return None;
    }
    // The pair is as noisy as the beam that is tested: twice the variance.
    let gate = S::from_f64(2.0 * GATE * GATE);
    PAIRS.iter().find_map(|&(i, j)| {
        let line = InverseRangeLine::through(window.get(i)?, window.get(j)?);
        let mut equations = LineNormalEquations::default();
        for beam in window {
            let (u, slope) = line.at(beam);
            let variance = noise.variance(u, slope);
            if u > S::from_f64(0.0) && (beam.inverse - u).squared() < gate * variance {
                equations.add(beam, S::from_f64(1.0) / variance, beam.inverse);
                equations.count += 1;
            }
        }
        (equations.count >= MIN_INLIERS).then_some(equations)
    })
}

/// Adds the beams of `indices` to the segment, outward from one of its ends, until too many in a row are off the line.
///
/// Beams behind a gap are added only if they outnumber the beams of the gap. Otherwise a line would extend across an
/// edge to a few beams that lie on it by chance.
pub(super) fn grow<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    segment: &mut LineSegment<S>,
    indices: impl Iterator<Item = usize>,
) {
    let gate = S::from_f64(GATE * GATE);
    let (mut line, mut covariance) = segment.equations.solve();
    let mut misses = 0_usize;
    let mut joined_since = 0_usize;
    // The segment before a gap that is not yet bridged, and the length of the gap in beams.
    let mut before_gap: Option<(LineSegment<S>, usize)> = None;
    let mut before = None;
    for i in indices {
        let beam = &beams[i];
        let end = if i > segment.last { segment.last } else { segment.first };
        let difference = beam.number.abs_diff(before.unwrap_or(beams[end].number));
        if usize::from(difference) > MAX_MISSES {
            break;
        }
        before = Some(beam.number);
        let (u, slope) = line.at(beam);
        let variance = noise.variance(u, slope);
        let error = beam.inverse - u;
        if u > S::from_f64(0.0) && error.squared() < gate * (variance + covariance.at(beam)) {
            segment.equations.add(beam, S::from_f64(1.0) / variance, beam.inverse);
            segment.equations.count += 1;
            (line, covariance) = segment.equations.solve();
            segment.first = segment.first.min(i);
            segment.last = segment.last.max(i);
            misses = 0;
            joined_since += 1;
            if before_gap.is_some_and(|(_, gap)| joined_since > gap) {
                before_gap = None;
            }
        } else {
            misses += 1;
            if misses >= 2 {
                joined_since = 0;
                let (shorter, gap) = before_gap.unwrap_or((*segment, 0));
                before_gap = Some((shorter, gap.max(misses)));
            }
            if misses > MAX_MISSES {
                break;
            }
        }
    }
    if let Some((shorter, _)) = before_gap {
        *segment = shorter;
    }
    segment.line = segment.equations.solve().0;
}

/// Recomputes the sums with the line of the segment, which selects and weights the beams.
pub(super) fn refit<S: Float>(noise: &BeamNoise<S>, beams: &[Beam<S>], segment: &mut LineSegment<S>) {
    let gate = S::from_f64(GATE * GATE);
    let mut equations = LineNormalEquations::default();
    for beam in &beams[segment.first..=segment.last] {
        let (u, slope) = segment.line.at(beam);
        let weight = S::from_f64(1.0) / noise.variance(u, slope);
        let chi2 = (beam.inverse - u).squared() * weight;
        if u > S::from_f64(0.0) && chi2 < gate {
            equations.add(beam, weight, beam.inverse);
            equations.count += 1;
            equations.chi2 = equations.chi2 + chi2;
        }
    }
    segment.equations = equations;
    segment.line = equations.solve().0;
}

/// Number of the beams that lie on `line`.
pub(super) fn count_inliers<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    line: &InverseRangeLine<S>,
) -> usize {
    let on_it = |beam: &&Beam<S>| {
        let (u, slope) = line.at(beam);
        (beam.inverse - u).squared() < S::from_f64(GATE * GATE) * noise.variance(u, slope)
    };
    beams.iter().filter(on_it).count()
}
