//! Reads map files: wall maps, and occupancy grids from which walls are extracted.

use std::path::Path;

use surepose_config::ScanMethod;
use surepose_io::grid::Grid;
use surepose_io::wall_map::{self, WallMap};
use surepose_io::{DataError, map_server};
use surepose_mapping::{MappingResult, from_grid};

use crate::output::warning;

/// The content of a map file.
pub(crate) enum MapFile {
    Walls(WallMap),
    Grid(Grid),
}

/// Reads a map file; its extension selects the format: `.toml`, `.yaml`, or any other for the grid of Wean Hall.
///
/// A final `.gz` is ignored for this choice.
pub(crate) fn read_map_file(path: &Path) -> Result<MapFile, DataError> {
    let ends_in = |path: &Path, extension: &str| {
        path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
    };
    let name = if ends_in(path, "gz") { &path.with_extension("") } else { path };
    let is = |extension: &str| ends_in(name, extension);
    Ok(if is("toml") {
        MapFile::Walls(wall_map::read(path)?)
    } else if is("yaml") || is("yml") {
        MapFile::Grid(grid_in(path)?)
    } else {
        MapFile::Grid(surepose_io::cmu_wean::read_grid(path)?)
    })
}

/// Smallest fraction of the surface cells that lie on a straight wall; below it, the cells are probably not of walls.
const MIN_EXPLAINED: f64 = 0.5;

/// The parts of a YAML file that decide which cells are occupied.
const REMEDY: &str = "check occupied_thresh, free_thresh, negate and mode in the YAML file";

/// Extracts the walls of a grid; warns if they explain little of it.
pub(crate) fn walls_of(grid: &Grid) -> MappingResult {
    let mapped = from_grid::extract_walls(grid);
    if let Some(explained) = mapped.report.explained.filter(|&explained| explained < MIN_EXPLAINED) {
        let percent = 1e2 * explained;
        warning(&format!("map: only {percent:.0} % of the surface cells are on straight walls; {REMEDY}"));
    }
    mapped
}

/// Reads the grid of a map_server YAML file; warns if its image was renamed, or if its cells are no map.
pub(crate) fn grid_in(path: &Path) -> Result<Grid, DataError> {
    let (grid, renamed) = map_server::read(path)?;
    if let Some(renamed) = renamed {
        warning(&renamed.to_string());
    }
    if let Some(sparse) = grid.sparseness() {
        warning(&format!("map: {sparse}; {REMEDY}"));
    }
    Ok(grid)
}

/// Reads the walls of a map file; walls are extracted from an occupancy grid.
pub(crate) fn walls_in(path: &Path) -> Result<WallMap, DataError> {
    walls_to_read(path).map(|(map, _)| map)
}

/// Like [`walls_in`], with the scan method: the short walls of an occupancy grid need beam matching.
pub(crate) fn walls_to_read(path: &Path) -> Result<(WallMap, ScanMethod), DataError> {
    Ok(match read_map_file(path)? {
        MapFile::Walls(map) => (map, ScanMethod::Lines),
        MapFile::Grid(grid) => (walls_of(&grid).map, ScanMethod::Beams),
    })
}
