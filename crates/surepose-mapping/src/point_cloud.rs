//! Points on surfaces, found again by where they are.

use std::collections::HashMap;

/// A point where something solid begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position \[m].
    pub x: f64,
    /// Position \[m].
    pub y: f64,
    /// Unit normal of the surface, towards free space; 0 where the neighbours do not tell.
    pub normal: (f64, f64),
    /// Whether there is free space on both sides.
    pub both_sides: bool,
    /// How good a wall may start here, smallest first.
    pub roughness: f64,
    /// From which of the views the point comes.
    pub view: u32,
}

/// Points in square cells.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Vec<SurfacePoint>,
    cells: HashMap<(i32, i32), Vec<u32>>,
    side: f64,
}

impl PointCloud {
    /// `points` in cells of this `side` \[m].
    pub fn new(points: Vec<SurfacePoint>, side: f64) -> Self {
        let mut cells: HashMap<_, Vec<u32>> = HashMap::new();
        for (number, point) in (0_u32..).zip(&points) {
            cells.entry(cell(point.x, point.y, side)).or_default().push(number);
        }
        Self { points, cells, side }
    }

    /// The points.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// Side of the cells \[m].
    pub fn side(&self) -> f64 {
        self.side
    }

    /// The points in the cell of (`x`, `y`) and in the eight around it, by number.
    pub fn around(&self, x: f64, y: f64) -> impl Iterator<Item = (u32, &SurfacePoint)> {
        let (column, row) = cell(x, y, self.side);
        let near = (-1..=1).flat_map(move |j| (-1..=1).map(move |i| (column + i, row + j)));
        near.filter_map(|key| self.cells.get(&key))
            .flatten()
            .filter_map(|&number| Some((number, self.points.get(number as usize)?)))
    }

    /// Gives each point the normal of the points within `reach` \[m], at most the side of a cell, turned towards where
    /// the point was seen from, and its roughness. A point with fewer than `fewest` others around it gets none.
    pub fn estimate_normals(&mut self, seen_from: &[(f64, f64)], reach: f64, fewest: u32) {
        let normals: Vec<_> = self
            .points
            .iter()
            .map(|point| {
                let (normal, roughness) = self.normal_at(point, reach, fewest)?;
                let (x, y) = *seen_from.get(point.view as usize)?;
                let towards = normal.0 * (x - point.x) + normal.1 * (y - point.y);
                let side = if towards < 0.0 { -1.0 } else { 1.0 };
                Some(((side * normal.0, side * normal.1), roughness))
            })
            .collect();
        for (point, normal) in self.points.iter_mut().zip(normals) {
            (point.normal, point.roughness) = normal.unwrap_or(((0.0, 0.0), f64::INFINITY));
        }
    }

    fn normal_at(&self, point: &SurfacePoint, reach: f64, fewest: u32) -> Option<((f64, f64), f64)> {
        let mut scatter = PointMoments::default();
        for (_, other) in self.around(point.x, point.y) {
            let (dx, dy) = (other.x - point.x, other.y - point.y);
            if dx * dx + dy * dy <= reach * reach {
                scatter.add(dx, dy);
            }
        }
        if scatter.count <= f64::from(fewest) {
            return None;
        }
        let line = scatter.line();
        // The standard error of the line's place: flat and well seen comes first.
        Some((line.normal, libm::sqrt(line.across) + reach / scatter.count))
    }
}

/// Sums over points, from which the line of least perpendicular squares follows.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointMoments {
    /// How many points.
    pub count: f64,
    sum: (f64, f64),
    xx: f64,
    xy: f64,
    yy: f64,
}

/// The line of least perpendicular squares.
#[derive(Clone, Copy, Debug)]
pub struct LeastSquaresLine {
    /// The middle of the points.
    pub middle: (f64, f64),
    /// A unit normal.
    pub normal: (f64, f64),
    /// Mean square distance from the line \[m²].
    pub across: f64,
}

impl PointMoments {
    /// Adds a point.
    pub fn add(&mut self, x: f64, y: f64) {
        self.count += 1.0;
        self.sum = (self.sum.0 + x, self.sum.1 + y);
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// The line through the points: along the larger principal axis of their scatter.
    pub fn line(&self) -> LeastSquaresLine {
        let middle = (self.sum.0 / self.count, self.sum.1 / self.count);
        let xx = self.xx / self.count - middle.0 * middle.0;
        let xy = self.xy / self.count - middle.0 * middle.1;
        let yy = self.yy / self.count - middle.1 * middle.1;
        let along = 0.5 * libm::atan2(2.0 * xy, xx - yy);
        let (sin, cos) = (libm::sin(along), libm::cos(along));
        let across = xx * sin * sin - 2.0 * xy * sin * cos + yy * cos * cos;
        LeastSquaresLine { middle, normal: (-sin, cos), across: across.max(0.0) }
    }
}

fn cell(x: f64, y: f64, side: f64) -> (i32, i32) {
    (libm::floor(x / side) as i32, libm::floor(y / side) as i32)
}
