//! Distance to the nearest wall for each cell of the map, for exhaustive pose search.

use crate::geometry::{Map, Point};
use crate::scalar::Float;

use super::wall::Wall;

/// Maximum distance that a cell stores \[m], and its resolution \[m].
const MAX_DISTANCE: f64 = 0.508;
const UNIT: f64 = 0.004;

/// Bits of a cell: the maximum distance, and the flag of a cell that the robot cannot occupy.
const FAR: u8 = 0x7f;
const OCCUPIED: u8 = 0x80;

/// Maximum coordinate in cells; larger ones are clamped, so that sums of a few do not overflow.
const MAX_CELLS_PER_AXIS: f64 = 1e8;

/// Grid over a map, row by row from the lower left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSpec<S> {
    origin: Point<Map, S>,
    resolution: S,
    columns: i32,
    rows: i32,
}

impl<S: Float> GridSpec<S> {
    /// Grid with cells of `resolution` \[m] over all of `walls`; no cells where there are no walls.
    pub fn from_walls(walls: &[Wall<S>], resolution: S) -> Self {
        let mut corners: Option<[Point<Map, S>; 2]> = None;
        for end in walls.iter().flat_map(Wall::ends) {
            let [low, high] = corners.unwrap_or([end; 2]);
            corners = Some([
                Point::new(low.x.min(end.x), low.y.min(end.y)),
                Point::new(high.x.max(end.x), high.y.max(end.y)),
            ]);
        }
        let [low, high] = corners.unwrap_or_default();
        let margin = S::from_f64(MAX_DISTANCE);
        let count = |from: S, to: S| {
            ((to - from + margin + margin).to_f64() / resolution.to_f64()).min(MAX_CELLS_PER_AXIS) as i32 + 1
        };
        let any = i32::from(corners.is_some());
        Self {
            origin: Point::new(low.x - margin, low.y - margin),
            resolution,
            columns: any * count(low.x, high.x),
            rows: any * count(low.y, high.y),
        }
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        (self.columns as usize).saturating_mul(self.rows as usize)
    }

    /// Rasterizes `walls` into `cells`. A cell where `is_free_space` is false, outside or solid, is occupied.
    pub fn rasterize(
        &self,
        walls: &[Wall<S>],
        cells: &mut [u8],
        is_free_space: impl Fn(Point<Map, S>) -> bool,
    ) {
        for (index, cell) in cells.iter_mut().enumerate() {
            let columns = self.columns.max(1) as usize;
            let center = self.center(index % columns, index / columns);
            *cell = if is_free_space(center) { FAR } else { FAR | OCCUPIED };
        }
        for wall in walls {
            let [a, b] = wall
                .ends()
                .map(|end| (self.to_cells(end.x - self.origin.x), self.to_cells(end.y - self.origin.y)));
            let margin_cells = self.to_cells(S::from_f64(MAX_DISTANCE)) + 1;
            let columns =
                (a.0.min(b.0) - margin_cells).max(0)..=(a.0.max(b.0) + margin_cells).min(self.columns - 1);
            for row in (a.1.min(b.1) - margin_cells).max(0)..=(a.1.max(b.1) + margin_cells).min(self.rows - 1)
            {
                for column in columns.clone() {
                    let (column, row) = (column as usize, row as usize);
                    let distance = wall.distance(self.center(column, row)).to_f64() / UNIT;
                    if let Some(cell) = cells.get_mut(row * self.columns as usize + column) {
                        *cell = (*cell & FAR).min(distance.min(f64::from(FAR)) as u8) | (*cell & OCCUPIED);
                    }
                }
            }
        }
    }

    fn center(&self, column: usize, row: usize) -> Point<Map, S> {
        let half = S::from_f64(0.5);
        Point::new(
            self.origin.x + (S::from_f64(column as f64) + half) * self.resolution,
            self.origin.y + (S::from_f64(row as f64) + half) * self.resolution,
        )
    }

    /// Length in cells, rounded down and clamped.
    fn to_cells(self, length: S) -> i32 {
        let steps =
            (length.to_f64() / self.resolution.to_f64()).clamp(-MAX_CELLS_PER_AXIS, MAX_CELLS_PER_AXIS);
        // Rounds toward −∞, unlike a cast alone.
        steps as i32 - i32::from(steps < 0.0)
    }
}

/// Distances to the nearest wall over a map, stored by [`GridSpec::rasterize`] in memory that the caller owns.
#[derive(Clone, Copy, Debug)]
pub struct DistanceField<'a, S> {
    grid: GridSpec<S>,
    cells: &'a [u8],
}

/// Column and row, or offsets between cells.
pub(crate) type Cell = (i32, i32);

impl<'a, S: Float> DistanceField<'a, S> {
    /// Field over `cells`; `None` where their number differs from that of `grid`.
    pub fn from_cells(grid: GridSpec<S>, cells: &'a [u8]) -> Option<Self> {
        (cells.len() == grid.cell_count()).then_some(Self { grid, cells })
    }

    /// Maximum distance that a cell stores \[m].
    pub(crate) fn max_distance() -> S {
        S::from_f64(MAX_DISTANCE)
    }

    /// Length in the unit of [`DistanceField::distance`].
    pub(crate) fn units(length: S) -> u32 {
        (length.to_f64() / UNIT) as u32
    }

    /// Distance from a cell to the nearest wall, in units.
    #[inline(always)]
    pub(crate) fn distance(&self, cell: Cell) -> u32 {
        u32::from(self.at(cell) & FAR)
    }

    /// Whether the robot can occupy a cell with its center `clearance` \[m] from every wall.
    pub(crate) fn is_free(&self, cell: Cell, clearance: S) -> bool {
        self.at(cell) & OCCUPIED == 0
            && self.distance(cell) >= Self::units(clearance.min(Self::max_distance()))
    }

    /// Stored cell value; outside the grid, far from walls and occupied.
    #[inline(always)]
    fn at(&self, (column, row): Cell) -> u8 {
        let GridSpec { columns, rows, .. } = self.grid;
        if column < 0 || row < 0 || column >= columns || row >= rows {
            return FAR | OCCUPIED;
        }
        self.cells.get(row as usize * columns as usize + column as usize).copied().unwrap_or(FAR | OCCUPIED)
    }

    /// Every cell in steps of `length` \[m].
    pub(crate) fn cells_at_spacing(&self, length: S) -> impl Iterator<Item = Cell> + use<S> {
        let step = self.grid.to_cells(length).max(1) as usize;
        let GridSpec { columns, rows, .. } = self.grid;
        (0..rows)
            .step_by(step)
            .flat_map(move |row| (0..columns).step_by(step).map(move |column| (column, row)))
    }

    /// Center of a cell.
    pub(crate) fn center(&self, (column, row): Cell) -> Point<Map, S> {
        self.grid.center(column as usize, row as usize)
    }

    /// Cell that contains a point.
    pub(crate) fn cell_at(&self, point: Point<Map, S>) -> Cell {
        let low = self.grid.origin;
        (self.grid.to_cells(point.x - low.x), self.grid.to_cells(point.y - low.y))
    }

    /// Cell offset of a displacement to the right and up \[m], rounded.
    pub(crate) fn cells_of(&self, x: S, y: S) -> Cell {
        let half = S::from_f64(0.5) * self.grid.resolution;
        (self.grid.to_cells(x + half), self.grid.to_cells(y + half))
    }
}
