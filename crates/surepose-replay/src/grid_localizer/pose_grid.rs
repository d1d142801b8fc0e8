//! Exhaustive search over all free cells and headings of a grid.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use surepose::geometry::{Angle, Body, Point, Pose};
use surepose::map::Cell;
use surepose_io::grid::Cells;

use super::likelihood_field::LikelihoodField;

/// Position step \[m], and number of headings per turn.
const STEP: f64 = 0.2;
const HEADINGS: i32 = 72;

/// Maximum error of an end point due to the grid of poses \[m].
pub(super) const COARSE: f64 = 0.25;

/// Block size in steps of x, y and heading; only the best pose of a block is kept.
const BLOCK: i32 = 3;

/// Returns the best pose of each block by the distance of `ends` from walls; at most `most`, the best first.
pub(super) fn poses(
    field: &LikelihoodField,
    ends: &[Point<Body, f64>],
    most: usize,
) -> Vec<Pose<Cells, Body, f64>> {
    let law = field.likelihood_table(COARSE);
    let step = (STEP / field.resolution()).round().max(1.0) as i32;
    let (width, height) = field.size();
    let candidates = (0..height / step).flat_map(|y| (0..width / step).map(move |x| (x, y)));
    let candidates: Vec<_> = candidates.filter(|(x, y)| field.is_free((x * step, y * step))).collect();
    let mut best: BTreeMap<[i32; 3], (f64, Cell, i32)> = BTreeMap::new();
    for turn in 0..HEADINGS {
        let cell_from_body = Pose::<Cells, Body, f64>::new(0.0, 0.0, heading(turn));
        let to_end = |end: &Point<Body, f64>| {
            let end = cell_from_body * *end;
            let cells = |length: f64| (length / field.resolution()).round() as i32;
            (cells(end.x), cells(end.y))
        };
        let ends: Vec<Cell> = ends.iter().map(to_end).collect();
        for &(x, y) in &candidates {
            let at = (x * step, y * step);
            let score = ends.iter().map(|end| field.log_likelihood(&law, (at.0 + end.0, at.1 + end.1))).sum();
            let block = best.entry([x / BLOCK, y / BLOCK, turn / BLOCK]).or_insert((score, at, turn));
            if score > block.0 {
                *block = (score, at, turn);
            }
        }
    }
    let mut best: Vec<_> = best.into_values().collect();
    best.sort_by(|a, b| b.0.total_cmp(&a.0));
    let poses = best.into_iter().take(most).map(|(_, cell, turn)| {
        let at = field.middle(cell);
        Pose::new(at.x, at.y, heading(turn))
    });
    poses.collect()
}

fn heading(turn: i32) -> Angle<f64> {
    Angle::from_radians(TAU * f64::from(turn) / f64::from(HEADINGS))
}
