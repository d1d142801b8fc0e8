//! Faces of fitted walls: position of the surface, ends and covariance.

use surepose_io::grid::{Grid, is_solid};

use super::super::fit_walls::{FittedWall, fitted};
use super::super::point_cloud::PointCloud;
use super::raster_error::{RasterError, raster_error};
use super::surface::{MAX_THIN, Run};

/// Thickness from which the two sides of a wall are separate faces, in cells along a column.
const TWO_FACES: f64 = 1.0;

/// Distance over which an end of a thin wall continues through solid cells, into another wall at a corner, in cells.
const MAX_EXTENSION: f64 = 2.0;

/// That distance for the face of a solid, in cells: the cells at a corner have no clear normal, and behind them is no surface.
const MAX_EXTENSION_IN_SOLID: f64 = 0.5;

/// One face of a wall, in cells.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// Its line; the members are those of the wall.
    pub line: FittedWall,
    /// Variances of the fit.
    error: RasterError,
    /// Standard deviation of the surface's place in its cells, which is unknown, along a column.
    bias_std: f64,
}

impl Face {
    /// Covariance of the line's offset \[m] and slope, for cells of this `resolution` \[m]; see
    /// [`FittedWall::to_map_wall`].
    pub(super) fn line_covariance(&self, resolution: f64) -> [f64; 3] {
        let cosine = cosine(self.line.normal);
        let columns = (self.line.extent.1 - self.line.extent.0) * cosine;
        let across = resolution * cosine;
        let offset = across * across * (self.error.offset_variance + self.bias_std * self.bias_std);
        let slope = cosine * cosine / columns;
        [offset, 0.0, slope * slope * self.error.rise_variance]
    }
}

/// Returns the faces of a fitted wall: two for a wall with free space on both sides that is thicker than its cells'
/// errors, otherwise one.
pub(super) fn faces(grid: &Grid, cloud: &PointCloud, runs: &[Run], wall: &FittedWall) -> Vec<Face> {
    let run_of = |member: &u32| runs.get(*member as usize);
    let is_thin = |run: &Run| run.thickness <= MAX_THIN;
    let thin_members = wall.members.iter().filter_map(run_of).filter(|run| is_thin(run)).count();
    let thin = 2 * thin_members >= wall.members.len();
    let of_class: Vec<u32> = wall
        .members
        .iter()
        .copied()
        .filter(|member| run_of(member).is_some_and(|run| is_thin(run) == thin))
        .collect();
    let members = if of_class.len() < 3 { wall.members.clone() } else { of_class };
    let line = fitted(cloud, members, wall.normal);
    let (cosine, slope) = (cosine(line.normal), slope(line.normal));
    let count = line.members.len() as f64;
    let extent = extent(cloud, &line, &wall.members);
    let columns = (extent.1 - extent.0) * cosine;
    let mean_square = line.residual_sum_of_squares / count / (cosine * cosine);
    let error = raster_error(slope, columns.max(1.0), mean_square);
    // Distance from the middle of the run to the surface on the free side, and its uncertainty, along a column. The cells
    // at the surface of a solid contain it, or have their centers in the solid.
    let inset = 0.25 * (1.0 + slope);
    let runs = || line.members.iter().filter_map(run_of);
    // A thin surface at this slope occupies 1 + slope cells per column.
    let mean_thickness = runs().map(|run| f64::from(run.thickness)).sum::<f64>() / count;
    let excess = (mean_thickness - 1.0 - slope).max(0.0);
    let both_sides = 2 * runs().filter(|run| run.both_sides).count() >= line.members.len();
    let out = 0.5 * excess + inset;
    let sides: &[(f64, f64, f64)] = match () {
        () if !thin => &[(1.0, 0.5 - inset, inset)],
        () if both_sides && excess >= TWO_FACES => &[(1.0, out, inset), (-1.0, out, inset)],
        () => &[(1.0, 0.0, 0.5 * excess)],
    };
    let face = |&(side, out, bias_std): &(f64, f64, f64)| {
        let mut face = line.clone();
        face.extent = extent;
        let longest = if thin { MAX_EXTENSION } else { MAX_EXTENSION_IN_SOLID };
        let extension = [-1.0, 1.0].map(|way| extension(grid, &face, way, longest));
        face.extent = (face.extent.0 - extension[0], face.extent.1 + extension[1]);
        if side < 0.0 {
            face.normal = (-face.normal.0, -face.normal.1);
            face.extent = (-face.extent.1, -face.extent.0);
        }
        let shift = out * cosine;
        face.middle = (face.middle.0 + shift * face.normal.0, face.middle.1 + shift * face.normal.1);
        Face { line: face, error, bias_std }
    };
    sides.iter().map(face).collect()
}

/// Extent of the wall over the cells of all `members`.
fn extent(cloud: &PointCloud, line: &FittedWall, members: &[u32]) -> (f64, f64) {
    let points = members.iter().filter_map(|&member| cloud.points().get(member as usize));
    let along = points.map(|point| line.along(point.x, point.y));
    let (low, high) = along.fold(line.extent, |(low, high), at| (at.min(low), at.max(high)));
    let half_cell = 0.5 / cosine(line.normal);
    (low - half_cell, high + half_cell)
}

/// Step of the search for the end of a wall, in cells.
const STEP: f64 = 0.25;

/// Length over which the wall continues through solid cells beyond its end, in cells.
fn extension(grid: &Grid, line: &FittedWall, way: f64, longest: f64) -> f64 {
    let end = if way < 0.0 { line.extent.0 } else { line.extent.1 };
    let solid = |length: f64| {
        let along = end + way * length;
        let at = |middle: f64, direction: f64| (middle + along * direction).round();
        let (column, row) = (at(line.middle.0, -line.normal.1), at(line.middle.1, line.normal.0));
        column >= 0.0 && row >= 0.0 && is_solid(grid.occupancy(column as usize, row as usize))
    };
    let steps = (1..=(longest / STEP) as u32).take_while(|&n| solid(f64::from(n) * STEP)).count();
    steps as f64 * STEP
}

/// Cosine of the angle between the wall and the nearer axis of the grid, 1/√2 to 1.
fn cosine(normal: (f64, f64)) -> f64 {
    normal.0.abs().max(normal.1.abs())
}

/// Slope of the wall against the nearer axis of the grid, 0 to 1.
fn slope(normal: (f64, f64)) -> f64 {
    let (x, y) = (normal.0.abs(), normal.1.abs());
    x.min(y) / x.max(y)
}
