//! Storage of a distance field of a map, see [`DistanceField`].

use surepose::{DistanceField, GridSpec, Wall};

/// Side of a cell \[m].
const CELL_SIDE: f64 = 0.1;

/// Maximum number of cells: 1 km². Larger maps have no field.
const MAX_CELLS: usize = 100_000_000;

/// Distances to the nearest wall for the cells of a map.
#[derive(Clone, Debug)]
pub struct OwnedDistanceField {
    grid: GridSpec<f64>,
    cells: Vec<u8>,
}

impl OwnedDistanceField {
    /// Computes the distance field of a map with these walls.
    pub fn from_walls(walls: &[Wall<f64>]) -> Self {
        let grid = GridSpec::from_walls(walls, CELL_SIDE);
        let mut cells = Vec::new();
        if grid.cell_count() <= MAX_CELLS {
            cells.resize(grid.cell_count(), 0);
            grid.rasterize(walls, &mut cells, |_| true);
        }
        Self { grid, cells }
    }

    /// Returns the field; `None` if the map has no walls or is too large.
    pub fn field(&self) -> Option<DistanceField<'_, f64>> {
        DistanceField::from_cells(self.grid, &self.cells).filter(|_| !self.cells.is_empty())
    }
}
