//! From a few beams that agree on a line to all that join it.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::inverse_range_line::InverseRangeLine;
use super::line_normal_equations::LineNormalEquations;
use super::segment::LineSegment;

/// How many neighbouring beams are looked at for the start of a line, and how many of them must agree.
///
/// Five of seven: with every fifth beam hidden by something else, six of seven starts succeed.
pub(super) const WINDOW: usize = 7;
const MIN_INLIERS: u16 = 5;

/// How many standard deviations a beam of the line may be off it.
const GATE: f64 = 3.0;

/// How many beams in a row may miss the line, or not come back, before it ends.
const MAX_MISSES: usize = 5;

/// Which two beams of the window are tried as the ends of a line: wide pairs first.
const PAIRS: [(usize, usize); 6] =
    [(0, WINDOW - 1), (0, WINDOW - 2), (1, WINDOW - 1), (1, WINDOW - 2), (0, WINDOW - 3), (2, WINDOW - 1)];

/// The line on which the most part of these beams agree, if there is one.
pub(super) fn seed<S: Float>(noise: &BeamNoise<S>, window: &[Beam<S>]) -> Option<LineNormalEquations<S>> {
    if window.first()?.number.abs_diff(window.last()?.number) as usize >= WINDOW + MAX_MISSES {
        return None;
    }
    // The pair is as noisy as the beam it is compared with: twice the variance.
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

/// Lets the beams numbered by `indices` join the segment, outward from one of its ends, until too many in a row do not.
///
/// Beams that join only after a gap are taken when they are more than the gap was long; else a line would reach
/// across an edge for the few beams that happen to lie on it.
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
    // The segment as it was before a gap that is not yet bridged, and how long the gap is.
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

/// Does the sums again with the segment's own line deciding which of its beams belong, and with what weight.
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

/// How many of these beams lie on `line`.
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
