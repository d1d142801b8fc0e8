//! Likelihood field of an occupancy grid, [Thrun2005] Sec. 6.4.
//!
//! The path of a beam is ignored. A door that is closed on the map but open today would otherwise reject
//! every beam through it, together with what the beam measures behind it.

use surepose::geometry::{Map, Point, Pose};
use surepose_io::grid::{Cells, Grid};
use surepose_mapping::from_grid::{is_free, is_solid};

/// Probability of an unexpected end point: people, furniture, and doors that differ from the map.
const ANYWHERE: f64 = 0.05;

/// Maximum distance from a wall with a Gaussian likelihood, in standard deviations.
const REACH: f64 = 4.0;

/// Distance field of a grid.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodField {
    width: i32,
    height: i32,
    resolution: f64,
    /// Pose of the grid in the map.
    pub(super) map_from_cells: Pose<Map, Cells, f64>,
    /// Squared distance from each cell to the nearest solid one, in cells; saturated at a large distance.
    squared: Vec<u32>,
    free: Vec<bool>,
}

/// Cell index as column and row; cells outside the grid are neither free nor solid, and far from walls.
pub(super) type CellIndex = (i32, i32);

impl LikelihoodField {
    /// Computes the field of `grid` for standard deviations up to `widest` \[m].
    pub(super) fn from_grid(grid: &Grid, widest: f64) -> Self {
        // The maximum number of cells is `grid::MAX_CELLS`.
        let [width, height] = [grid.width, grid.height].map(|cells| i32::try_from(cells).unwrap_or(i32::MAX));
        let free = grid.cells.iter().map(|cell| is_free(*cell)).collect();
        let mut field = Self {
            width,
            height,
            resolution: grid.resolution,
            map_from_cells: grid.map_from_cells(),
            squared: vec![u32::MAX; grid.cells.len()],
            free,
        };
        let reach = (REACH * widest / grid.resolution).ceil() as i32;
        let solid = |(column, row): CellIndex| {
            let at = usize::try_from(column).ok().zip(usize::try_from(row).ok());
            is_solid(at.and_then(|(column, row)| grid.occupancy(column, row)))
        };
        for cell in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
            if !solid(cell) {
                continue;
            }
            let (x, y) = cell;
            // Cells inside solid areas count as distant: beams end on surfaces only.
            let is_inner = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)].into_iter().all(solid);
            let reach = if is_inner { 0 } else { reach };
            for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
                if let Some(index) = field.index((x + dx, y + dy)) {
                    let squared = (dx * dx + dy * dy).unsigned_abs();
                    field.squared[index] = field.squared[index].min(squared);
                }
            }
        }
        field
    }

    /// Returns the number of cells along x and y.
    pub(super) fn size(&self) -> CellIndex {
        (self.width, self.height)
    }

    /// Returns the side of a cell \[m].
    pub(super) fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Returns the cell that contains a point.
    pub(super) fn cell_at(&self, at: Point<Cells, f64>) -> CellIndex {
        let cell = |x: f64| (x / self.resolution).floor() as i32;
        (cell(at.x), cell(at.y))
    }

    /// Returns the center of a cell.
    pub(super) fn middle(&self, (column, row): CellIndex) -> Point<Cells, f64> {
        let at = |cell: i32| (f64::from(cell) + 0.5) * self.resolution;
        Point::new(at(column), at(row))
    }

    /// Returns whether a cell is known to be free.
    pub(super) fn is_free(&self, cell: CellIndex) -> bool {
        self.index(cell).is_some_and(|index| self.free[index])
    }

    /// Returns whether a cell is in the grid and not solid.
    pub(super) fn is_open(&self, cell: CellIndex) -> bool {
        self.index(cell).is_some_and(|index| self.squared[index] > 0)
    }

    /// Returns whether the center of a cell is within a distance \[m] of that of a solid cell.
    pub(super) fn is_near_wall(&self, cell: CellIndex, within: f64) -> bool {
        let squared = self.index(cell).map_or(u32::MAX, |index| self.squared[index]);
        f64::from(squared) * self.resolution * self.resolution <= within * within
    }

    /// Returns the log likelihood of a beam end in a cell; 0 for a solid one.
    pub(super) fn log_likelihood(&self, law: &LikelihoodTable, cell: CellIndex) -> f64 {
        let squared = self.index(cell).map_or(u32::MAX, |index| self.squared[index]);
        law.by_square.get(squared as usize).copied().unwrap_or(law.worst())
    }

    fn index(&self, (column, row): CellIndex) -> Option<usize> {
        let inside = (0..self.width).contains(&column) && (0..self.height).contains(&row);
        inside.then(|| row as usize * self.width as usize + column as usize)
    }
}

/// Likelihood of end points around walls: log likelihood by squared distance in cells.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodTable {
    by_square: Vec<f64>,
}

impl LikelihoodTable {
    /// Tabulates standard deviation `std` \[m] for cells of side `resolution` \[m].
    pub(super) fn with_std(std: f64, resolution: f64) -> Self {
        let reach = (REACH * std / resolution).ceil();
        let by_square = (0..=(reach * reach) as u32).map(|square| {
            let deviations = f64::from(square) * (resolution / std) * (resolution / std);
            libm::log((1.0 - ANYWHERE) * libm::exp(-0.5 * deviations) + ANYWHERE)
        });
        Self { by_square: by_square.collect() }
    }

    /// Returns the log likelihood of an end point far from any wall.
    #[allow(clippy::unused_self, reason = "part of the interface of the table")]
    pub(super) fn worst(&self) -> f64 {
        libm::log(ANYWHERE)
    }
}
