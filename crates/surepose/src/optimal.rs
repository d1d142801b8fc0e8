//! The shortest time in which any controller could have driven: [BalkcomMason2002].
//!
//! Each wheel's speed is bounded by V, acceleration is not. A robot of track 2b that drives straight by s and turns
//! on the spot by a needs (|s| + b·|a|)/V, and a fastest trajectory is made of nothing else: [BalkcomMason2002], with
//! at most 4 actions of which at most 2 are straight. The words of this form are turn–straight–turn–straight
//! and its mirror image in time; shorter words are these with an action of length 0.
//!
//! One action's direction is then free, and the time is made of pieces in it. Seen from the goal, whose x axis is the
//! direction of the last straight, with (x, y) still to go and β the direction of the first straight:
//!
//! T(β)·V = |y / sin β| + |x − y / tan β| + b·(|β − β₀| + |β|)
//!
//! Its least value is at an end of a piece, or where its derivative is 0: |y|·(1 ∓ cos β)/sin²β = 2b, which
//! is |cos β| = |1 − |y|/2b|. All of these are tried.

use core::f64::consts::PI;

use crate::geometry::{Angle, Body, Goal, Pose};
use crate::kinematics::DiffDrive;

/// One of the two ways to move that a fastest trajectory is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OptimalAction {
    /// Turn on the spot, counter-clockwise \[rad].
    Turn(f64),
    /// Drive straight, forward \[m].
    Straight(f64),
}

/// A fastest trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimal {
    /// How long it takes \[s].
    pub time: f64,
    /// What to do, in this order; some are of length 0.
    pub actions: [OptimalAction; 4],
}

/// The fastest trajectory from `start`, seen from the goal, to rest on the goal.
///
/// `wheel_speed` bounds the speed of each wheel's rim \[m/s], and is positive.
pub fn fastest(start: Pose<Goal, Body, f64>, drive: &DiffDrive<f64>, wheel_speed: f64) -> Optimal {
    let half_separation = 0.5 * drive.wheel_separation;
    let ends_straight = turn_straight_turn_straight(start, half_separation);
    // Driven backwards in time, the mirror image is a trajectory from the goal to the start.
    let back: Pose<Goal, Body, f64> = {
        let goal_from_start = start.inverse();
        Pose::new(goal_from_start.x, goal_from_start.y, goal_from_start.heading)
    };
    let starts_straight = undone(turn_straight_turn_straight(back, half_separation));
    let cost = |actions: &[OptimalAction; 4]| length(actions, half_separation);
    let actions = if cost(&starts_straight) < cost(&ends_straight) { starts_straight } else { ends_straight };
    Optimal { time: cost(&actions) / wheel_speed, actions }
}

/// The best word that ends with a straight.
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

/// Turn from `first` to `direction`, straight, turn to the goal's heading, straight: over (`x`, `y`) \[m].
fn word(x: f64, y: f64, first: Angle<f64>, direction: Angle<f64>) -> Option<[OptimalAction; 4]> {
    let (sin, cos) = direction.sin_cos();
    // A straight along the goal's axis cannot go aside; one nearly along it would go without end.
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

/// The same trajectory from its end to its start.
fn undone(word: [OptimalAction; 4]) -> [OptimalAction; 4] {
    let [a, b, c, d] = word.map(|action| match action {
        OptimalAction::Turn(angle) => OptimalAction::Turn(-angle),
        OptimalAction::Straight(distance) => OptimalAction::Straight(-distance),
    });
    [d, c, b, a]
}

/// What the faster wheel rolls \[m].
fn length(word: &[OptimalAction; 4], half_separation: f64) -> f64 {
    word.iter()
        .map(|action| match action {
            OptimalAction::Turn(angle) => half_separation * angle.abs(),
            OptimalAction::Straight(distance) => distance.abs(),
        })
        .sum()
}
