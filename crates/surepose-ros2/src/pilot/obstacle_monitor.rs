//! What stands in the robot's way that is on no map: people, boxes, doors. The robot brakes before it, whatever the law wants.
//!
//! It sees what the laser sees, in the plane of the laser and on its side, and is no substitute for a protective field.

use surepose::closed_loop::Controller;
use surepose::{Angle, Body, Laser, Map, Point, Pose, Stamp, Twist};
use surepose_sim::Arena;
use surepose_sim::simulation::stopping_trajectory;

use super::measurement_queue::LaserScan;

/// What is so near to a wall of the map \[m] may be that wall.
const WALL_TOLERANCE: f64 = 0.15;

/// Things farther than this from the laser \[m] are not in the way yet.
const MAX_OBSTACLE_RANGE: f64 = 3.0;

/// So many beams must end on something in the way: one may end on dust.
const MIN_BEAMS: usize = 2;

/// Things that no scan has shown again for so long \[s] are gone.
const MAX_OBSTACLE_AGE: f64 = 0.5;

/// A laser that says nothing for so long \[s] has failed: ten scans of a usual one.
const SCAN_TIMEOUT: f64 = 1.0;

/// What the last scan showed that is on no map.
#[derive(Clone, Debug)]
pub(super) struct ObstacleMonitor {
    safety_radius: f64,
    pub(super) obstacles: Vec<Point<Map, f64>>,
    pub(super) seen: Stamp,
}

impl ObstacleMonitor {
    /// A lookout for a robot whose middle needs so much room \[m]; 0 for none that looks out.
    pub(super) fn with_safety_radius(safety_radius: f64) -> Self {
        Self { safety_radius, obstacles: Vec::new(), seen: Stamp::default() }
    }

    /// Takes in a scan, taken from where the laser is believed to have been.
    pub(super) fn look(
        &mut self,
        taken: Stamp,
        scan: &LaserScan,
        map_from_laser: Pose<Map, Laser, f64>,
        arena: &Arena,
    ) {
        self.seen = taken;
        self.obstacles.clear();
        if self.safety_radius <= 0.0 {
            return;
        }
        let reach = scan.range_min..scan.range_max.min(MAX_OBSTACLE_RANGE);
        for (number, range) in scan.ranges.iter().enumerate().filter(|(_, range)| reach.contains(range)) {
            let bearing = Angle::from_radians(scan.angle_min + scan.angle_increment * number as f64);
            let (sin, cos) = bearing.sin_cos();
            let end = map_from_laser * Point::new(range * cos, range * sin);
            let to_wall = arena.nearest_wall(end).map_or(f64::INFINITY, |wall| wall.distance_to(end));
            if to_wall > WALL_TOLERANCE {
                self.obstacles.push(end);
            }
        }
    }

    /// Forgets what was seen too long before `now`, or by a clock that was set back since.
    pub(super) fn forget(&mut self, now: Stamp) {
        if now.since(self.seen).abs() > MAX_OBSTACLE_AGE {
            self.obstacles.clear();
        }
    }

    /// Whether it looks out, and has not seen anything for long.
    pub(super) fn is_blind(&self, now: Stamp) -> bool {
        self.safety_radius > 0.0 && now.since(self.seen).abs() > SCAN_TIMEOUT
    }

    /// Whether a robot at `pose` that drives on with `twist` comes too near to something before it can stand.
    pub(super) fn is_blocked(
        &self,
        pose: Pose<Map, Body, f64>,
        twist: Twist<f64>,
        controller: &Controller<f64>,
    ) -> bool {
        let here = pose.origin();
        stopping_trajectory(pose, twist, controller).any(|there| {
            // A robot that something stands too near to may drive away.
            let is_hit = |thing: &&Point<Map, f64>| {
                let distance = thing.distance(there);
                distance < self.safety_radius && distance < thing.distance(here)
            };
            self.obstacles.iter().filter(is_hit).count() >= MIN_BEAMS
        })
    }
}
