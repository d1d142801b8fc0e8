//! Collision check: the largest speed from which the robot stops before walls and obstacles.
//!
//! The check predicts the path of the footprint while the robot drives on for one period, lets the drive respond and
//! brakes. It yields a cap on the rim speed; the [limits](crate::control::Limits) apply it.

use crate::control::Limits;
use crate::geometry::{Body, Map, Point, Pose};
use crate::kinematics::{DiffDrive, Integration, Motion, Twist};
use crate::map::Wall;
use crate::param;
use crate::scalar::Float;

use super::footprint::Footprint;

/// Distance between two poses of the predicted path \[m].
const PATH_STEP: f64 = 0.02;
/// The largest number of poses of the predicted path: bounds the work of one check.
const MAX_PATH_STEPS: f64 = 200.0;
/// Fractions of the desired speed that are tried, the largest first.
const SPEED_FRACTIONS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
/// Beams that must end on an obstacle: a single one may end on dust.
const MIN_OBSTACLE_BEAMS: usize = 2;

/// Constants of the collision check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionConfig<S> {
    /// Outline of the robot.
    pub footprint: Footprint<S>,
    /// Distance between footprint and walls that stays free \[m].
    pub wall_clearance: S,
    /// Distance between footprint and obstacles that stays free \[m].
    pub obstacle_clearance: S,
    /// Factor on predicted distances, ≥ 1: wheels slip and motors overshoot.
    pub travel_factor: S,
    /// Time from a command to the response of the drive \[s].
    pub response_time: S,
}

/// Reason for which the robot is blocked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlockReason {
    /// A wall of the map.
    Wall,
    /// An obstacle that the laser detects and the map does not contain.
    Obstacle,
    /// No scan arrived for the time-out, so that the obstacle check is unavailable.
    LaserTimeout,
    /// The laser sends scans that show nothing, so that the obstacle check is unavailable.
    LaserBlind,
}

impl BlockReason {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Obstacle => "obstacle",
            Self::LaserTimeout => "laser_timeout",
            Self::LaserBlind => "laser_blind",
        }
    }
}

/// Result of the collision check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedCap<S> {
    /// The largest rim speed that is allowed \[m/s]; 0 stops the robot, ∞ leaves the speed to the limits.
    pub rim_speed: S,
    /// Reason of a stop; `None` where `rim_speed` is positive.
    pub blocked_by: Option<BlockReason>,
}

impl<S: Float> SpeedCap<S> {
    /// No cap.
    pub fn unlimited() -> Self {
        Self { rim_speed: S::from_f64(f64::MAX), blocked_by: None }
    }

    /// A stop.
    pub fn stop(reason: BlockReason) -> Self {
        Self { rim_speed: S::from_f64(0.0), blocked_by: Some(reason) }
    }
}

/// Desired motion of the next period: input of the collision check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intent<'a, S> {
    /// Geometry of the drive.
    pub drive: &'a DiffDrive<S>,
    /// Limits of the wheels.
    pub limits: &'a Limits<S>,
    /// Control period \[s].
    pub period: S,
    /// Estimated pose.
    pub map_from_body: Pose<Map, Body, S>,
    /// Twist that the control law asks for.
    pub desired: Twist<S>,
    /// Twist commanded in the previous period.
    pub previous: Twist<S>,
}

impl<S: Float> CollisionConfig<S> {
    /// Defaults of the parameter table for a robot with this outline; obstacles keep the distance of walls.
    pub fn new(footprint: Footprint<S>) -> Self {
        let clearance = S::from_f64(param::WALL_CLEARANCE.default_si());
        Self {
            footprint,
            wall_clearance: clearance,
            obstacle_clearance: clearance,
            travel_factor: S::from_f64(param::TRAVEL_FACTOR.default_si()),
            response_time: S::from_f64(param::RESPONSE_TIME.default_si()),
        }
    }

