//! The margin over the angles, for a picture: how fast W falls at the least, for each way of seeing the goal.

use core::f64::consts::PI;

use crate::certificate::Request;
use crate::interval::Interval;
use crate::region::Region;
use crate::subject::Subject;
use crate::weight::Weight;

/// Lower bounds of −Ẇ over (α̂, φ̂), at one distance.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginMap {
    /// The true distance \[m].
    pub rho: f64,
    /// Number of cells along each angle, from −π to π.
    pub side: usize,
    /// Lower bounds of −Ẇ \[1/s], α̂ by α̂, φ̂ within; negative infinity where none was found.
    pub fall: Vec<f64>,
}

/// Into how many parts a cell is cut along each angle, for tighter bounds.
const PARTS: usize = 3;

/// The margin with `weight` at the true distance `rho` \[m], in `side`² cells.
pub fn margin_map<L: Subject>(request: &Request<'_, L>, weight: Weight, rho: f64, side: usize) -> MarginMap {
    let mut descent = request.descent(weight);
    let rho_set = Interval::point(rho);
    descent.prepare(rho_set);
    let circle = Interval::new((-PI).next_up(), PI);
    let fine = side * PARTS;
    let bound = |a: usize, p: usize| {
        let region = Region {
            rho: rho_set,
            drift: Interval::symmetric(request.noise.position),
            alpha: circle.piece(a, fine),
            phi: circle.piece(p, fine),
        };
        let (low, high) = region.drift.halves();
        [low, high]
            .into_iter()
            .map(|drift| -descent.fall(&Region { drift, ..region }, 0.0).rate)
            .fold(f64::INFINITY, f64::min)
    };
    let cell = |a: usize, p: usize| {
        let parts = (0..PARTS * PARTS).map(|k| bound(a * PARTS + k / PARTS, p * PARTS + k % PARTS));
        parts.fold(f64::INFINITY, f64::min)
    };
    let fall = (0..side * side).map(|k| cell(k / side.max(1), k % side.max(1))).collect();
    MarginMap { rho, side, fall }
}
