//! Maps that the user names: wall maps, and occupancy grids to trace the walls of.

use std::path::Path;

use surepose_config::ScanMethod;
use surepose_io::grid::Grid;
use surepose_io::wall_map::{self, WallMap};
use surepose_io::{DataError, map_server};
use surepose_mapping::from_grid;

use crate::output::warning;

/// What a map file holds.
pub(crate) enum MapFile {
    Walls(WallMap),
    Grid(Grid),
}

/// A map file, which its name tells the kind of, compressed or not: `.toml`, `.yaml`, or Wean Hall's own.
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

/// The grid that a YAML file describes; says so where its image is not the one that the file names.
pub(crate) fn grid_in(path: &Path) -> Result<Grid, DataError> {
    let (grid, renamed) = map_server::read(path)?;
    if let Some(renamed) = renamed {
        warning(&renamed.to_string());
    }
    Ok(grid)
}

/// The walls of a map file: a wall map as it is, an occupancy grid turned into walls.
pub(crate) fn walls_in(path: &Path) -> Result<WallMap, DataError> {
    walls_to_read(path).map(|(map, _)| map)
}

/// The same, and how scans are laid on them: walls that a grid was traced for are short.
pub(crate) fn walls_to_read(path: &Path) -> Result<(WallMap, ScanMethod), DataError> {
    Ok(match read_map_file(path)? {
        MapFile::Walls(map) => (map, ScanMethod::Lines),
        MapFile::Grid(grid) => (from_grid::extract_walls(&grid).map, ScanMethod::Beams),
    })
}