    /// The largest cap, out of a few fractions of the desired speed, from which the robot stops before every wall and
    /// obstacle. A robot that already stands too close may drive away.
    ///
    /// The work is at most 4 · 200 distance evaluations per wall and per obstacle point within reach.
    pub fn speed_cap(
        &self,
        intent: &Intent<'_, S>,
        walls: &[Wall<S>],
        obstacles: &[Point<Map, S>],
    ) -> SpeedCap<S> {
        let Intent { drive, limits, period, desired, previous, .. } = *intent;
        let wanted = drive.wheel_speeds_from_twist(desired).max_abs();
        let previous = drive.wheel_speeds_from_twist(previous).max_abs();
        let fastest = wanted.min(limits.wheel_speed).min(previous + limits.wheel_acceleration * period);
        if wanted <= S::from_f64(0.0) || !wanted.is_finite() {
            return SpeedCap::unlimited();
        }
        let mut blocked_by = BlockReason::Wall;
        for fraction in SPEED_FRACTIONS {
            let cap = fastest * S::from_f64(fraction);
            // Until the wheels have slowed down they are faster than the cap.
            let rim_speed = cap.max(previous - limits.wheel_deceleration * period);
            let path = self.stopping_motion(intent, desired.scaled(rim_speed / wanted), rim_speed);
            match self.first_contact(intent.map_from_body, path, walls, obstacles) {
                None if fraction >= 1.0 => return SpeedCap::unlimited(),
                None => return SpeedCap { rim_speed: cap, blocked_by: None },
                Some(reason) => blocked_by = reason,
            }
        }
        SpeedCap::stop(blocked_by)
    }

    /// Distance from the footprint at `pose` to the nearest wall \[m]: 0 in contact, `None` without walls.
    ///
    /// Walls have no inside: a pose beyond the walls of a room has a distance, too.
    pub fn distance_to_walls(&self, pose: Pose<Map, Body, S>, walls: &[Wall<S>]) -> Option<S> {
        walls.iter().map(|wall| self.distance_to_wall(pose, wall)).reduce(S::min)
    }

    /// Motion of a robot that drives on with `twist` for a period and the response time, and then brakes to rest.
    fn stopping_motion(&self, intent: &Intent<'_, S>, twist: Twist<S>, rim_speed: S) -> Motion<S> {
        // Braking at a constant rate covers half the distance of driving on for as long.
        let braking = S::from_f64(0.5) * rim_speed / intent.limits.wheel_deceleration;
        twist.integrate_for(self.travel_factor * (intent.period + self.response_time + braking))
    }

    /// First wall or obstacle that the footprint comes too close to; `None` for a free path.
    fn first_contact(
        &self,
        start: Pose<Map, Body, S>,
        motion: Motion<S>,
        walls: &[Wall<S>],
        obstacles: &[Point<Map, S>],
    ) -> Option<BlockReason> {
        let radius = self.footprint.circumscribed_radius();
        let reach = |clearance: S| motion.length.abs() + radius + clearance;
        let poses = || {
            let sweep = motion.length.abs().max(motion.turn.abs() * radius);
            let steps = (sweep.to_f64() / PATH_STEP).clamp(1.0, MAX_PATH_STEPS) as u16 + 1;
            (1..=steps).map(move |step| {
                let fraction = S::from_f64(f64::from(step) / f64::from(steps));
                let part = Motion { length: motion.length * fraction, turn: motion.turn * fraction };
                start.integrate(part, Integration::Arc)
            })
        };
        let approaches = |clearance: S, distance: &dyn Fn(Pose<Map, Body, S>) -> S| {
            let before = distance(start);
            poses().map(distance).any(|after| after < clearance && after < before)
        };
        let wall_reach = reach(self.wall_clearance);
        let near_walls = walls.iter().filter(|wall| wall.distance(start.origin()) <= wall_reach);
        for wall in near_walls {
            if approaches(self.wall_clearance, &|pose| self.distance_to_wall(pose, wall)) {
                return Some(BlockReason::Wall);
            }
        }
        let clearance = self.obstacle_clearance;
        let near_points = obstacles.iter().filter(|point| point.distance(start.origin()) <= reach(clearance));
        let contacts =
            near_points.filter(|point| approaches(clearance, &|pose| self.distance_to_point(pose, **point)));
        (contacts.take(MIN_OBSTACLE_BEAMS).count() >= MIN_OBSTACLE_BEAMS).then_some(BlockReason::Obstacle)
    }

    fn distance_to_wall(&self, pose: Pose<Map, Body, S>, wall: &Wall<S>) -> S {
        match self.footprint {
            Footprint::Circle(radius) => (wall.distance(pose.origin()) - radius).max(S::from_f64(0.0)),
            Footprint::Polygon(_) => {
                let body_from_map = pose.inverse();
                self.footprint.distance_to_segment(wall.ends().map(|end| body_from_map * end))
            }
        }
    }

    fn distance_to_point(&self, pose: Pose<Map, Body, S>, point: Point<Map, S>) -> S {
        match self.footprint {
            Footprint::Circle(radius) => (point.distance(pose.origin()) - radius).max(S::from_f64(0.0)),
            Footprint::Polygon(_) => self.footprint.distance_to_point(pose.inverse() * point),
        }
    }
}

#[cfg(test)]
mod tests;
