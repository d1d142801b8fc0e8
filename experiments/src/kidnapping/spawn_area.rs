//! Area of valid start poses.

use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose_io::grid::Grid;
use surepose_mapping::from_grid::extract_walls;
use surepose_sim::{Arena, Stream, WallSegment};

/// Minimum distance of a start pose from a wall \[m], so that the robot can turn in place.
const MIN_CLEARANCE: f64 = 0.5;

/// Occupancy probability below which a cell is free.
const FREE_THRESHOLD: f32 = 0.2;

/// An arena with its valid start positions.
#[derive(Clone, Debug)]
pub struct SpawnArea {
    /// The walls.
    pub arena: Arena,
    /// Free positions (x, y) \[m]; if empty, the whole rectangle of the arena is free.
    pub free: Vec<(f64, f64)>,
}

impl SpawnArea {
    /// Uses all of `arena` that is clear of its walls.
    pub fn anywhere(arena: Arena) -> Self {
        Self { arena, free: Vec::new() }
    }

    /// Uses the free cells of `grid` and the walls extracted from it.
    pub fn on_grid(name: &'static str, grid: &Grid) -> Self {
        let map = extract_walls(grid).map;
        let walls = map.walls.iter().map(|wall| WallSegment::between(wall.from.into(), wall.to.into()));
        let cells = (0..grid.height).flat_map(|row| (0..grid.width).map(move |column| (column, row)));
        let is_free =
            |&(column, row): &(usize, usize)| grid.occupancy(column, row).is_some_and(|p| p < FREE_THRESHOLD);
        let free = cells.filter(is_free).map(|(column, row)| grid.center(column, row)).collect();
        Self { arena: Arena::from_walls(name, walls.collect()), free }
    }

    /// Draws a pose that is clear of the walls.
    pub fn pose(&self, random: &mut Stream) -> Pose<Map, Body, f64> {
        loop {
            let (x, y) = self.position(random);
            let heading = Angle::from_degrees(random.uniform(-180.0, 180.0));
            if self.arena.clearance(Point::new(x, y)) >= MIN_CLEARANCE {
                return Pose::new(x, y, heading);
            }
        }
    }

    fn position(&self, random: &mut Stream) -> (f64, f64) {
        if self.free.is_empty() {
            let [low, high] = self.arena.corners();
            return (random.uniform(low.0, high.0), random.uniform(low.1, high.1));
        }
        let index = random.uniform(0.0, self.free.len() as f64) as usize;
        self.free.get(index).copied().unwrap_or_default()
    }
}
