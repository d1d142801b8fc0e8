//! Occupancy grids, whatever file they come from.

use surepose::geometry::{Angle, Frame, Map, Point, Pose};

/// Most cells of a grid: 8192 by 8192, half a gigabyte.
pub const MAX_CELLS: usize = 1 << 26;

/// A rectangle of square cells, each occupied with some probability.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Cells along the grid's x axis.
    pub width: usize,
    /// Cells along the grid's y axis.
    pub height: usize,
    /// Side of a cell \[m\].
    pub resolution: f64,
    /// Where the outer corner of cell (0, 0) lies in the map, and how the grid is turned there.
    pub origin: GridOrigin,
    /// Probability that a cell is occupied, `None` where it is unknown; `height` rows of `width` cells, beginning
    /// with the row at the origin.
    pub cells: Vec<Option<f32>>,
}

/// Where a grid lies in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridOrigin {
    /// Position \[m\].
    pub x: f64,
    /// Position \[m\].
    pub y: f64,
    /// Direction of the grid's x axis \[rad\].
    pub heading: f64,
}

impl Grid {
    /// Probability that the cell is occupied; `None` where it is unknown or outside the grid.
    pub fn occupancy(&self, column: usize, row: usize) -> Option<f32> {
        if column >= self.width {
            return None;
        }
        let index = row.checked_mul(self.width)?.checked_add(column)?;
        self.cells.get(index).copied().flatten()
    }

    /// The middle of a cell in the map \[m\].
    pub fn center(&self, column: usize, row: usize) -> (f64, f64) {
        let (x, y) = ((column as f64 + 0.5) * self.resolution, (row as f64 + 0.5) * self.resolution);
        let center = self.map_from_cells() * Point::new(x, y);
        (center.x, center.y)
    }

    /// Column and row of the cell in which a point of the map lies \[m\]; `None` outside the grid.
    pub fn cell_at(&self, x: f64, y: f64) -> Option<(usize, usize)> {
        let point = self.map_from_cells().inverse() * Point::new(x, y);
        let (column, row) = (point.x / self.resolution, point.y / self.resolution);
        let inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then_some((column as usize, row as usize))
    }

    /// Where the frame of the cells lies in the map.
    pub fn map_from_cells(&self) -> Pose<Map, Cells, f64> {
        Pose::new(self.origin.x, self.origin.y, Angle::from_radians(self.origin.heading))
    }
}

/// The frame of a grid: origin at the outer corner of cell (0, 0), x along a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cells;
impl Frame for Cells {}

#[cfg(test)]
mod tests;
