//! Memory for a map: the walls and the cells of their distance field.

mod goal_check;
mod regions;

use surepose::map::{DistanceField, GridSpec, MapView, Wall};

use crate::wall_map::{WallMap, walls_from_map};

pub use goal_check::GoalProblem;

/// Side of a cell \[m].
const CELL_SIZE: f64 = 0.1;

/// The largest number of cells, which cover a square kilometer. A larger map has no distance field.
const MAX_CELLS: usize = 100_000_000;

/// Walls and distance field, from which [`OwnedMap::view`] makes the map of a step.
#[derive(Clone, Debug)]
pub struct OwnedMap {
    walls: Vec<Wall<f64>>,
    grid: GridSpec<f64>,
    cells: Vec<u8>,
}

impl OwnedMap {
    /// Map with these walls; an empty list is no map.
    pub fn from_walls(walls: Vec<Wall<f64>>) -> Self {
        let grid = GridSpec::from_walls(&walls, CELL_SIZE);
        let mut cells = Vec::new();
        if grid.cell_count() <= MAX_CELLS {
            cells.resize(grid.cell_count(), 0);
            grid.rasterize(&walls, &mut cells, |_| true);
        }
        Self { walls, grid, cells }
    }

    /// Map with the walls of a file.
    pub fn from_wall_map(map: &WallMap) -> Self {
        Self::from_walls(walls_from_map(map))
    }

    /// The walls.
    pub fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// The map as a step sees it.
    pub fn view(&self) -> MapView<'_, f64> {
        let field = DistanceField::from_cells(self.grid, &self.cells);
        let distance_field = field.filter(|_| !self.cells.is_empty());
        MapView { walls: &self.walls, distance_field }
    }
}
