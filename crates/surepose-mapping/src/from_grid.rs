//! Extraction of walls from an occupancy grid.

use surepose::geometry::Point;
use surepose_io::grid::Grid;
use surepose_io::wall_map::WallMap;

use super::fit_walls::{WallFitSettings, fit_walls};
use super::point_cloud::{PointCloud, SurfacePoint};
use super::{MapReport, MappingResult};

/// Occupancy probability above which a cell is solid; below one minus this it is free.
const SOLID: f32 = 0.65;

/// Thresholds of the wall fit, in cells.
///
/// The cell centers of a straight wall lie within half a cell diagonal of its line, 0.71, at any angle.
const RULES: WallFitSettings =
    WallFitSettings { tolerance: 0.9, gap: 3.5, shortest: 2.0, fewest: 3, alignment: 0.7 };

/// Side of the search cells, and radius of the normal estimation, in grid cells.
const REACH: f64 = 3.0;

/// Extracts walls: straight lines through the centers of solid cells that border free ones.
///
/// A scan marks the cell that contains the wall's surface. For walls that are not parallel to the grid, the
/// cell center is on average on the surface. A wall of two cells or more has one face towards each free side;
/// a thinner one becomes one wall, visible from both sides. Solid cells without a free neighbor are ignored.
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
        // The first and the last cell extend half a side beyond their centers.
        let extent = (wall.extent.0 - 0.5, wall.extent.1 + 0.5);
        // The surface lies anywhere in its cells, independently at the two ends of the wall.
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

/// Returns whether a cell of this occupancy stops a beam; unknown cells do not.
pub fn is_solid(occupancy: Option<f32>) -> bool {
    occupancy.is_some_and(|p| p > SOLID)
}

/// Returns whether a beam passes through a cell of this occupancy; unknown cells are neither solid nor free.
pub fn is_free(occupancy: Option<f32>) -> bool {
    occupancy.is_some_and(|p| p < 1.0 - SOLID)
}

/// Surface of a solid cell.
struct Surface {
    /// Sum of the directions to the adjacent free cells.
    towards_free: (f64, f64),
    both_sides: bool,
}

/// Returns the surface of a solid cell that borders a free one; `None` for other cells.
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

/// Converts a position in cells, relative to the center of cell (0, 0), to the map \[m].
fn place(grid: &Grid, x: f64, y: f64) -> [f64; 2] {
    let at = grid.map_from_cells() * Point::new((x + 0.5) * grid.resolution, (y + 0.5) * grid.resolution);
    [at.x, at.y]
}
