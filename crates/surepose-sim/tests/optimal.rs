//! The time-optimal bound of the core, from seeded random starts.

use std::f64::consts::PI;

use surepose::geometry::{Angle, Body, Goal, Pose};
use surepose::kinematics::{DiffDrive, Integration, Motion};
use surepose::optimal::{OptimalAction, fastest};
use surepose_sim::Seed;

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
    (0..count)
        .map(move |_| pose(stream.uniform(-size, size), stream.uniform(-size, size), stream.uniform(-PI, PI)))
}

/// The wheel's way over the word with `direction` of the first straight, written anew from geometry.
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
fn known_trajectories() {
    let cases = [
        (pose(-1.0, 0.0, 0.0), 1.0 / SPEED, "straight on"),
        (pose(1.0, 0.0, 0.0), 1.0 / SPEED, "straight back"),
        (pose(0.0, 0.0, 2.0), 2.0 * HALF / SPEED, "turn on the spot"),
        (pose(0.0, 0.0, PI), PI * HALF / SPEED, "half a turn"),
        (pose(-1.0, -1.0, PI / 4.0), (2f64.sqrt() + HALF * PI / 4.0) / SPEED, "straight, turn"),
        (pose(-3.0, 0.0, PI / 2.0), (3.0 + HALF * PI / 2.0) / SPEED, "turn, straight"),
        // A metre aside: turn by 90°, drive, turn back.
        (pose(0.0, -1.0, 0.0), (1.0 + HALF * PI) / SPEED, "aside"),
    ];
    for (start, expected, what) in cases {
        let found = fastest(start, &DRIVE, SPEED).time;
        assert!((found - expected).abs() < 1e-9, "{what}: {found} s, expected {expected} s");
    }
    assert!(fastest(pose(0.0, 0.0, 0.0), &DRIVE, SPEED).time.abs() < 1e-12);
}

/// A little aside, two straights with a small turn between beat turning round twice.
#[test]
fn parallel_parking_uses_two_straights() {
    let best = fastest(pose(0.0, -0.05, 0.0), &DRIVE, SPEED);
    assert!(best.time < 0.9 * (0.05 + HALF * PI) / SPEED, "{best:?}");
    let straights = best.actions.iter().filter(|a| matches!(a, OptimalAction::Straight(s) if s.abs() > 1e-6));
    assert_eq!(straights.count(), 2, "{best:?}");
}

/// The claimed trajectory can be driven.
#[test]
fn the_trajectory_ends_on_the_goal() {
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

/// The candidates miss no minimum: a scan over the free direction finds nothing faster, and comes close.
#[test]
fn no_direction_is_faster() {
    for start in random(3, 3.0, 300).chain(random(4, 0.2, 300)) {
        let found = fastest(start, &DRIVE, SPEED).time * SPEED;
        let back = start.inverse();
        let last = start.heading.radians();
        let scan = scanned(-start.x, -start.y, last, 20_000).min(scanned(-back.x, -back.y, -last, 20_000));
        assert!(found <= scan + 1e-12, "{start:?}: {found} m, and the scan finds {scan} m");
        assert!(scan - found < 0.003, "{start:?}: {found} m is more than {scan} m allow");
    }
}

/// No trajectory is shorter than the straight line, or turns less than the headings differ.
#[test]
fn it_is_no_less_than_distance_and_turn() {
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
        // Reflected in the goal's axis, and driven backwards in space.
        assert!((time(x, -y, -h) - found).abs() < 1e-9);
        assert!((time(-x, y, -h) - found).abs() < 1e-9);
    }
}
