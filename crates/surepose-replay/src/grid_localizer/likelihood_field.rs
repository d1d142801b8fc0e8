//! How likely a beam ends where it does on an occupancy grid: the likelihood field of [Thrun2005] Sec. 6.4.
//!
//! What lies between the laser and the end of a beam is not asked: a door that stood open on the day of the map would
//! stop every beam that passes there today, and hide what the beam says of the wall behind.

use surepose::geometry::{Map, Point, Pose};
use surepose_io::grid::{Cells, Grid};
use surepose_mapping::from_grid::{is_free, is_solid};

/// The part of the beams that end anywhere: on people, furniture, and doors that stand otherwise than on the map.
const ANYWHERE: f64 = 0.05;

/// So many standard deviations from a wall an end is anywhere.
const REACH: f64 = 4.0;

/// The grid, made for looking up ends of beams.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodField {
    width: i32,
    height: i32,
    resolution: f64,
    /// Where the grid lies.
    pub(super) map_from_cells: Pose<Map, Cells, f64>,
    /// Square of the distance from each cell to the nearest solid one, in cells; as large as can be where that is far.
    squared: Vec<u32>,
    free: Vec<bool>,
}

/// A cell by column and row; those outside the grid are neither free nor solid, and far from everything.
pub(super) type CellIndex = (i32, i32);

impl LikelihoodField {
    /// The field of `grid`, to be read with standard deviations up to `widest` \[m].
    pub(super) fn from_grid(grid: &Grid, widest: f64) -> Self {
        // No grid has more cells than that, see `grid::MOST_CELLS`.
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
            // What is solid all around is nearest to nothing but itself.
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

    /// Cells along x and along y.
    pub(super) fn size(&self) -> CellIndex {
        (self.width, self.height)
    }

    /// Side of a cell \[m].
    pub(super) fn resolution(&self) -> f64 {
        self.resolution
    }

    /// The cell that a point lies in.
    pub(super) fn cell_at(&self, at: Point<Cells, f64>) -> CellIndex {
        let cell = |x: f64| (x / self.resolution).floor() as i32;
        (cell(at.x), cell(at.y))
    }

    /// The middle of a cell.
    pub(super) fn middle(&self, (column, row): CellIndex) -> Point<Cells, f64> {
        let at = |cell: i32| (f64::from(cell) + 0.5) * self.resolution;
        Point::new(at(column), at(row))
    }

    /// Whether a cell is known to be free.
    pub(super) fn is_free(&self, cell: CellIndex) -> bool {
        self.index(cell).is_some_and(|index| self.free[index])
    }

    /// Whether a cell is in the grid and not solid.
    pub(super) fn is_open(&self, cell: CellIndex) -> bool {
        self.index(cell).is_some_and(|index| self.squared[index] > 0)
    }

    /// Whether a cell is so near to a solid one \[m], by their middles.
    pub(super) fn is_near_wall(&self, cell: CellIndex, within: f64) -> bool {
        let squared = self.index(cell).map_or(u32::MAX, |index| self.squared[index]);
        f64::from(squared) * self.resolution * self.resolution <= within * within
    }

    /// Log likelihood that a beam ends in a cell, 0 for a solid one.
    pub(super) fn log_likelihood(&self, law: &LikelihoodTable, cell: CellIndex) -> f64 {
        let squared = self.index(cell).map_or(u32::MAX, |index| self.squared[index]);
        law.by_square.get(squared as usize).copied().unwrap_or(law.worst())
    }

    fn index(&self, (column, row): CellIndex) -> Option<usize> {
        let inside = (0..self.width).contains(&column) && (0..self.height).contains(&row);
        inside.then(|| row as usize * self.width as usize + column as usize)
    }
}

/// How ends of beams scatter around walls: log likelihood by the square of the distance in cells.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodTable {
    by_square: Vec<f64>,
}

impl LikelihoodTable {
    /// Scattering with standard deviation `std` \[m] on cells of side `resolution` \[m].
    pub(super) fn with_std(std: f64, resolution: f64) -> Self {
        let reach = (REACH * std / resolution).ceil();
        let by_square = (0..=(reach * reach) as u32).map(|square| {
            let deviations = f64::from(square) * (resolution / std) * (resolution / std);
            libm::log((1.0 - ANYWHERE) * libm::exp(-0.5 * deviations) + ANYWHERE)
        });
        Self { by_square: by_square.collect() }
    }

    /// The log likelihood of an end that is nowhere near a wall.
    #[allow(clippy::unused_self, reason = "it is of this law")]
    pub(super) fn worst(&self) -> f64 {
        libm::log(ANYWHERE)
    }
}
