//! Points on the surfaces of a grid: one per column of cells across a wall.
//!
//! A wall crosses the columns of the grid (its rows, if it is steeper than 45°). In each column it occupies a run of cells.
//! A mapper marks the cells that contain the surface, so the middle of a short run is on the surface on average, at any
//! angle. A long run is the inside of a solid, whose surface is near the free end of the run.

use std::collections::BTreeMap;

use surepose_io::grid::{Grid, is_free, is_solid};

use super::super::point_cloud::{PointCloud, SurfacePoint};

/// Longest run of cells that is a thin surface; a longer one is the inside of a solid.
pub(super) const MAX_THIN: i32 = 3;

/// Radius of the normal estimation, and side of the search cells, in grid cells.
pub(super) const REACH: f64 = 3.0;

/// Cells of one wall in one column of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    /// Middle of a thin run, or of the cell at the free end of a thick one, in cells.
    pub at: (f64, f64),
    /// Direction along the run towards free space.
    pub towards_free: (f64, f64),
    /// Number of cells; one more than [`MAX_THIN`] for any longer run.
    pub thickness: i32,
    /// Whether there is free space at both ends.
    pub both_sides: bool,
}

/// Returns the runs of the grid, and a cloud with a point for each.
pub(super) fn surface_points(grid: &Grid) -> (Vec<Run>, PointCloud) {
    let cells = border_cells(grid);
    let cloud = cloud_of(cells.iter().map(|cell| (cell.at, cell.towards_free, false)));
    let mut runs = BTreeMap::new();
    for (cell, point) in cells.iter().zip(cloud.points()) {
        // Without a normal, the cell has few neighbors; the free cells around it give the direction.
        let out = if point.normal == (0.0, 0.0) { cell.towards_free } else { point.normal };
        let axis = if out.0.abs() > out.1.abs() { (1, 0) } else { (0, 1) };
        if let Some((key, run)) = run(grid, cell, axis, out) {
            runs.insert(key, run);
        }
    }
    let runs: Vec<Run> = runs.into_values().collect();
    let cloud = cloud_of(runs.iter().map(|run| (run.at, run.towards_free, run.both_sides)));
    (runs, cloud)
}

/// Builds a cloud of points with their directions to free space, and estimates the normals.
fn cloud_of(points: impl Iterator<Item = ((f64, f64), (f64, f64), bool)>) -> PointCloud {
    let mut seen_from = Vec::new();
    let to_point = |((x, y), towards_free, both_sides): ((f64, f64), (f64, f64), bool)| {
        let view = seen_from.len() as u32;
        seen_from.push((x + towards_free.0, y + towards_free.1));
        // The two faces of a thin partition do not disturb each other's normals.
        let normal = if both_sides { (0.0, 0.0) } else { towards_free };
        SurfacePoint { x, y, normal, both_sides, roughness: f64::INFINITY, view }
    };
    let points = points.map(to_point).collect();
    let mut cloud = PointCloud::new(points, REACH);
    cloud.estimate_normals(&seen_from, REACH, 2);
    cloud
}

/// A solid cell that borders a free one.
struct BorderCell {
    at: (f64, f64),
    column: usize,
    row: usize,
    /// Sum of the directions to the free cells nearby.
    towards_free: (f64, f64),
}

fn border_cells(grid: &Grid) -> Vec<BorderCell> {
    let mut cells = Vec::new();
    for row in 0..grid.height {
        for column in 0..grid.width {
            if !is_solid(grid.occupancy(column, row)) {
                continue;
            }
            let free = |dx: i32, dy: i32| is_free(neighbor(grid, column, row, dx, dy));
            if ![(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|&(dx, dy)| free(dx, dy)) {
                continue;
            }
            let mut towards_free = (0.0, 0.0);
            for (dx, dy) in (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy))) {
                if free(dx, dy) {
                    towards_free = (towards_free.0 + f64::from(dx), towards_free.1 + f64::from(dy));
                }
            }
            cells.push(BorderCell { at: (column as f64, row as f64), column, row, towards_free });
        }
    }
    cells
}

/// Occupancy of the cell at an offset; `None` if it is unknown or outside the grid.
fn neighbor(grid: &Grid, column: usize, row: usize, dx: i32, dy: i32) -> Option<f32> {
    let (column, row) = (column.checked_add_signed(dx as isize)?, row.checked_add_signed(dy as isize)?);
    grid.occupancy(column, row)
}

/// Identifies a run: its first cell and its axis, and for a thick run also its free end.
type RunKey = (usize, usize, bool, bool);

/// Returns the run of solid cells through a border cell along an `axis`; `None` if neither of its ends is free.
///
/// `out` is the direction to free space.
fn run(grid: &Grid, cell: &BorderCell, axis: (i32, i32), out: (f64, f64)) -> Option<(RunKey, Run)> {
    let at = |steps: i32| neighbor(grid, cell.column, cell.row, steps * axis.0, steps * axis.1);
    let reach = MAX_THIN + 1;
    let extent = |way: i32| (1..=reach).take_while(|&n| is_solid(at(way * n))).last().unwrap_or(0);
    let (below, above) = (extent(-1), extent(1));
    let (free_below, free_above) = (is_free(at(-below - 1)), is_free(at(above + 1)));
    let thickness = below + above + 1;
    let upwards = out.0 * f64::from(axis.0) + out.1 * f64::from(axis.1) > 0.0;
    // The free end that the normal points to, or else the only free end.
    let upwards = if upwards { free_above || !free_below } else { !free_below && free_above };
    if !(free_below || free_above) {
        return None;
    }
    let is_thin = thickness <= MAX_THIN;
    let steps = if is_thin {
        0.5 * f64::from(above - below)
    } else if upwards {
        f64::from(above)
    } else {
        f64::from(-below)
    };
    let start = |along: usize, of_axis: i32| along.saturating_sub((below * of_axis) as usize);
    let key = (start(cell.column, axis.0), start(cell.row, axis.1), axis.0 == 1, !is_thin && upwards);
    let way = if upwards { 1.0 } else { -1.0 };
    let axis = (f64::from(axis.0), f64::from(axis.1));
    let run = Run {
        at: (cell.at.0 + steps * axis.0, cell.at.1 + steps * axis.1),
        towards_free: (way * axis.0, way * axis.1),
        thickness: thickness.min(MAX_THIN + 1),
        both_sides: is_thin && free_below && free_above,
    };
    Some((key, run))
}
