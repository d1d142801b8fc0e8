//! What is around the robot: the walls of its map, and what stands there besides.

use surepose::{Body, Goal, Map, Pose, Stamp, Wall};
use surepose_data::wall_map::WallMap;
use surepose_lab::replay::walls_of;
use surepose_lab::rig::Localisation;
use surepose_sim::{Arena, Segment};

use super::inbox::LaserScan;
use super::lookout::Lookout;
use crate::convert::Refused;

/// A goal that is nearer to a wall than this has no room for the robot's middle \[m].
const LEAST_CLEARANCE: f64 = 0.05;

/// The map, where there is one, and what was seen that is not on it.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    pub(super) walls: Vec<Wall<f64>>,
    pub(super) arena: Option<Arena>,
    pub(super) lookout: Lookout,
}

impl Surroundings {
    /// The walls of `map`; the robot's middle needs so much `room` \[m].
    pub(super) fn of(map: Option<&WallMap>, room: f64) -> Self {
        let arena = map.map(|map| {
            let end = |[x, y]: [f64; 2]| (x, y);
            let walls = map.walls.iter().map(|wall| Segment::between(end(wall.from), end(wall.to)));
            Arena::of_walls("map", walls.collect())
        });
        let walls = map.map(walls_of).unwrap_or_default();
        Self { walls, arena, lookout: Lookout::with_room(room) }
    }

    /// Whether there is a map.
    pub(super) fn are_known(&self) -> bool {
        self.arena.is_some()
    }

    /// Whether there is room for the robot at `goal`.
    pub(super) fn have_room(&self, goal: Pose<Map, Goal, f64>) -> Result<(), Refused> {
        let needed = LEAST_CLEARANCE;
        match self.arena.as_ref().map(|arena| arena.clearance(goal.origin())) {
            Some(clearance) if clearance < needed => Err(Refused::NoRoom { clearance, needed }),
            _ => Ok(()),
        }
    }

    /// A wall on the straight way from `here` to `goal`.
    pub(super) fn wall_between(
        &self,
        here: Pose<Map, Body, f64>,
        goal: Pose<Map, Goal, f64>,
    ) -> Option<&Segment> {
        self.arena.as_ref()?.met_between(here.origin(), goal.origin())
    }

    /// Takes in a scan, from where the laser is believed to have been when it was taken; or, before what is remembered, from
    /// where it is now: what stands in the way is better seen roughly there than not at all.
    pub(super) fn look(&mut self, taken: Stamp, scan: &LaserScan, localiser: &Localisation) {
        let Some(arena) = &self.arena else { return };
        let estimator = &localiser.estimator;
        let map_from_body = estimator.belief_at(taken).unwrap_or_else(|| estimator.belief()).pose;
        let map_from_laser = map_from_body * localiser.eye.laser.body_from_laser;
        self.lookout.look(taken, scan, map_from_laser, arena);
    }
}
