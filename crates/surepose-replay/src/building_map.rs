//! Map of a building for a replay: walls for localization, and a grid for global localization.

use surepose::geometry::Point;
use surepose::map::Wall;
use surepose_io::grid::{Grid, GridOrigin};
use surepose_io::wall_map::{WallMap, walls_from_map};
use surepose_mapping::from_grid;

/// Cell side of a grid rasterized from walls \[m].
const SIDE: f64 = 0.1;

/// Maximum number of these cells: 1 km². Larger maps allow no global localization.
const MAX_CELLS: f64 = 1e8;

/// Walls and grid of a building.
#[derive(Clone, Debug)]
pub struct BuildingMap {
    walls: Vec<Wall<f64>>,
    grid: Grid,
}

impl BuildingMap {
    /// Extracts the walls of an occupancy grid.
    pub fn from_grid(grid: Grid) -> Self {
        Self { walls: walls_from_map(&from_grid::extract_walls(&grid).map), grid }
    }

    /// Rasterizes a wall map; the robot may be anywhere among the walls.
    pub fn from_wall_map(map: &WallMap) -> Self {
        let walls = walls_from_map(map);
        Self { grid: rasterize(&walls), walls }
    }

    /// Returns the walls.
    pub fn walls(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// Returns the grid; for a wall map, the walls rasterized on free cells.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}

/// Rasterizes walls on a grid that is free elsewhere.
fn rasterize(walls: &[Wall<f64>]) -> Grid {
    let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
    for end in walls.iter().flat_map(Wall::ends) {
        (low, high) = ((low.0.min(end.x), low.1.min(end.y)), (high.0.max(end.x), high.1.max(end.y)));
    }
    let cells = |low: f64, high: f64| ((high - low).max(0.0) / SIDE).floor() + 4.0;
    let (width, height) = (cells(low.0, high.0), cells(low.1, high.1));
    if low.0 > high.0 || width * height > MAX_CELLS {
        return Grid {
            width: 0,
            height: 0,
            resolution: SIDE,
            origin: GridOrigin::default(),
            cells: Vec::new(),
        };
    }
    let (width, height) = (width as usize, height as usize);
    // The lowest and the leftmost wall run through cell centers.
    let origin = GridOrigin { x: low.0 - 1.5 * SIDE, y: low.1 - 1.5 * SIDE, heading: 0.0 };
    let mut grid = Grid { width, height, resolution: SIDE, origin, cells: vec![Some(0.0); width * height] };
    for wall in walls {
        let [from, to] = wall.ends();
        let steps = (from.distance(to) / (0.5 * SIDE)).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let part = step as f64 / steps as f64;
            let at = Point::<surepose::geometry::Map, f64>::new(
                from.x + part * (to.x - from.x),
                from.y + part * (to.y - from.y),
            );
            if let Some((column, row)) = grid.cell_at(at.x, at.y) {
                grid.cells[row * width + column] = Some(1.0);
            }
        }
    }
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_are_rasterized_at_their_positions() {
        let wall = |a: (f64, f64), b: (f64, f64)| {
            Wall::between(Point::new(a.0, a.1), Point::new(b.0, b.1)).expect("a wall")
        };
        let grid = rasterize(&[wall((1.0, 1.0), (4.0, 1.0)), wall((4.0, 1.0), (4.0, 3.0))]);
        let occupancy =
            |x: f64, y: f64| grid.cell_at(x, y).and_then(|(column, row)| grid.occupancy(column, row));
        for at in [(1.0, 1.0), (2.53, 1.0), (4.0, 1.0), (4.0, 2.17), (4.0, 3.0)] {
            assert_eq!(occupancy(at.0, at.1), Some(1.0), "{at:?}");
        }
        assert_eq!(grid.cells.iter().flatten().filter(|cell| **cell > 0.5).count(), 31 + 20);
        assert_eq!(occupancy(2.0, 2.0), Some(0.0));
        assert!(rasterize(&[]).cells.is_empty());
        assert!(rasterize(&[wall((0.0, 0.0), (2e4, 2e4))]).cells.is_empty());
    }
}
