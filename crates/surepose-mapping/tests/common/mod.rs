//! Rooms drawn into grids as a mapper leaves them: the cells that contain the surface are occupied.

use surepose_io::grid::{Grid, GridOrigin};
use surepose_sim::Stream;

/// Ends of a wall: x, y \[m].
pub(crate) type Segment = [(f64, f64); 2];

/// Half the sides of the room \[m].
const HALF: (f64, f64) = (3.0, 2.0);

/// Side of the grid \[m].
const SIDE: f64 = 9.0;

/// A room of 6 m by 4 m with two plates, turned by `tilt` \[rad] around the origin.
pub(crate) fn room(tilt: f64) -> Vec<Segment> {
    let (x, y) = HALF;
    let (sin, cos) = tilt.sin_cos();
    let turned = |(x, y): (f64, f64)| (cos * x - sin * y, sin * x + cos * y);
    let corners = [(-x, -y), (x, -y), (x, y), (-x, y)];
    let walls = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]);
    let plates = [[(-0.5, 0.0), (0.5, 0.0)], [(2.0, -1.2), (2.0, -0.4)]];
    walls.chain(plates).map(|ends| ends.map(turned)).collect()
}

/// A grid and how cells are drawn into it.
pub(crate) struct Raster {
    /// Turn of the room, whose inside is free \[rad].
    pub(crate) tilt: f64,
    /// Cell side \[m].
    pub(crate) resolution: f64,
    /// Shift of the grid against the room \[m].
    pub(crate) shift: (f64, f64),
    /// Standard deviation of the drawn surface \[m].
    pub(crate) noise: f64,
    /// Fraction of the surface that is not drawn.
    pub(crate) dropout: f64,
    /// Corners of a rectangle inside of which no cell is free, before the tilt \[m].
    pub(crate) hidden: [(f64, f64); 2],
    /// Seed of noise and dropout.
    pub(crate) random: Stream,
}

impl Raster {
    /// A raster shifted by a random part of a cell, without noise.
    pub(crate) fn random(random: &mut Stream, tilt: f64, resolution: f64) -> Self {
        let shift = (random.uniform(0.0, resolution), random.uniform(0.0, resolution));
        Self {
            tilt,
            resolution,
            shift,
            noise: 0.0,
            dropout: 0.0,
            hidden: [(0.0, 0.0); 2],
            random: random.clone(),
        }
    }

    /// Draws the room with these walls.
    pub(crate) fn draw(&self, walls: &[Segment]) -> Grid {
        let size = (SIDE / self.resolution) as usize;
        let origin = (-0.5 * SIDE + self.shift.0, -0.5 * SIDE + self.shift.1);
        let (sin, cos) = self.tilt.sin_cos();
        let center = |index: usize, origin: f64| (index as f64 + 0.5) * self.resolution + origin;
        let mut cells = vec![None; size * size];
        for (index, cell) in cells.iter_mut().enumerate() {
            let (x, y) = (center(index % size, origin.0), center(index / size, origin.1));
            let (x, y) = (cos * x + sin * y, cos * y - sin * x);
            let [low, high] = self.hidden;
            let is_hidden = x > low.0 && x < high.0 && y > low.1 && y < high.1;
            if x.abs() < HALF.0 && y.abs() < HALF.1 && !is_hidden {
                *cell = Some(0.0);
            }
        }
        let mut random = self.random.clone();
        for [(ax, ay), (bx, by)] in walls.iter().copied() {
            let length = (bx - ax).hypot(by - ay);
            // Without noise every cell that the surface passes is marked; with noise about two hits per cell are.
            let step = if self.noise > 0.0 { 0.5 * self.resolution } else { 0.002 };
            let steps = (length / step) as usize;
            for step in 0..=steps {
                let part = step as f64 / steps as f64;
                let off = self.noise * random.normal();
                if random.bernoulli(self.dropout) {
                    continue;
                }
                let x = ax + part * (bx - ax) - off * (by - ay) / length;
                let y = ay + part * (by - ay) + off * (bx - ax) / length;
                let (column, row) = ((x - origin.0) / self.resolution, (y - origin.1) / self.resolution);
                cells[row as usize * size + column as usize] = Some(1.0);
            }
        }
        let origin = GridOrigin { x: origin.0, y: origin.1, heading: 0.0 };
        Grid { width: size, height: size, resolution: self.resolution, origin, cells }
    }
}
