//! Walls from segments: one wall may be seen in pieces, before and behind what stands in front of it.

use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::evidence::{Evidence, Spread};
use super::grow::agreeing;
use super::list::List;
use super::ray_line::RayLine;
use super::segment::{MOST_SEGMENTS, Segments};

/// Segments are of one line where their difference is below the 99.9 % quantile of χ² with 2 degrees of freedom.
const ONE_LINE: f64 = 13.8;

/// How many standard deviations a left-over beam may be off the wall that takes it in.
const GATE: f64 = 3.0;

/// A left-over piece of a wall has at least this many beams.
const FEWEST_LEFT_OVER: usize = 3;

/// All that the scan says of one straight wall.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Candidate<S> {
    pub evidence: Evidence<S>,
    pub line: RayLine<S>,
    pub spread: Spread<S>,
}

/// A run of beams that see the candidate numbered `wall`; both ends belong to it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    pub first: usize,
    pub last: usize,
    pub wall: usize,
}

pub(super) type Candidates<S> = List<Candidate<S>, MOST_SEGMENTS>;
pub(super) type Pieces = List<Piece, MOST_SEGMENTS>;

impl<S: Float> Candidate<S> {
    fn of(evidence: Evidence<S>) -> Self {
        let (line, spread) = evidence.solve();
        Self { evidence, line, spread }
    }
}

/// Joins the segments that are of one line.
pub(super) fn join<S: Float>(segments: &Segments<S>) -> (Candidates<S>, Pieces) {
    let mut walls = Candidates::new();
    let mut pieces = Pieces::new();
    for segment in segments.iter() {
        let new = Candidate::of(segment.evidence);
        let same = walls.iter().position(|wall| {
            let apart = wall.line.minus(new.line);
            wall.spread.plus(new.spread).mahalanobis_squared(apart) < S::of(ONE_LINE)
        });
        let wall = same.unwrap_or(walls.len());
        if let Some(known) = walls.get_mut(wall) {
            *known = Candidate::of(known.evidence.with(&segment.evidence));
        } else {
            walls.push(new);
        }
        pieces.push(Piece { first: segment.first, last: segment.last, wall });
    }
    (walls, pieces)
}

/// Offers the beams between the pieces, too few to be a segment, to every wall.
pub(super) fn adopt<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    walls: &Candidates<S>,
    pieces: &mut Pieces,
) {
    let mut low = 0;
    let mut next = 0;
    while next <= pieces.len() {
        let high = pieces.get(next).map_or(beams.len(), |piece| piece.first);
        let found = (low + FEWEST_LEFT_OVER <= high && !pieces.is_full())
            .then(|| best_run(noise, beams, walls, low, high))
            .flatten()
            .filter(|piece| bears_out(noise, &beams[piece.first..=piece.last], walls.get(piece.wall)));
        if let Some(piece) = found {
            pieces.insert(next, piece);
            next += 1;
        }
        low = pieces.get(next).map_or(beams.len(), |piece| piece.last + 1);
        next += 1;
    }
}

/// The longest run among the beams `low..high` that lies on one of the walls, single beams off it stepped over.
fn best_run<S: Float>(
    noise: &BeamNoise<S>,
    beams: &[Beam<S>],
    walls: &Candidates<S>,
    low: usize,
    high: usize,
) -> Option<Piece> {
    let mut best = (FEWEST_LEFT_OVER - 1, None);
    for (wall, candidate) in walls.iter().enumerate() {
        let (mut hits, mut misses, mut first) = (0, 0, low);
        for (i, beam) in beams.iter().enumerate().take(high).skip(low) {
            let (u, slope) = candidate.line.at(beam);
            let variance = noise.variance(u, slope) + candidate.spread.at(beam);
            if u > S::of(0.0) && (beam.inverse - u).squared() < S::of(GATE * GATE) * variance {
                first = if hits == 0 { i } else { first };
                hits += 1;
                misses = 0;
                if hits > best.0 {
                    best = (hits, Some(Piece { first, last: i, wall }));
                }
            } else {
                misses += 1;
                hits = if misses > 1 { 0 } else { hits };
            }
        }
    }
    best.1
}

/// Whether beams that lie where a wall may be still do so when they have their say in where it is.
///
/// A short wall's line is vague far beyond its ends: two or three beams of anything lie on it there, each by itself, and
/// one of them alone would turn it.
fn bears_out<S: Float>(noise: &BeamNoise<S>, run: &[Beam<S>], wall: Option<&Candidate<S>>) -> bool {
    let Some(wall) = wall else { return false };
    let mut both = wall.evidence;
    for beam in run {
        let (u, slope) = wall.line.at(beam);
        let variance = noise.variance(u, slope);
        if (beam.inverse - u).squared() < S::of(GATE * GATE) * (variance + wall.spread.at(beam)) {
            both.add(beam, S::of(1.0) / variance, beam.inverse);
        }
    }
    let line = both.solve().0;
    wall.spread.mahalanobis_squared(line.minus(wall.line)) < S::of(ONE_LINE)
        && agreeing(noise, run, &line) >= FEWEST_LEFT_OVER
}
