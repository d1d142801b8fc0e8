//! Time-optimal trajectories of a differential drive with bounded wheel speed: [BalkcomMason2002].
//!
//! Each wheel's speed is bounded by V, acceleration is unbounded. Let 2b be the wheel separation. A straight
//! of length s and a turn in place by a take (|s| + b·|a|)/V. A fastest trajectory consists of these only:
//! [BalkcomMason2002], with at most 4 actions of which at most 2 are straights. The words of this form are
//! turn–straight–turn–straight and its time reversal; shorter words have actions of length 0.
//!
//! One direction then remains free, and the time is piecewise smooth in it. Coordinates are relative to the
//! goal, with the x axis along the last straight, (x, y) the remaining displacement, and β the direction of
//! the first straight:
//!
//! T(β)·V = |y / sin β| + |x − y / tan β| + b·(|β − β₀| + |β|)
//!
//! The minimum is at a boundary of a piece, or where the derivative is 0: |y|·(1 ∓ cos β)/sin²β = 2b, which
//! is |cos β| = |1 − |y|/2b|. All candidates are evaluated.

use std::f64::consts::PI;

use surepose::geometry::{Angle, Body, Goal, Pose};
use surepose::kinematics::DiffDrive;

/// An action of a time-optimal trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OptimalAction {
    /// Turn on the spot, counter-clockwise \[rad].
    Turn(f64),
    /// Drive straight, forward \[m].
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

