//! Walls from an occupancy grid.

use surepose::geometry::Point;
use surepose_io::grid::Grid;
use surepose_io::wall_map::WallMap;

use super::fit_walls::{WallFitSettings, fit_walls};
use super::point_cloud::{PointCloud, SurfacePoint};
use super::{MapReport, MappingResult};

/// A cell is solid above this probability, and free below one minus this.
const SOLID: f32 = 0.65;

/// What makes cells a wall, in cells.
///
/// The middles of the cells of a straight wall lie within half a diagonal of its line, 0.71, wherever it runs.
const RULES: WallFitSettings =
    WallFitSettings { tolerance: 0.9, gap: 3.5, shortest: 2.0, fewest: 3, alignment: 0.7 };

/// Side of the boxes in which cells are looked for, and the reach of their normals, in cells.
const REACH: f64 = 3.0;

/// The walls of a grid: straight lines through the middles of the solid cells that border free ones.
///
/// Scans mark the cell that a wall's surface lies in, so its middle is where the surface is, on average over a wall that
/// does not run along the grid. A wall of two cells or more has a face towards each free side; a thinner one is one
/// wall, seen from both. What no free cell borders, nobody sees: it is no wall.
pub fn extract_walls(grid: &Grid) -> MappingResult {
    let mut points = Vec::new();
    let mut free_side = Vec::new();
    for row in 0..grid.height {
        for column in 0..grid.width {
            if let Some(surface) = surface(grid, column, row) {
                let (x, y) = (column as f64, row as f64);
                points.push(SurfacePoint {
                    x,
                    y,
                    normal: (0.0, 0.0),
                    both_sides: surface.both_sides,
                    roughness: f64::INFINITY,
                    view: points.len() as u32,
                });
                free_side.push((x + surface.towards_free.0, y + surface.towards_free.1));
            }
        }
    }
    let mut cloud = PointCloud::new(points, REACH);
    cloud.estimate_normals(&free_side, REACH, 2);
    let grown = fit_walls(&cloud, &RULES);
    let to_map_wall = grown.iter().map(|wall| {
        // The first and the last cell reach half a side beyond their middles.
        let extent = (wall.extent.0 - 0.5, wall.extent.1 + 0.5);
        // The surface lies somewhere in its cells, and at either end of the wall somewhere else.
        let of_cell = grid.resolution * grid.resolution / 12.0;
        let half = 0.5 * (extent.1 - extent.0) * grid.resolution;
        let line_covariance = [0.5 * of_cell, 0.0, 0.5 * of_cell / (half * half)];
        wall.to_map_wall(extent, |[x, y]| place(grid, x, y), line_covariance)
    });
    let map = WallMap { name: None, walls: to_map_wall.collect() };
    let mut report = MapReport::from_fit(&map, &grown, cloud.points().len());
    report.residual_rms_m = report.residual_rms_m.map(|cells| cells * grid.resolution);
    MappingResult { map, report }
}

/// Whether a cell of this occupancy stops a beam.
pub fn is_solid(occupancy: Option<f32>) -> bool {
    occupancy.is_some_and(|p| p > SOLID)
}

/// Whether a beam passes through a cell of this occupancy. What is unknown is neither.
pub fn is_free(occupancy: Option<f32>) -> bool {
    occupancy.is_some_and(|p| p < 1.0 - SOLID)
}

/// What a solid cell shows.
struct Surface {
    /// The sum of the directions to the free cells around it.
    towards_free: (f64, f64),
    both_sides: bool,
}

/// What the cell shows, if it is solid and borders a free one.
fn surface(grid: &Grid, column: usize, row: usize) -> Option<Surface> {
    if !is_solid(grid.occupancy(column, row)) {
        return None;
    }
    let free = |dx: i32, dy: i32| {
        let at = column.checked_add_signed(dx as isize).zip(row.checked_add_signed(dy as isize));
        is_free(at.and_then(|(column, row)| grid.occupancy(column, row)))
    };
    if ![(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|&(dx, dy)| free(dx, dy)) {
        return None;
    }
    let mut towards_free = (0.0, 0.0);
    for dy in -2..=2 {
        for dx in -2..=2 {
            if (dx, dy) != (0, 0) && free(dx, dy) {
                towards_free = (towards_free.0 + f64::from(dx), towards_free.1 + f64::from(dy));
            }
        }
    }
    let both_sides = (free(1, 0) && free(-1, 0)) || (free(0, 1) && free(0, -1));
    Some(Surface { towards_free, both_sides })
}

/// A place in units of cells, from the middle of cell (0, 0), on the map \[m].
fn place(grid: &Grid, x: f64, y: f64) -> [f64; 2] {
    let at = grid.map_from_cells() * Point::new((x + 0.5) * grid.resolution, (y + 0.5) * grid.resolution);
    [at.x, at.y]
}
