//! The cells of a distance field of a map, see [`DistanceField`].

use surepose::{DistanceField, GridSpec, Wall};

/// The side of a cell \[m].
const CELL_SIDE: f64 = 0.1;

/// The most cells: a square kilometre. A map that is larger has no field.
const MAX_CELLS: usize = 100_000_000;

/// How far from the walls each place of a map is.
#[derive(Clone, Debug)]
pub struct OwnedDistanceField {
    grid: GridSpec<f64>,
    cells: Vec<u8>,
}

impl OwnedDistanceField {
    /// The distance field of a map with these walls.
    pub fn from_walls(walls: &[Wall<f64>]) -> Self {
        let grid = GridSpec::from_walls(walls, CELL_SIDE);
        let mut cells = Vec::new();
        if grid.cell_count() <= MAX_CELLS {
            cells.resize(grid.cell_count(), 0);
            grid.rasterize(walls, &mut cells, |_| true);
        }
        Self { grid, cells }
    }

    /// The field; `None` where there is no wall, or too large a map.
    pub fn field(&self) -> Option<DistanceField<'_, f64>> {
        DistanceField::from_cells(self.grid, &self.cells).filter(|_| !self.cells.is_empty())
    }
}
