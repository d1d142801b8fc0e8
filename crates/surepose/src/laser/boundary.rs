//! Which beams see which wall for certain: those next to an edge or a corner may have slipped past it.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::join::{Candidate, Candidates, Piece, Pieces};

/// How far from a corner a beam must be to be sure of its wall, in standard deviations of its bearing.
const MARGIN: f64 = 2.0;

/// What the uncertainty of the two lines counts in it, as a factor of its variance.
///
/// Greater than 1, because the beams beyond the corner that a segment took in have turned its line towards them.
const LINE_SHARE: f64 = 2.0;

/// How many beams from the ends of two pieces their corner is looked for: growing takes in no more beyond it.
const REACH: usize = 6;

/// The pieces without the beams that are not certain to see their walls.
///
/// `count` is the number of beams of the whole scan: the first and the last one have no neighbour to be mistaken for.
pub(super) fn certain<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    count: usize,
    walls: &Candidates<S>,
    pieces: &Pieces,
) -> Pieces {
    let mut result = Pieces::new();
    let is_end = |beam: &Beam<S>| beam.number == 0 || usize::from(beam.number) + 1 == count;
    let mut first = match pieces.first() {
        Some(piece) if is_end(&beams[piece.first]) => piece.first,
        Some(piece) => piece.first + 1,
        None => return result,
    };
    for (k, piece) in pieces.iter().enumerate() {
        let (end, next_first) = match pieces.get(k + 1) {
            Some(next) => part(noise, beams, walls, piece, next),
            None if is_end(&beams[piece.last]) => (piece.last + 1, 0),
            None => (piece.last, 0),
        };
        if first < end {
            result.push(Piece { first, last: end - 1, wall: piece.wall });
        }
        first = next_first;
    }
    result
}

/// Where `piece` ends for certain, and where `next` begins.
fn part<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    walls: &Candidates<S>,
    piece: &Piece,
    next: &Piece,
) -> (usize, usize) {
    let at_edges = (piece.last, next.first + 1);
    if piece.wall == next.wall {
        return at_edges;
    }
    let (this, other) = (&walls[piece.wall], &walls[next.wall]);
    let low = piece.last.saturating_sub(REACH).max(piece.first);
    let high = (next.first + REACH).min(next.last);
    let apart = this.line.minus(other.line);
    let side = |i: usize| apart.at(&beams[i]).0 > S::of(0.0);
    let Some(corner) = (low..high).find(|&i| side(i) != side(i + 1)).map(|i| i + 1) else {
        return at_edges;
    };
    let sure = |i: usize| is_sure(noise, &beams[i], this, other);
    let end = (low..corner).rev().find(|&i| sure(i)).map_or(low, |i| i + 1);
    let begin = (corner..high).find(|&i| sure(i)).unwrap_or(high);
    (end, begin)
}

/// Whether the two walls' inverse ranges differ at the beam by more than bearing noise and their own errors do.
fn is_sure<S: Float>(
    noise: &BeamNoise<S>,
    beam: &Beam<S>,
    this: &Candidate<S>,
    other: &Candidate<S>,
) -> bool {
    let (difference, slope) = this.line.minus(other.line).at(beam);
    let lines = this.spread.plus(other.spread).at(beam);
    let variance = noise.bearing * slope.squared() + S::of(LINE_SHARE) * lines;
    difference.squared() > S::of(MARGIN * MARGIN) * variance
}
