//! Distance to the nearest wall for each cell of the map, for exhaustive pose search.

use crate::geometry::{Map, Point};
use crate::scalar::Float;

use super::wall::Wall;

/// Unit of the distances over a wall map \[m]. A cell stores up to 127 of them, here 0.508 m.
const WALL_UNIT: f64 = 0.004;

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
    /// Unit of the distances that cells store \[m].
    unit: f64,
}

/// State of a cell of an occupancy grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellState {
    /// The robot can be here.
    Free,
    /// Not observed.
    Unknown,
    /// Part of a wall.
    Occupied,
}

impl<S: Float> GridSpec<S> {
    /// Grid of an occupancy grid, in the frame of that grid, for distances of up to `max_distance` \[m].
    pub fn from_size(columns: i32, rows: i32, resolution: S, max_distance: S) -> Self {
        let unit = max_distance.to_f64() / f64::from(FAR);
        Self { origin: Point::default(), resolution, columns: columns.max(0), rows: rows.max(0), unit }
    }

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
        let margin = S::from_f64(WALL_UNIT * f64::from(FAR));
        let count = |from: S, to: S| {
            ((to - from + margin + margin).to_f64() / resolution.to_f64()).min(MAX_CELLS_PER_AXIS) as i32 + 1
        };
        let any = i32::from(corners.is_some());
        Self {
            origin: Point::new(low.x - margin, low.y - margin),
            resolution,
            columns: any * count(low.x, high.x),
            rows: any * count(low.y, high.y),
            unit: WALL_UNIT,
        }
    }

    /// Maximum distance that a cell stores \[m].
    fn max_distance(&self) -> f64 {
        self.unit * f64::from(FAR)
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
            let margin_cells = self.to_cells(S::from_f64(self.max_distance())) + 1;
            let columns =
                (a.0.min(b.0) - margin_cells).max(0)..=(a.0.max(b.0) + margin_cells).min(self.columns - 1);
            for row in (a.1.min(b.1) - margin_cells).max(0)..=(a.1.max(b.1) + margin_cells).min(self.rows - 1)
            {
                for column in columns.clone() {
                    let (column, row) = (column as usize, row as usize);
                    let distance = wall.distance(self.center(column, row)).to_f64() / self.unit;
                    if let Some(cell) = cells.get_mut(row * self.columns as usize + column) {
                        *cell = (*cell & FAR).min(distance.min(f64::from(FAR)) as u8) | (*cell & OCCUPIED);
                    }
                }
            }
        }
    }

    /// Rasterizes an occupancy grid into `cells`: distances between centers of cells, rounded to the unit.
    ///
    /// Cells inside solid areas count as distant from each other, because beams end on surfaces only. The robot can
    /// occupy free cells only.
    pub fn rasterize_occupancy(&self, cells: &mut [u8], state: impl Fn(Cell) -> CellState) {
        let in_grid =
            |(column, row): Cell| (0..self.columns).contains(&column) && (0..self.rows).contains(&row);
        let is_occupied = |cell: Cell| in_grid(cell) && state(cell) == CellState::Occupied;
        let index = |(column, row): Cell| row as usize * self.columns as usize + column as usize;
        let all = || (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        for (at, cell) in all().zip(cells.iter_mut()) {
            *cell = if state(at) == CellState::Free { FAR } else { FAR | OCCUPIED };
        }
        let reach = self.to_cells(S::from_f64(self.max_distance())) + 1;
        for (x, y) in all().filter(|cell| is_occupied(*cell)) {
            let is_inner = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)].into_iter().all(is_occupied);
            let reach = if is_inner { 0 } else { reach };
            for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
                let at = (x + dx, y + dy);
                if !in_grid(at) {
                    continue;
                }
                if let Some(cell) = cells.get_mut(index(at)) {
                    let squared = S::from_f64(f64::from(dx * dx + dy * dy));
                    let units = (squared.sqrt() * self.resolution).to_f64() / self.unit + 0.5;
                    *cell = (*cell & FAR).min(units.min(f64::from(FAR)) as u8) | (*cell & OCCUPIED);
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
pub type Cell = (i32, i32);

impl<'a, S: Float> DistanceField<'a, S> {
    /// Field over `cells`; `None` where their number differs from that of `grid`.
    pub fn from_cells(grid: GridSpec<S>, cells: &'a [u8]) -> Option<Self> {
        (cells.len() == grid.cell_count()).then_some(Self { grid, cells })
    }

    /// Maximum distance that a cell stores \[m].
    pub(crate) fn max_distance(&self) -> S {
        S::from_f64(self.grid.max_distance())
    }

    /// Length in the unit of [`DistanceField::distance`].
    pub fn units(&self, length: S) -> u32 {
        (length.to_f64() / self.grid.unit) as u32
    }

    /// Unit of [`DistanceField::distance`] \[m].
    pub fn unit(&self) -> S {
        S::from_f64(self.grid.unit)
    }

    /// Distance from a cell to the nearest wall, 0 to 127 units; 127 stands for any larger distance.
    #[inline(always)]
    pub fn distance(&self, cell: Cell) -> u32 {
        u32::from(self.at(cell) & FAR)
    }

    /// Whether the robot can occupy a cell with its center `clearance` \[m] from every wall.
    pub fn is_free(&self, cell: Cell, clearance: S) -> bool {
        self.at(cell) & OCCUPIED == 0 && self.distance(cell) >= self.units(clearance.min(self.max_distance()))
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
