//! Defines the occupancy grid, independent of its file format.

use surepose::geometry::{Angle, Frame, Map, Point, Pose};

/// Maximum number of cells: 8192 by 8192, half a gigabyte.
pub const MAX_CELLS: usize = 1 << 26;

/// Occupancy probability above which a cell is solid; below one minus this it is free.
const SOLID: f32 = 0.65;

/// A rectangular grid of square cells with occupancy probabilities.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Cells along the grid's x axis.
    pub width: usize,
    /// Cells along the grid's y axis.
    pub height: usize,
    /// Edge length of a cell \[m\].
    pub resolution: f64,
    /// Pose in the map of the outer corner of cell (0, 0).
    pub origin: GridOrigin,
    /// Probability that a cell is occupied; `None` if unknown. `height` rows of `width` cells, starting with the row at the
    /// origin.
    pub cells: Vec<Option<f32>>,
}

/// The pose of a grid in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridOrigin {
    /// Position along the x axis of the map \[m\].
    pub x: f64,
    /// Position along the y axis of the map \[m\].
    pub y: f64,
    /// Direction of the x axis of the grid in the map \[rad\].
    pub heading: f64,
}

impl Grid {
    /// Returns the probability that a cell is occupied; `None` if it is unknown or outside the grid.
    pub fn occupancy(&self, column: usize, row: usize) -> Option<f32> {
        if column >= self.width {
            return None;
        }
        let index = row.checked_mul(self.width)?.checked_add(column)?;
        self.cells.get(index).copied().flatten()
    }

    /// Returns the center of a cell in the map \[m\].
    pub fn center(&self, column: usize, row: usize) -> (f64, f64) {
        let (x, y) = ((column as f64 + 0.5) * self.resolution, (row as f64 + 0.5) * self.resolution);
        let center = self.map_from_cells() * Point::new(x, y);
        (center.x, center.y)
    }

    /// Returns column and row of the cell that contains a point of the map \[m\]; `None` outside the grid.
    pub fn cell_at(&self, x: f64, y: f64) -> Option<(usize, usize)> {
        let point = self.map_from_cells().inverse() * Point::new(x, y);
        let (column, row) = (point.x / self.resolution, point.y / self.resolution);
        let inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then_some((column as usize, row as usize))
    }

    /// Returns the pose of the cell frame in the map.
    pub fn map_from_cells(&self) -> Pose<Map, Cells, f64> {
        Pose::new(self.origin.x, self.origin.y, Angle::from_radians(self.origin.heading))
    }
}

/// Returns whether a cell of this occupancy stops a beam; unknown cells do not.
pub fn is_solid(occupancy: Option<f32>) -> bool {
    occupancy.is_some_and(|p| p > SOLID)
}

/// Returns whether a beam passes through a cell of this occupancy; unknown cells are neither solid nor free.
pub fn is_free(occupancy: Option<f32>) -> bool {
    occupancy.is_some_and(|p| p < 1.0 - SOLID)
}

/// Reason for which few walls can be traced from a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SparseGrid {
    /// No cell is solid.
    #[error("no cell is occupied ({free} % are free, {unknown} % unknown)")]
    NothingSolid {
        /// Free cells, in percent.
        free: u8,
        /// Unknown cells, in percent.
        unknown: u8,
    },
    /// No cell is free.
    #[error("no cell is free ({solid} % are occupied, {unknown} % unknown)")]
    NothingFree {
        /// Solid cells, in percent.
        solid: u8,
        /// Unknown cells, in percent.
        unknown: u8,
    },
    /// Most of the known cells are solid.
    #[error("{solid} % of the known cells are occupied")]
    MostlySolid {
        /// Solid cells, in percent of those that are solid or free.
        solid: u8,
    },
    /// Most of the cells in the rectangle around the known ones are unknown.
    #[error("{unknown} % of the cells among the known ones are unknown")]
    MostlyUnknown {
        /// Unknown cells, in percent.
        unknown: u8,
    },
}

/// Percentage of solid cells, among the known ones, from which a grid is [`SparseGrid::MostlySolid`].
const MAX_SOLID_PERCENT: u8 = 60;

/// Percentage of unknown cells from which a grid is [`SparseGrid::MostlyUnknown`].
const MAX_UNKNOWN_PERCENT: u8 = 90;

impl Grid {
    /// Checks that the grid has solid and free cells in usual proportions; `None` if it has.
    pub fn sparseness(&self) -> Option<SparseGrid> {
        let (mut solid, mut free) = (0, 0);
        let (mut low, mut high) = ((usize::MAX, usize::MAX), (0, 0));
        for (index, &cell) in self.cells.iter().enumerate() {
            let counter = if is_solid(cell) {
                &mut solid
            } else if is_free(cell) {
                &mut free
            } else {
                continue;
            };
            *counter += 1_usize;
            let (column, row) = (index % self.width, index / self.width);
            low = (column.min(low.0), row.min(low.1));
            high = (column.max(high.0), row.max(high.1));
        }
        let known = solid + free;
        let unknown = percent(self.cells.len() - known, self.cells.len());
        if solid == 0 {
            return Some(SparseGrid::NothingSolid { free: percent(free, self.cells.len()), unknown });
        }
        if free == 0 {
            return Some(SparseGrid::NothingFree { solid: percent(solid, self.cells.len()), unknown });
        }
        let around = (high.0 - low.0 + 1) * (high.1 - low.1 + 1);
        let (solid, unknown) = (percent(solid, known), percent(around - known, around));
        match () {
            () if solid > MAX_SOLID_PERCENT => Some(SparseGrid::MostlySolid { solid }),
            () if unknown > MAX_UNKNOWN_PERCENT => Some(SparseGrid::MostlyUnknown { unknown }),
            () => None,
        }
    }
}

/// Percentage of `part` in `whole`, at most 100; 0 of nothing.
fn percent(part: usize, whole: usize) -> u8 {
    (100 * part).checked_div(whole).and_then(|percent| u8::try_from(percent).ok()).unwrap_or(0).min(100)
}

/// The frame of a grid: origin at the outer corner of cell (0, 0), x along a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cells;
impl Frame for Cells {}

#[cfg(test)]
mod tests;
