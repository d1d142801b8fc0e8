//! What is around the robot: the walls of its map, and what stands there besides.

use surepose::{Body, Goal, Map, Pose, Stamp, Wall};
use surepose_io::wall_map::{WallMap, walls_from_map};
use surepose_sim::robot::SimLocalizer;
use surepose_sim::{Arena, WallSegment};

use super::measurement_queue::LaserScan;
use super::obstacle_monitor::ObstacleMonitor;
use crate::convert::MessageError;

/// A goal that is nearer to a wall than this has no room for the robot's middle \[m].
const MIN_CLEARANCE: f64 = 0.05;

/// The map, where there is one, and what was seen that is not on it.
#[derive(Clone, Debug)]
pub(super) struct Environment {
    pub(super) walls: Vec<Wall<f64>>,
    pub(super) arena: Option<Arena>,
    pub(super) obstacle_monitor: ObstacleMonitor,
}

impl Environment {
    /// The walls of `map`; the robot's middle needs so much `safety_radius` \[m].
    pub(super) fn from_map(map: Option<&WallMap>, safety_radius: f64) -> Self {
        let arena = map.map(|map| {
            let end = |[x, y]: [f64; 2]| (x, y);
            let walls = map.walls.iter().map(|wall| WallSegment::between(end(wall.from), end(wall.to)));
            Arena::from_walls("map", walls.collect())
        });
        let walls = map.map(walls_from_map).unwrap_or_default();
        Self { walls, arena, obstacle_monitor: ObstacleMonitor::with_safety_radius(safety_radius) }
    }

    /// Whether there is a map.
    pub(super) fn has_map(&self) -> bool {
        self.arena.is_some()
    }

    /// Whether there is room for the robot at `goal`.
    pub(super) fn check_clearance(&self, goal: Pose<Map, Goal, f64>) -> Result<(), MessageError> {
        let needed = MIN_CLEARANCE;
        match self.arena.as_ref().map(|arena| arena.clearance(goal.origin())) {
            Some(clearance) if clearance < needed => {
                Err(MessageError::InsufficientClearance { clearance, needed })
            }
            _ => Ok(()),
        }
    }

    /// A wall on the straight way from `here` to `goal`.
    pub(super) fn wall_between(
        &self,
        here: Pose<Map, Body, f64>,
        goal: Pose<Map, Goal, f64>,
    ) -> Option<&WallSegment> {
        self.arena.as_ref()?.first_wall_crossed(here.origin(), goal.origin())
    }

    /// Takes in a scan, from where the laser is believed to have been when it was taken; or, before what is remembered, from
    /// where it is now: what stands in the way is better seen roughly there than not at all.
    pub(super) fn look(&mut self, taken: Stamp, scan: &LaserScan, localizer: &SimLocalizer) {
        let Some(arena) = &self.arena else { return };
        let estimator = &localizer.estimator;
        let map_from_body = estimator.belief_at(taken).unwrap_or_else(|| estimator.belief()).pose;
        let map_from_laser = map_from_body * localizer.scan_processor.laser.body_from_laser;
        self.obstacle_monitor.look(taken, scan, map_from_laser, arena);
    }
}
