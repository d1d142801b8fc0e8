//! The memory for a chart of a map, see [`Chart`].

use surepose::{Chart, Extent, Wall};

/// The side of a cell \[m].
const SIDE: f64 = 0.1;

/// The most cells: a square kilometre. A map that is larger has no chart.
const MOST_CELLS: usize = 100_000_000;

/// How far from the walls each place of a map is.
#[derive(Clone, Debug)]
pub struct Survey {
    extent: Extent<f64>,
    cells: Vec<u8>,
}

impl Survey {
    /// The survey of a map with these walls.
    pub fn of(walls: &[Wall<f64>]) -> Self {
        let extent = Extent::around(walls, SIDE);
        let mut cells = Vec::new();
        if extent.cells() <= MOST_CELLS {
            cells.resize(extent.cells(), 0);
            extent.draw(walls, &mut cells, |_| true);
        }
        Self { extent, cells }
    }

    /// The chart; `None` where there is no wall, or too large a map.
    pub fn chart(&self) -> Option<Chart<'_, f64>> {
        Chart::of(self.extent, &self.cells).filter(|_| !self.cells.is_empty())
    }
}
