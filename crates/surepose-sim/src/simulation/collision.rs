//! Whether a wall stands in the robot's way: the drive brakes before it, whatever law and supervisor want.
//!
//! In simulation it is told the true pose, as the protective field of a safety scanner knows it: an estimate that is wrong
//! must not excuse a collision. A robot has its estimate, and needs that scanner besides.

use crate::{Arena, MotorModel};
use surepose::closed_loop::Controller;
use surepose::{Body, Integration, Map, Motion, Point, Pose, Twist};

/// The nearest that the robot's middle comes to a wall in any way that it is let go \[m]: wheels slip.
const MIN_CLEARANCE: f64 = 0.05;

/// By how much ways are longer than the wheels are told, at the most: slip, and motors that overshoot.
const SLACK: f64 = 1.2;

/// The way ahead is looked at in steps of this length \[m], of which there are so many at the most.
const STEP: f64 = 0.02;
const MAX_STEPS: f64 = 1000.0;

/// Whether a robot at `pose` that drives on with `twist` for a period, and then brakes, comes too near to a wall.
pub(super) fn is_blocked(
    arena: &Arena,
    pose: Pose<Map, Body, f64>,
    twist: Twist<f64>,
    controller: &Controller<f64>,
) -> bool {
    let mut here = pose.origin();
    stopping_trajectory(pose, twist, controller).any(|next| {
        // A robot that stands too near may drive away.
        let clearance = arena.clearance(next);
        let too_near = clearance < MIN_CLEARANCE && clearance < arena.clearance(here);
        let blocked = too_near || arena.first_wall_crossed(here, next).is_some();
        here = next;
        blocked
    })
}

/// Where the middle of a robot at `pose` comes that drives on with `twist` for a period, and then brakes: point by point, at
/// the farthest.
pub fn stopping_trajectory(
    pose: Pose<Map, Body, f64>,
    twist: Twist<f64>,
    controller: &Controller<f64>,
) -> impl Iterator<Item = Point<Map, f64>> {
    // Braking from full speed to rest at a constant rate goes half as far as driving on for as long.
    let rim = controller.drive.wheel_speeds_from_twist(twist).max_abs();
    let braking = 0.5 * rim / controller.limits.wheel_acceleration;
    let way = twist.integrate_for(SLACK * (controller.period + MotorModel::default().lag + braking));
    let steps = (way.length.abs() / STEP).ceil().clamp(1.0, MAX_STEPS);
    (1..=steps as usize).map(move |k| {
        let part = k as f64 / steps;
        let motion = Motion { length: part * way.length, turn: part * way.turn };
        pose.integrate(motion, Integration::Arc).origin()
    })
}
