//! Time-optimal trajectories of a differential drive with bounded wheel speed: [BalkcomMason2002].
//!
//! The speed of each wheel is bounded by V; acceleration is unbounded. Let 2b be the wheel separation. A straight
//! of length s and a turn in place by a take (|s| + b·|a|)/V. By [BalkcomMason2002] a fastest trajectory consists of
//! at most 4 such actions, at most 2 of them straights. The words of this form are
//! turn–straight–turn–straight and its time reversal; shorter words have actions of length 0.
//!
//! One direction then remains free, and the time is piecewise smooth in it. Coordinates are relative to the
//! goal, with the x axis along the last straight. (x, y) is the remaining displacement, and β the direction of
//! the first straight:
//!
//! T(β)·V = |y / sin β| + |x − y / tan β| + b·(|β − β₀| + |β|)
//!
//! The minimum is at a boundary of a piece, or where the derivative is 0: |y|·(1 ∓ cos β)/sin²β = 2b, which
//! is |cos β| = |1 − |y|/2b|. All candidates are evaluated.

use core::f64::consts::PI;

use crate::geometry::{Angle, Body, Goal, Pose};
use crate::kinematics::DiffDrive;

/// An action of a time-optimal trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OptimalAction {
    /// Turn in place, counter-clockwise \[rad].
    Turn(f64),
    /// Straight drive, positive forward \[m].
    Straight(f64),
}

/// A time-optimal trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimal {
    /// Duration \[s].
    pub time: f64,
    /// Actions in order; some have length 0.
    pub actions: [OptimalAction; 4],
}

/// Returns the time-optimal trajectory from `start`, relative to the goal, to rest at the goal.
///
/// `wheel_speed` is the maximum rim speed of each wheel \[m/s], positive.
pub fn fastest(start: Pose<Goal, Body, f64>, drive: &DiffDrive<f64>, wheel_speed: f64) -> Optimal {
    let half_separation = 0.5 * drive.wheel_separation;
    let ends_straight = turn_straight_turn_straight(start, half_separation);
    // In reversed time, the mirror image is a trajectory from the goal to the start.
    let back: Pose<Goal, Body, f64> = {
        let goal_from_start = start.inverse();
        Pose::new(goal_from_start.x, goal_from_start.y, goal_from_start.heading)
    };
    let starts_straight = undone(turn_straight_turn_straight(back, half_separation));
    let cost = |actions: &[OptimalAction; 4]| length(actions, half_separation);
    let actions = if cost(&starts_straight) < cost(&ends_straight) { starts_straight } else { ends_straight };
    Optimal { time: cost(&actions) / wheel_speed, actions }
}

/// Returns the best word that ends with a straight.
fn turn_straight_turn_straight(start: Pose<Goal, Body, f64>, half_separation: f64) -> [OptimalAction; 4] {
    let (x, y, first) = (-start.x, -start.y, start.heading);
    let along = libm::atan2(y, x);
    let level = 1.0 - y.abs() / (2.0 * half_separation);
    let stationary = libm::acos(level.clamp(-1.0, 1.0));
    let candidates = [
        first.radians(),
        first.radians() + PI,
        along,
        along + PI,
        0.0,
        stationary,
        -stationary,
        PI - stationary,
        stationary - PI,
    ];
    let mut best = ([OptimalAction::Turn(0.0); 4], f64::INFINITY);
    for direction in candidates {
        if let Some(word) = word(x, y, first, Angle::from_radians(direction)) {
            let cost = length(&word, half_separation);
            if cost < best.1 {
                best = (word, cost);
            }
        }
    }
    best.0
}

/// Turn from `first` to `direction`, straight, turn to the heading of the goal, straight: covers (`x`, `y`) \[m].
fn word(x: f64, y: f64, first: Angle<f64>, direction: Angle<f64>) -> Option<[OptimalAction; 4]> {
    let (sin, cos) = direction.sin_cos();
    // A straight along the axis of the goal has no lateral displacement; one nearly parallel to it would be arbitrarily
    // long.
    let (one, two) = if y.abs() <= 1e-12 {
        (0.0, x)
    } else if sin.abs() < 1e-9 {
        return None;
    } else {
        (y / sin, x - y * cos / sin)
    };
    Some([
        OptimalAction::Turn((direction - first).radians()),
        OptimalAction::Straight(one),
        OptimalAction::Turn((-direction).radians()),
        OptimalAction::Straight(two),
    ])
}

/// Reverses a trajectory in time.
fn undone(word: [OptimalAction; 4]) -> [OptimalAction; 4] {
    let [a, b, c, d] = word.map(|action| match action {
        OptimalAction::Turn(angle) => OptimalAction::Turn(-angle),
        OptimalAction::Straight(distance) => OptimalAction::Straight(-distance),
    });
    [d, c, b, a]
}

/// Returns the wheel travel of the faster wheel \[m].
fn length(word: &[OptimalAction; 4], half_separation: f64) -> f64 {
    word.iter()
        .map(|action| match action {
            OptimalAction::Turn(angle) => half_separation * angle.abs(),
            OptimalAction::Straight(distance) => distance.abs(),
        })
        .sum()
}
