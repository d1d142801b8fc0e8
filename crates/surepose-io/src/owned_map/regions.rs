//! Regions of a map that walls separate: a flood over a grid.

use surepose::geometry::{Map, Point};
use surepose::map::Wall;

/// Side of a cell \[m], at most and at least.
const MAX_CELL: f64 = 0.05;
const MIN_CELL: f64 = 0.01;

/// The largest number of cells. A larger map is not examined.
const MAX_CELLS: f64 = 3e7;

/// Whether walls separate two points for a disc of `radius` \[m].
///
/// The answer `true` is certain: where one of the points is closer to a wall than `radius`, the disc shrinks to that distance, and
/// the grid favors openings. The answer is `false` where a point lies on a wall, and for a map beyond 30 million cells.
pub(super) fn are_separated(walls: &[Wall<f64>], points: [Point<Map, f64>; 2], radius: f64) -> bool {
    let distances = points.iter().flat_map(|point| walls.iter().map(|wall| wall.distance(*point)));
    let Some(nearest) = distances.reduce(f64::min) else { return false };
    // The center of a cell is up to 0.71 cells away from a point in it: with this radius, the cells along a free path are free.
    // A step between neighbors that crosses a wall has an end within half a cell of it, so walls are tight from there on.
    let cell = (nearest / 1.3).clamp(MIN_CELL, MAX_CELL);
    let radius = (radius.min(nearest) - 0.71 * cell).max(0.5 * cell);
    if nearest < radius + 0.71 * cell {
        return false;
    }
    let Some(mut grid) = Grid::around(walls, points, cell, radius) else { return false };
    for wall in walls {
        grid.block(wall, radius);
    }
    let [from, to] = points.map(|point| grid.index_of(point));
    !grid.connects(from, to)
}

/// Cells row by row from the lower left; those closer to a wall than the radius are blocked.
struct Grid {
    origin: Point<Map, f64>,
    cell: f64,
    columns: usize,
    rows: usize,
    blocked: Vec<bool>,
}

impl Grid {
    /// Free grid over walls and points, with a free border around them; `None` if it would be too large.
    fn around(walls: &[Wall<f64>], points: [Point<Map, f64>; 2], cell: f64, radius: f64) -> Option<Self> {
        let all = || walls.iter().flat_map(Wall::ends).chain(points);
        let border = radius + 2.0 * cell;
        let reach = |axis: fn(Point<Map, f64>) -> f64| {
            let (low, high) = all()
                .map(axis)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
            (low - border, ((high - low + 2.0 * border) / cell).ceil() + 1.0)
        };
        let ((left, columns), (bottom, rows)) = (reach(|point| point.x), reach(|point| point.y));
        let cells: f64 = columns * rows;
        if cells.is_nan() || cells > MAX_CELLS {
            return None;
        }
        let (columns, rows) = (columns as usize, rows as usize);
        let blocked = vec![false; columns * rows];
        Some(Self { origin: Point::new(left, bottom), cell, columns, rows, blocked })
    }

    fn center(&self, column: usize, row: usize) -> Point<Map, f64> {
        let at = |low: f64, index: usize| low + (index as f64 + 0.5) * self.cell;
        Point::new(at(self.origin.x, column), at(self.origin.y, row))
    }

    /// Column and row of a point, limited to the grid.
    fn cell_of(&self, point: Point<Map, f64>) -> (usize, usize) {
        let index = |from: f64, at: f64, count: usize| (((at - from) / self.cell) as usize).min(count - 1);
        (index(self.origin.x, point.x, self.columns), index(self.origin.y, point.y, self.rows))
    }

    fn index_of(&self, point: Point<Map, f64>) -> usize {
        let (column, row) = self.cell_of(point);
        row * self.columns + column
    }

    /// Blocks the cells whose centers are closer to `wall` than `radius`.
    fn block(&mut self, wall: &Wall<f64>, radius: f64) {
        let [a, b] = wall.ends();
        let low = self.cell_of(Point::new(a.x.min(b.x) - radius, a.y.min(b.y) - radius));
        let high = self.cell_of(Point::new(a.x.max(b.x) + radius, a.y.max(b.y) + radius));
        for row in low.1..=high.1 {
            for column in low.0..=high.0 {
                if wall.distance(self.center(column, row)) < radius {
                    self.blocked[row * self.columns + column] = true;
                }
            }
        }
    }

    /// Whether free cells that share a side lead from one cell to the other. Blocks the cells that it visits.
    fn connects(&mut self, from: usize, to: usize) -> bool {
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            if at == to {
                return true;
            }
            let column = at % self.columns;
            let neighbors = [
                (column > 0).then(|| at - 1),
                (column + 1 < self.columns).then(|| at + 1),
                at.checked_sub(self.columns),
                Some(at + self.columns).filter(|next| *next < self.blocked.len()),
            ];
            for next in neighbors.into_iter().flatten() {
                if !std::mem::replace(&mut self.blocked[next], true) {
                    open.push(next);
                }
            }
        }
        false
    }
}
