//! Extraction of walls from an occupancy grid.

mod face;
mod raster_error;
mod surface;

use surepose::geometry::Point;
use surepose_io::grid::Grid;
use surepose_io::wall_map::WallMap;

use super::fit_walls::{WallFitSettings, fit_walls};
use super::{MapReport, MappingResult};
use face::{Face, faces};
use surface::surface_points;

/// Thresholds of the wall fit, in cells.
///
/// The middle of a run of cells lies within half a cell of the wall. Where a wall enters the next row, a line along the
/// previous rows is up to a cell off.
const RULES: WallFitSettings = WallFitSettings {
    tolerance: 0.9,
    growth_tolerance: 1.4,
    claim: 0.8,
    recess: 0.55,
    gap: 3.5,
    shortest: 2.0,
    long: 16.0,
    fewest: 3,
    alignment: 0.7,
};

/// Extracts the walls of a grid with their covariances.
///
/// A scan marks the cells that contain the wall's surface. A wall of up to three cells is the line through their middles,
/// visible from both sides if both are free. The free sides of a thicker wall are one wall each. Solid cells without a
/// free neighbor are ignored.
pub fn extract_walls(grid: &Grid) -> MappingResult {
    let (runs, cloud) = surface_points(grid);
    let fitted = fit_walls(&cloud, &RULES);
    let faces: Vec<Face> = fitted.iter().flat_map(|wall| faces(grid, &cloud, &runs, wall)).collect();
    let to_map_wall = faces.iter().map(|face| {
        face.line.to_map_wall(
            face.line.extent,
            |[x, y]| place(grid, x, y),
            face.line_covariance(grid.resolution),
        )
    });
    let map = WallMap { name: None, walls: to_map_wall.collect() };
    let mut report = MapReport::from_fit(&map, &fitted, cloud.points().len());
    report.residual_rms_m = report.residual_rms_m.map(|cells| cells * grid.resolution);
    MappingResult { map, report }
}

/// Converts a position in cells, relative to the center of cell (0, 0), to the map \[m].
fn place(grid: &Grid, x: f64, y: f64) -> [f64; 2] {
    let at = grid.map_from_cells() * Point::new((x + 0.5) * grid.resolution, (y + 0.5) * grid.resolution);
    [at.x, at.y]
}