/// Turn from `first` to `direction`, straight, turn to the goal's heading, straight: covers (`x`, `y`) \[m].
fn word(x: f64, y: f64, first: Angle<f64>, direction: Angle<f64>) -> Option<[OptimalAction; 4]> {
    let (sin, cos) = direction.sin_cos();
    // A straight along the goal's axis cannot move sideways; one nearly parallel to it would be arbitrarily
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

/// Returns the rim travel of the faster wheel \[m].
fn length(word: &[OptimalAction; 4], half_separation: f64) -> f64 {
    word.iter()
        .map(|action| match action {
            OptimalAction::Turn(angle) => half_separation * angle.abs(),
            OptimalAction::Straight(distance) => distance.abs(),
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use surepose::geometry::{Angle, Body, Goal, Pose};
    use surepose::kinematics::{DiffDrive, Integration, Motion};

    use crate::Seed;

    use super::{OptimalAction, fastest};

    const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
    const HALF: f64 = 0.3;
    const SPEED: f64 = 0.3;

    fn pose(x: f64, y: f64, heading: f64) -> Pose<Goal, Body, f64> {
        Pose::new(x, y, Angle::from_radians(heading))
    }

    fn time(x: f64, y: f64, heading: f64) -> f64 {
        fastest(pose(x, y, heading), &DRIVE, SPEED).time
    }

    fn random(seed: u64, size: f64, count: usize) -> impl Iterator<Item = Pose<Goal, Body, f64>> {
        let mut stream = Seed(seed).stream("starts");
        (0..count).map(move |_| {
            pose(stream.uniform(-size, size), stream.uniform(-size, size), stream.uniform(-PI, PI))
        })
    }

    /// Minimum rim travel over a scan of the direction of the first straight, computed independently.
    fn scanned(x: f64, y: f64, first: f64, samples: usize) -> f64 {
        let turn = |a: f64| Angle::from_radians(a).radians().abs();
        (0..samples)
            .map(|k| {
                let direction = (k as f64 + 0.5) / samples as f64 * 2.0 * PI;
                let one = y / direction.sin();
                let two = x - one * direction.cos();
                one.abs() + two.abs() + HALF * (turn(direction - first) + turn(direction))
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn known_trajectories_have_their_closed_form_time() {
        let cases = [
            (pose(-1.0, 0.0, 0.0), 1.0 / SPEED, "straight on"),
            (pose(1.0, 0.0, 0.0), 1.0 / SPEED, "straight back"),
            (pose(0.0, 0.0, 2.0), 2.0 * HALF / SPEED, "turn on the spot"),
            (pose(0.0, 0.0, PI), PI * HALF / SPEED, "half a turn"),
            (pose(-1.0, -1.0, PI / 4.0), (2f64.sqrt() + HALF * PI / 4.0) / SPEED, "straight, turn"),
            (pose(-3.0, 0.0, PI / 2.0), (3.0 + HALF * PI / 2.0) / SPEED, "turn, straight"),
            // 1 m aside: turn by 90°, drive, turn back.
            (pose(0.0, -1.0, 0.0), (1.0 + HALF * PI) / SPEED, "aside"),
        ];
        for (start, expected, what) in cases {
            let found = fastest(start, &DRIVE, SPEED).time;
            assert!((found - expected).abs() < 1e-9, "{what}: {found} s, expected {expected} s");
        }
        assert!(fastest(pose(0.0, 0.0, 0.0), &DRIVE, SPEED).time.abs() < 1e-12);
    }

    /// For a small sideways offset, two straights with a small turn between them beat two large turns.
    #[test]
    fn parallel_parking_uses_two_straights() {
        let best = fastest(pose(0.0, -0.05, 0.0), &DRIVE, SPEED);
        assert!(best.time < 0.9 * (0.05 + HALF * PI) / SPEED, "{best:?}");
        let straights =
            best.actions.iter().filter(|a| matches!(a, OptimalAction::Straight(s) if s.abs() > 1e-6));
        assert_eq!(straights.count(), 2, "{best:?}");
    }

    /// The returned actions are feasible and end at the goal.
    #[test]
    fn the_trajectory_ends_at_the_goal() {
        for start in random(1, 3.0, 2000).chain(random(2, 0.2, 2000)) {
            let best = fastest(start, &DRIVE, SPEED);
            let (mut at, mut rolled) = (start, 0.0);
            for action in best.actions {
                let motion = match action {
                    OptimalAction::Turn(turn) => Motion { length: 0.0, turn },
                    OptimalAction::Straight(length) => Motion { length, turn: 0.0 },
                };
                rolled += motion.length.abs() + HALF * motion.turn.abs();
                at = at.integrate(motion, Integration::Arc);
            }
            assert!(at.x.abs() < 1e-7 && at.y.abs() < 1e-7 && at.heading.radians().abs() < 1e-9, "{best:?}");
            assert!((rolled / SPEED - best.time).abs() < 1e-9);
        }
    }

    /// A scan over the free direction finds no faster trajectory, and confirms the minimum.
    #[test]
    fn no_direction_is_faster() {
        for start in random(3, 3.0, 300).chain(random(4, 0.2, 300)) {
            let found = fastest(start, &DRIVE, SPEED).time * SPEED;
            let back = start.inverse();
            let last = start.heading.radians();
            let scan =
                scanned(-start.x, -start.y, last, 20_000).min(scanned(-back.x, -back.y, -last, 20_000));
            assert!(found <= scan + 1e-12, "{start:?}: {found} m, but the scan finds {scan} m");
            assert!(scan - found < 0.003, "{start:?}: {found} m is too far below the scan's {scan} m");
        }
    }

    /// No trajectory is shorter than the straight line, or turns by less than the heading difference.
    #[test]
    fn time_is_at_least_that_of_distance_and_of_turn() {
        for start in random(5, 3.0, 2000) {
            let found = fastest(start, &DRIVE, SPEED).time * SPEED;
            let least = start.x.hypot(start.y).max(HALF * start.heading.radians().abs());
            assert!(found >= least - 1e-12);
        }
    }

    #[test]
    fn mirror_images_take_as_long() {
        for start in random(6, 3.0, 2000) {
            let (x, y, h) = (start.x, start.y, start.heading.radians());
            let found = time(x, y, h);
            // Reflected in the goal's axis, and driven backward.
            assert!((time(x, -y, -h) - found).abs() < 1e-9);
            assert!((time(-x, y, -h) - found).abs() < 1e-9);
        }
    }
}
