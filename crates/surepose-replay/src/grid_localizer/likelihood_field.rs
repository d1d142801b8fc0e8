//! Likelihood field of an occupancy grid, [Thrun2005] Sec. 6.4.
//!
//! The path of a beam is ignored. A door that is closed on the map but open today would otherwise reject
//! every beam through it, together with what the beam measures behind it.

use surepose::geometry::{Map, Point, Pose};
use surepose::map::{Cell, CellState, DistanceField, GridSpec};
use surepose_io::grid::{Cells, Grid, is_free, is_solid};

/// Probability of an unexpected end point: people, furniture, and doors that differ from the map.
const ANYWHERE: f64 = 0.05;

/// Maximum distance from a wall with a Gaussian likelihood, in standard deviations.
const REACH: f64 = 4.0;

/// Distance field of a grid, evaluated as likelihoods of end points.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodField {
    grid: GridSpec<f64>,
    cells: Vec<u8>,
    width: i32,
    height: i32,
    resolution: f64,
    /// Pose of the grid in the map.
    pub(super) map_from_cells: Pose<Map, Cells, f64>,
}

impl LikelihoodField {
    /// Computes the field of `grid` for standard deviations up to `widest` \[m].
    pub(super) fn from_grid(grid: &Grid, widest: f64) -> Self {
        // The maximum number of cells is `grid::MAX_CELLS`.
        let [width, height] = [grid.width, grid.height].map(|cells| i32::try_from(cells).unwrap_or(0));
        let spec = GridSpec::from_size(width, height, grid.resolution, REACH * widest);
        let mut cells = vec![0; spec.cell_count()];
        spec.rasterize_occupancy(&mut cells, |(column, row)| {
            let at = usize::try_from(column).ok().zip(usize::try_from(row).ok());
            let occupancy = at.and_then(|(column, row)| grid.occupancy(column, row));
            if is_solid(occupancy) {
                CellState::Occupied
            } else if is_free(occupancy) {
                CellState::Free
            } else {
                CellState::Unknown
            }
        });
        let map_from_cells = grid.map_from_cells();
        Self { grid: spec, cells, width, height, resolution: grid.resolution, map_from_cells }
    }

    /// Returns the number of cells along x and y.
    pub(super) fn size(&self) -> Cell {
        (self.width, self.height)
    }

    /// Returns the side of a cell \[m].
    pub(super) fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Returns the cell that contains a point.
    pub(super) fn cell_at(&self, at: Point<Cells, f64>) -> Cell {
        let cell = |x: f64| (x / self.resolution).floor() as i32;
        (cell(at.x), cell(at.y))
    }

    /// Returns the center of a cell.
    pub(super) fn middle(&self, (column, row): Cell) -> Point<Cells, f64> {
        let at = |cell: i32| (f64::from(cell) + 0.5) * self.resolution;
        Point::new(at(column), at(row))
    }

    /// Returns whether a cell is known to be free.
    pub(super) fn is_free(&self, cell: Cell) -> bool {
        self.field().is_some_and(|field| field.is_free(cell, 0.0))
    }

    /// Returns whether a cell is in the grid and not solid.
    pub(super) fn is_open(&self, cell: Cell) -> bool {
        let is_inside = (0..self.width).contains(&cell.0) && (0..self.height).contains(&cell.1);
        is_inside && self.distance(cell) > 0
    }

    /// Returns whether the center of a cell is within a distance \[m] of that of a solid cell.
    pub(super) fn is_near_wall(&self, cell: Cell, within: f64) -> bool {
        self.field().is_some_and(|field| field.distance(cell) <= field.units(within))
    }

    /// Returns the log likelihood of a beam end in a cell; about 0 for a solid one.
    pub(super) fn log_likelihood(&self, law: &LikelihoodTable, cell: Cell) -> f64 {
        law.by_distance.get(self.distance(cell) as usize).copied().unwrap_or(law.worst())
    }

    /// Tabulates the likelihood of end points for standard deviation `std` \[m].
    pub(super) fn likelihood_table(&self, std: f64) -> LikelihoodTable {
        let unit = self.field().map_or(self.resolution, |field| field.unit());
        let reach = (REACH * std / unit).floor() as u32;
        let by_distance = (0..=reach).map(|units| {
            let deviations = f64::from(units) * unit / std;
            libm::log((1.0 - ANYWHERE) * libm::exp(-0.5 * deviations * deviations) + ANYWHERE)
        });
        LikelihoodTable { by_distance: by_distance.collect() }
    }

    /// Returns the distance of a cell from walls, in the unit of the field.
    fn distance(&self, cell: Cell) -> u32 {
        self.field().map_or(u32::MAX, |field| field.distance(cell))
    }

    fn field(&self) -> Option<DistanceField<'_, f64>> {
        DistanceField::from_cells(self.grid, &self.cells)
    }
}

/// Likelihood of end points around walls: log likelihood by distance, in the unit of the field.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodTable {
    by_distance: Vec<f64>,
}

impl LikelihoodTable {
    /// Returns the log likelihood of an end point far from any wall.
    #[allow(clippy::unused_self, reason = "part of the interface of the table")]
    pub(super) fn worst(&self) -> f64 {
        libm::log(ANYWHERE)
    }
}
