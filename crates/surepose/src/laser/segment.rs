//! The straight runs of a scan, in the order of its beams.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::evidence::{Evidence, misfit_limit};
use super::grow::{WINDOW, agreeing, grow, refit, seed};
use super::list::List;
use super::ray_line::RayLine;

/// The most segments that are kept of one scan.
pub(super) const MOST_SEGMENTS: usize = 32;

/// The fewest beams of a segment.
const FEWEST: u16 = 5;

/// A segment left with fewer beams of its own than this loses them all to the line that explains the others.
const FEWEST_OF_ITS_OWN: usize = 7;

/// How much rougher than its noise a wall may be before it is none: misfit per beam.
///
/// Plaster, skirting boards and door frames are not straight to a laser's noise. The covariance of such a line is
/// widened by its misfit (see the fit); a curve or two walls under one line misfit by far more.
pub(super) const ROUGHEST: f64 = 4.0;

/// A run of beams on one line; both ends belong to it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Segment<S> {
    pub first: usize,
    pub last: usize,
    pub evidence: Evidence<S>,
    pub line: RayLine<S>,
}

pub(super) type Segments<S> = List<Segment<S>, MOST_SEGMENTS>;

/// Finds the segments of a scan.
pub(super) fn find<S: Float>(noise: &BeamNoise<S>, beams: &[Beam<S>]) -> Segments<S> {
    let mut segments = Segments::new();
    let mut start = 0;
    // Where the segment before ends: its beams are its own.
    let mut free = 0;
    while start + WINDOW <= beams.len() && !segments.is_full() {
        let end = start + WINDOW;
        let Some(evidence) = seed(noise, &beams[start..end]) else {
            start += 1;
            continue;
        };
        let line = evidence.solve().0;
        let mut segment = Segment { first: start, last: end - 1, evidence, line };
        grow(noise, beams, &mut segment, end..beams.len());
        grow(noise, beams, &mut segment, (free..start).rev());
        refit(noise, beams, &mut segment);
        if !is_straight(&segment.evidence) {
            start += 1;
            continue;
        }
        take_back(noise, beams, &mut segments, &mut segment);
        free = segment.last + 1;
        start = free;
        segments.push(segment);
    }
    segments
}

/// Whether so many beams of one line would misfit it so much.
fn is_straight<S: Float>(evidence: &Evidence<S>) -> bool {
    let rough = S::of(if evidence.count < 20 { 0.0 } else { ROUGHEST * f64::from(evidence.count) });
    evidence.count >= FEWEST && evidence.misfit <= misfit_limit::<S>(evidence.count).max(rough)
}

/// Takes the beams of the segments before that lie on this one's line, where these then have too few of their own.
///
/// A steep line through a few beams on either side of an edge passes every test by itself. It starts before the
/// wall behind it and so would keep that wall's first beams. So does a line round a corner whose near leg is short:
/// where the segment before has enough beams of its own, those that both explain go to the one that more beams know.
fn take_back<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    segments: &mut Segments<S>,
    segment: &mut Segment<S>,
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
        let own = agreeing(noise, &beams[before.first..longer.first], &before.line);
        if own >= FEWEST_OF_ITS_OWN && before.evidence.count >= longer.evidence.count {
            return;
        }
        segments.drop_last();
        refit(noise, beams, &mut longer);
        *segment = longer;
        if own >= FEWEST_OF_ITS_OWN {
            let mut shorter = Segment { last: longer.first - 1, ..before };
            refit(noise, beams, &mut shorter);
            segments.push(shorter);
            return;
        }
    }
}
