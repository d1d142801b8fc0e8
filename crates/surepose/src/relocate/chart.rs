//! How far the nearest wall is, for each cell of the map: to try every pose there is, a look-up for a beam.

use crate::frame::Map;
use crate::laser::Wall;
use crate::pose::Point;
use crate::scalar::Float;

/// The largest distance that a cell tells \[m], and how finely.
const REACH: f64 = 0.508;
const UNIT: f64 = 0.004;

/// As far as a cell can tell, and the bit that says that nobody can be there.
const FAR: u8 = 0x7f;
const CLOSED: u8 = 0x80;

/// Farther than so many cells nothing is told apart: sums of a few are cells still.
const MOST_STEPS: f64 = 1e8;

/// Cells over a map, row by row from the lower left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent<S> {
    low: Point<Map, S>,
    side: S,
    columns: i32,
    rows: i32,
}

impl<S: Float> Extent<S> {
    /// Cells of `side` \[m] over all of `walls`; none where there are no walls.
    pub fn around(walls: &[Wall<S>], side: S) -> Self {
        let mut corners: Option<[Point<Map, S>; 2]> = None;
        for end in walls.iter().flat_map(Wall::ends) {
            let [low, high] = corners.unwrap_or([end; 2]);
            corners = Some([
                Point::new(low.x.min(end.x), low.y.min(end.y)),
                Point::new(high.x.max(end.x), high.y.max(end.y)),
            ]);
        }
        let [low, high] = corners.unwrap_or_default();
        let margin = S::of(REACH);
        let count = |from: S, to: S| {
            ((to - from + margin + margin).to_f64() / side.to_f64()).min(MOST_STEPS) as i32 + 1
        };
        let any = i32::from(corners.is_some());
        Self {
            low: Point::new(low.x - margin, low.y - margin),
            side,
            columns: any * count(low.x, high.x),
            rows: any * count(low.y, high.y),
        }
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        (self.columns as usize).saturating_mul(self.rows as usize)
    }

    /// Draws `walls` into `cells`. Where `is_open` says no, nobody can be: what is outside, or solid.
    pub fn draw(&self, walls: &[Wall<S>], cells: &mut [u8], is_open: impl Fn(Point<Map, S>) -> bool) {
        for (index, cell) in cells.iter_mut().enumerate() {
            let columns = self.columns.max(1) as usize;
            let middle = self.middle(index % columns, index / columns);
            *cell = if is_open(middle) { FAR } else { FAR | CLOSED };
        }
        for wall in walls {
            let [a, b] =
                wall.ends().map(|end| (self.steps(end.x - self.low.x), self.steps(end.y - self.low.y)));
            let reach = self.steps(S::of(REACH)) + 1;
            let columns = (a.0.min(b.0) - reach).max(0)..=(a.0.max(b.0) + reach).min(self.columns - 1);
            for row in (a.1.min(b.1) - reach).max(0)..=(a.1.max(b.1) + reach).min(self.rows - 1) {
                for column in columns.clone() {
                    let (column, row) = (column as usize, row as usize);
                    let distance = wall.distance(self.middle(column, row)).to_f64() / UNIT;
                    if let Some(cell) = cells.get_mut(row * self.columns as usize + column) {
                        *cell = (*cell & FAR).min(distance.min(f64::from(FAR)) as u8) | (*cell & CLOSED);
                    }
                }
            }
        }
    }

    fn middle(&self, column: usize, row: usize) -> Point<Map, S> {
        let half = S::of(0.5);
        Point::new(
            self.low.x + (S::of(column as f64) + half) * self.side,
            self.low.y + (S::of(row as f64) + half) * self.side,
        )
    }

    /// A length in cells, of which there are never so many.
    fn steps(&self, length: S) -> i32 {
        let steps = (length.to_f64() / self.side.to_f64()).clamp(-MOST_STEPS, MOST_STEPS);
        // Towards −∞, as a cast alone does not.
        steps as i32 - i32::from(steps < 0.0)
    }
}

/// Distances to the nearest wall over a map, drawn by [`Extent::draw`] into memory of the caller's.
#[derive(Clone, Copy, Debug)]
pub struct Chart<'a, S> {
    extent: Extent<S>,
    cells: &'a [u8],
}

/// A column and a row, or steps from one cell to another.
pub(super) type Cell = (i32, i32);

impl<'a, S: Float> Chart<'a, S> {
    /// What was drawn into `cells`; `None` where these are not as many as `extent` has.
    pub fn of(extent: Extent<S>, cells: &'a [u8]) -> Option<Self> {
        (cells.len() == extent.cells()).then_some(Self { extent, cells })
    }

    /// The largest distance that is told \[m].
    pub(super) fn reach() -> S {
        S::of(REACH)
    }

    /// A length in the unit of [`Chart::distance`].
    pub(super) fn units(length: S) -> u32 {
        (length.to_f64() / UNIT) as u32
    }

    /// How far the wall nearest to a cell is, in units.
    #[inline(always)]
    pub(super) fn distance(&self, cell: Cell) -> u32 {
        u32::from(self.at(cell) & FAR)
    }

    /// Whether the robot can be in a cell, its middle `clearance` from every wall \[m].
    pub(super) fn is_free(&self, cell: Cell, clearance: S) -> bool {
        self.at(cell) & CLOSED == 0 && self.distance(cell) >= Self::units(clearance.min(Self::reach()))
    }

    /// What was drawn; outside, no wall is near and nobody can be.
    #[inline(always)]
    fn at(&self, (column, row): Cell) -> u8 {
        let Extent { columns, rows, .. } = self.extent;
        if column < 0 || row < 0 || column >= columns || row >= rows {
            return FAR | CLOSED;
        }
        self.cells.get(row as usize * columns as usize + column as usize).copied().unwrap_or(FAR | CLOSED)
    }

    /// Every cell in steps of `length` \[m].
    pub(super) fn lattice(&self, length: S) -> impl Iterator<Item = Cell> + use<S> {
        let step = self.extent.steps(length).max(1) as usize;
        let Extent { columns, rows, .. } = self.extent;
        (0..rows)
            .step_by(step)
            .flat_map(move |row| (0..columns).step_by(step).map(move |column| (column, row)))
    }

    /// The middle of a cell.
    pub(super) fn middle(&self, (column, row): Cell) -> Point<Map, S> {
        self.extent.middle(column as usize, row as usize)
    }

    /// The cell of a point.
    pub(super) fn cell_at(&self, point: Point<Map, S>) -> Cell {
        let low = self.extent.low;
        (self.extent.steps(point.x - low.x), self.extent.steps(point.y - low.y))
    }

    /// The steps that a length to the right and one upwards come to, rounded \[m].
    pub(super) fn steps_of(&self, x: S, y: S) -> Cell {
        let half = S::of(0.5) * self.extent.side;
        (self.extent.steps(x + half), self.extent.steps(y + half))
    }
}
