//! Picture of a wall map over its source data.

use surepose_io::grid::{Grid, is_free, is_solid};
use surepose_io::wall_map::WallMap;
use surepose_mapping::MapReport;

use crate::plot::{Color, Heatmap, HeatmapCell, MapPlot, Picture};

/// Background of a wall map.
#[derive(Clone, Copy, Debug)]
pub enum MapBackground<'a> {
    /// No background.
    Nothing,
    /// An occupancy grid.
    Grid(&'a Grid),
    /// Beam end points of scans \[m].
    Ends(&'a [(f64, f64)]),
}

/// Maximum number of cells per side; more would exceed the pixels.
const MAX_CELLS_PER_SIDE: usize = 1000;
/// Minimum side of a cell of beam end points \[m].
const CELL: f64 = 0.05;
/// Margin around known cells, and around walls \[m].
const MARGIN: usize = 6;
const SPACE: f64 = 0.5;

const SOLID: Color = Color::Black;
const UNKNOWN: Color = Color::Mist;
const SEEN: Color = Color::Grey;

/// Draws the walls of a map over their source data.
pub fn wall_map(map: &WallMap, ground: MapBackground<'_>) -> Picture {
    let MapReport { walls, length_m, .. } = MapReport::from_map(map);
    let figures = format!("{walls} walls, {length_m:.1} m");
    let title = map.name.as_ref().map_or(figures.clone(), |name| format!("{name}: {figures}"));
    let picture = MapPlot::new(title).walls(map.walls.iter().map(|wall| [wall.from.into(), wall.to.into()]));
    let below = match ground {
        MapBackground::Nothing => None,
        MapBackground::Grid(grid) => grid_tiles(grid, map).map(|heatmap| (heatmap, grid_keys())),
        MapBackground::Ends(ends) => {
            end_tiles(ends, map).map(|heatmap| (heatmap, vec![("beam end points".to_owned(), SEEN)]))
        }
    };
    match below {
        Some((heatmap, keys)) => picture.heatmap(heatmap, keys).picture(),
        None => picture.picture(),
    }
}

/// Returns the known part of a grid, with margin, that covers the walls.
fn grid_tiles(grid: &Grid, map: &WallMap) -> Option<Heatmap> {
    let mut bounds = Bounds::from_walls(map, 0.0);
    for row in 0..grid.height {
        // The outermost known cells of a row suffice.
        let known = |column: &usize| grid.occupancy(*column, row).is_some();
        let ends = [(0..grid.width).find(known), (0..grid.width).rev().find(known)];
        ends.into_iter().flatten().for_each(|column| bounds.include(grid.center(column, row)));
    }
    bounds.tiles_of(grid)
}

/// Returns the cells of beam end points around the walls.
fn end_tiles(ends: &[(f64, f64)], map: &WallMap) -> Option<Heatmap> {
    let bounds = Bounds::from_walls(map, SPACE);
    let extent = [bounds.high.0 - bounds.low.0, bounds.high.1 - bounds.low.1];
    if !bounds.any() {
        return None;
    }
    let side = (extent[0].max(extent[1]) / MAX_CELLS_PER_SIDE as f64).max(CELL);
    let [columns, rows] = extent.map(|extent| (extent / side).ceil() as usize);
    let mut cells = vec![HeatmapCell::Nothing; columns * rows];
    for (x, y) in ends {
        let (column, row) = ((x - bounds.low.0) / side, (y - bounds.low.1) / side);
        let inside = column >= 0.0 && row >= 0.0 && (column as usize) < columns;
        let tile = if inside { cells.get_mut(row as usize * columns + column as usize) } else { None };
        if let Some(tile) = tile {
            *tile = HeatmapCell::Plain(SEEN);
        }
    }
    Some(Heatmap { low: bounds.low, side, columns, cells })
}

/// Legend of a grid's colors.
pub(super) fn grid_keys() -> Vec<(String, Color)> {
    vec![("occupied".to_owned(), SOLID), ("unknown".to_owned(), UNKNOWN)]
}

/// Corners of the visible area \[m].
pub(super) struct Bounds {
    low: (f64, f64),
    high: (f64, f64),
}

impl Bounds {
    /// Returns empty bounds.
    pub(super) fn new() -> Self {
        Self { low: (f64::MAX, f64::MAX), high: (f64::MIN, f64::MIN) }
    }

    /// Returns bounds around all walls, with `space` on each side.
    fn from_walls(map: &WallMap, space: f64) -> Self {
        let mut bounds = Self::new();
        for [x, y] in map.walls.iter().flat_map(|wall| [wall.from, wall.to]) {
            bounds.include((x - space, y - space));
            bounds.include((x + space, y + space));
        }
        bounds
    }

    pub(super) fn include(&mut self, (x, y): (f64, f64)) {
        self.low = (self.low.0.min(x), self.low.1.min(y));
        self.high = (self.high.0.max(x), self.high.1.max(y));
    }

    fn any(&self) -> bool {
        self.low.0 <= self.high.0
    }

    /// Returns the cells of a grid within the bounds, with a margin.
    pub(super) fn tiles_of(&self, grid: &Grid) -> Option<Heatmap> {
        let margin = MARGIN as f64 * grid.resolution;
        let extent = [self.high.0 - self.low.0, self.high.1 - self.low.1].map(|side| side + 2.0 * margin);
        // If there are more cells than pixels, several are merged; the most occupied of them counts.
        let merged = (extent[0].max(extent[1]) / grid.resolution / MAX_CELLS_PER_SIDE as f64).ceil().max(1.0);
        let side = merged * grid.resolution;
        // Cells of the picture are aligned with cells of the grid, unless the grid is rotated in the map.
        let aligned = |low: f64, origin: f64| origin + ((low - margin - origin) / side).floor() * side;
        let low = (aligned(self.low.0, grid.origin.x), aligned(self.low.1, grid.origin.y));
        let [columns, rows] = extent.map(|extent| (extent / side).ceil() as usize + 1);
        if !(self.any() && columns <= MAX_CELLS_PER_SIDE + 2 && rows <= MAX_CELLS_PER_SIDE + 2) {
            return None;
        }
        let samples = merged as usize;
        let tile = |k: usize| {
            let (x, y) = (low.0 + (k % columns) as f64 * side, low.1 + (k / columns) as f64 * side);
            let mut tile = HeatmapCell::Plain(UNKNOWN);
            for sample in 0..samples * samples {
                let at = |part: usize| (part as f64 + 0.5) * grid.resolution;
                let cell = grid.cell_at(x + at(sample % samples), y + at(sample / samples));
                let occupancy = cell.and_then(|(column, row)| grid.occupancy(column, row));
                if is_solid(occupancy) {
                    return HeatmapCell::Plain(SOLID);
                }
                if is_free(occupancy) {
                    tile = HeatmapCell::Nothing;
                }
            }
            tile
        };
        Some(Heatmap { low, side, columns, cells: (0..columns * rows).map(tile).collect() })
    }
}

#[cfg(test)]
mod tests {
    use surepose_io::grid::{Grid, GridOrigin};
    use surepose_io::wall_map::WallMap;

    use crate::plot::HeatmapCell;

    use super::{MAX_CELLS_PER_SIDE, SOLID, grid_tiles};

    fn room(side: usize, heading: f64) -> Grid {
        let wall = |k: usize| [k % side, k / side].iter().any(|at| *at == 0 || *at == side - 1);
        let cells = (0..side * side).map(|k| Some(f32::from(u8::from(wall(k))))).collect();
        let origin = GridOrigin { x: -3.0, y: 7.0, heading };
        Grid { width: side, height: side, resolution: 0.1, origin, cells }
    }

    #[test]
    fn each_solid_cell_is_one_tile_at_its_position() {
        let heatmap = grid_tiles(&room(40, 0.0), &WallMap::default()).expect("a room");
        let solid: Vec<usize> = (0..heatmap.cells.len())
            .filter(|k| heatmap.cells.get(*k) == Some(&HeatmapCell::Plain(SOLID)))
            .collect();
        assert_eq!(solid.len(), 4 * 39);
        let first = solid.first().expect("156 solid cells");
        let at = |k: usize, low: f64| low + (k as f64 + 0.5) * heatmap.side;
        let (x, y) = (at(first % heatmap.columns, heatmap.low.0), at(first / heatmap.columns, heatmap.low.1));
        assert!((x + 2.95).abs() < 1e-9 && (y - 7.05).abs() < 1e-9, "{x} {y}");
    }

    #[test]
    fn large_grids_keep_thin_walls_and_rotated_grids_keep_their_position() {
        let heatmap = grid_tiles(&room(2500, 0.0), &WallMap::default()).expect("a room");
        assert!(heatmap.columns <= MAX_CELLS_PER_SIDE + 2 && heatmap.rows() <= MAX_CELLS_PER_SIDE + 2);
        let solid = heatmap.cells.iter().filter(|tile| **tile == HeatmapCell::Plain(SOLID)).count();
        assert!(solid >= 4 * 2499 / 3, "{solid}");
        let turned = grid_tiles(&room(40, 0.5), &WallMap::default()).expect("a room");
        // A square of 4 m, rotated by 0.5 rad, is 4·(cos 0.5 + sin 0.5) m wide.
        let width = turned.columns as f64 * turned.side;
        assert!((width - 4.0 * (0.5_f64.cos() + 0.5_f64.sin()) - 1.2).abs() < 0.35, "{width}");
    }
}
