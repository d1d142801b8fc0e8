//! Surface points with a spatial index.

use std::collections::HashMap;

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// x \[m].
    pub x: f64,
    /// y \[m].
    pub y: f64,
    /// Unit normal of the surface, towards free space; 0 if the neighbors do not determine it.
    pub normal: (f64, f64),
    /// Whether there is free space on both sides.
    pub both_sides: bool,
    /// Priority as a seed of a wall; the smallest value comes first.
    pub roughness: f64,
    /// Index of the view that the point comes from.
    pub view: u32,
}

/// Points indexed by square cells.
#[derive(Clone, Debug)]
pub struct PointCloud {
    points: Vec<SurfacePoint>,
    cells: HashMap<(i32, i32), Vec<u32>>,
    side: f64,
}

impl PointCloud {
    /// Indexes `points` by cells of this `side` \[m].
    pub fn new(points: Vec<SurfacePoint>, side: f64) -> Self {
        let mut cells: HashMap<_, Vec<u32>> = HashMap::new();
        for (number, point) in (0_u32..).zip(&points) {
            cells.entry(cell(point.x, point.y, side)).or_default().push(number);
        }
        Self { points, cells, side }
    }

    /// Returns the points.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// Returns the side of the cells \[m].
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Iterates over the points in the cell of (`x`, `y`) and its eight neighbors, with their indices.
    pub fn around(&self, x: f64, y: f64) -> impl Iterator<Item = (u32, &SurfacePoint)> {
        let (column, row) = cell(x, y, self.side);
        let near = (-1..=1).flat_map(move |j| (-1..=1).map(move |i| (column + i, row + j)));
        near.filter_map(|key| self.cells.get(&key))
            .flatten()
            .filter_map(|&number| Some((number, self.points.get(number as usize)?)))
    }

    /// Estimates normal and roughness of each point from the points within `reach` \[m], at most the cell
    /// side. Points whose present normals are opposite do not count for each other. Normals point to the
    /// viewpoint in `seen_from`; a point with fewer than `fewest` neighbors gets none.
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
            let facing = point.normal.0 * other.normal.0 + point.normal.1 * other.normal.1;
            if dx * dx + dy * dy <= reach * reach && facing >= 0.0 {
                scatter.add(dx, dy);
            }
        }
        if scatter.count <= f64::from(fewest) {
            return None;
        }
        let line = scatter.line();
        // The standard error of the line's position: flat surfaces with many points come first.
        Some((line.normal, libm::sqrt(line.across) + reach / scatter.count))
    }
}

/// Moments of points for a total least-squares line.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointMoments {
    /// Number of points.
    pub count: f64,
    sum: (f64, f64),
    xx: f64,
    xy: f64,
    yy: f64,
}

/// Line of total least squares.
#[derive(Clone, Copy, Debug)]
pub struct LeastSquaresLine {
    /// Centroid of the points.
    pub middle: (f64, f64),
    /// Unit normal.
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

    /// Returns the line through the points, along the larger principal axis of their scatter.
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
