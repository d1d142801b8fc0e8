//! A laser that sends scans and sees nothing, against one that has nothing to see.

#![allow(clippy::unwrap_used, reason = "tests panic on failed preconditions")]

use proptest::prelude::*;
use surepose::estimation::Belief;
use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::kinematics::Motion;
use surepose::lidar::{RangeFinder, Scan};
use surepose::map::Wall;
use surepose::safety::{LaserMonitor, LaserMonitorConfig};
use surepose::time::Stamp;

const CONFIG: LaserMonitorConfig<f64> =
    LaserMonitorConfig { blind_timeout: 0.3, scan_timeout: 1.0, min_valid_beams: 0.1 };
const BEAMS: usize = 181;
const STEP: f64 = std::f64::consts::PI / (BEAMS - 1) as f64;
const RANGE_MAX: f64 = 8.0;
const REST: Motion<f64> = Motion { length: 0.0, turn: 0.0 };
const DRIVE: Motion<f64> = Motion { length: 0.03, turn: 0.0 };

fn laser() -> RangeFinder<f64> {
    RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: 0.03,
        bearing_std: 0.004,
        range_min: 0.05,
        range_max: RANGE_MAX,
    }
}

/// A square room with its center at the origin.
fn room(half: f64) -> Vec<Wall<f64>> {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)];
    let ends = corners.map(|(x, y)| Point::new(x, y));
    ends.windows(2).filter_map(|ends| Wall::between(ends[0], ends[1]).ok()).collect()
}

/// Noise-free ranges in a square room; infinite beyond the range of the laser.
fn ranges(pose: Pose<Map, Body, f64>, half: f64) -> Vec<f64> {
    let range = |beam: usize| {
        let bearing = STEP * beam as f64 - std::f64::consts::FRAC_PI_2;
        let (sin, cos) = pose.heading.rotated_by(bearing).sin_cos();
        let to = |at: f64, direction: f64| (half * direction.signum() - at) / direction;
        let range = to(pose.x, cos).min(to(pose.y, sin));
        if range <= RANGE_MAX { range } else { f64::INFINITY }
    };
    (0..BEAMS).map(range).collect()
}

fn scan(ranges: &[f64]) -> Scan<'_, f64> {
    Scan::new(Angle::from_degrees(-90.0), STEP, ranges)
}

/// The monitor, its clock and a robot at the origin of a square room.
struct Trial {
    monitor: LaserMonitor<f64>,
    now: f64,
    walls: Vec<Wall<f64>>,
    half: f64,
}

impl Trial {
    fn in_room(half: f64) -> Self {
        Self { monitor: LaserMonitor::new(CONFIG), now: 0.0, walls: room(half), half }
    }

    /// A scan after 0.1 s, in which the robot moved; whether the laser is blind then.
    fn step(&mut self, scan: &Scan<'_, f64>, motion: Motion<f64>) -> bool {
        self.now += 0.1;
        let now = Stamp::from_seconds(self.now);
        let belief = Belief::new(Pose::identity(), [0.02, 0.02, 0.01]);
        self.monitor.on_motion(motion);
        self.monitor.on_scan(now, &laser(), scan, Some(&belief), &self.walls);
        self.monitor.is_blind(now)
    }

    /// Time from the first of these scans until the laser is blind \[s]; `None` if it is not within 2 s.
    fn time_to_blind(&mut self, scan: &Scan<'_, f64>, motion: Motion<f64>) -> Option<f64> {
        (0..20).find(|_| self.step(scan, motion)).map(|steps| 0.1 * f64::from(steps))
    }

    /// A second of good scans.
    fn warmed_up(mut self) -> Self {
        for step in 0..10 {
            let seen = ranges(Pose::new(0.01 * f64::from(step), 0.0, Angle::zero()), self.half);
            assert!(!self.step(&scan(&seen), DRIVE));
        }
        self
    }
}

#[test]
fn scans_that_show_nothing_are_noticed_within_the_timeout() {
    let constants = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 0.01, 100.0];
    for warm in [false, true] {
        let trial = || if warm { Trial::in_room(2.0).warmed_up() } else { Trial::in_room(2.0) };
        for value in constants {
            for motion in [REST, DRIVE] {
                let time = trial().time_to_blind(&scan(&[value; BEAMS]), motion);
                assert!(time.is_some_and(|time| (0.29..0.5).contains(&time)), "{value}: {time:?}");
            }
        }
        assert!(trial().time_to_blind(&scan(&[]), DRIVE).is_some());
        let seen = ranges(Pose::identity(), 2.0);
        let even = scan(&seen);
        for step in [0.0, f64::NAN, f64::INFINITY, 1.0, 0.5] {
            let broken = Scan { angle_increment: step, ..even };
            assert!(trial().time_to_blind(&broken, REST).is_some(), "{step}");
        }
        for time_increment in [-0.001, f64::NAN, 1.0] {
            assert!(trial().time_to_blind(&Scan { time_increment, ..even }, REST).is_some());
        }
    }
}

#[test]
fn two_valid_beams_are_too_few() {
    for other in [f64::NAN, f64::INFINITY, 0.0] {
        let mut seen = vec![other; BEAMS];
        (seen[40], seen[140]) = (1.5, 2.0);
        assert!(Trial::in_room(2.0).warmed_up().time_to_blind(&scan(&seen), DRIVE).is_some(), "{other}");
    }
}

#[test]
fn frozen_scans_are_noticed_once_the_robot_has_moved() {
    let seen = ranges(Pose::identity(), 2.0);
    for motion in [DRIVE, Motion { length: 0.0, turn: 0.02 }, Motion { length: -0.02, turn: 0.0 }] {
        let mut trial = Trial::in_room(2.0).warmed_up();
        let time = trial.time_to_blind(&scan(&seen), motion);
        assert!(time.is_some_and(|time| time <= 0.6), "{motion:?}: {time:?}");
        // At rest it stays blind, until the scans change for the time-out.
        assert!((0..100).all(|_| trial.step(&scan(&seen), REST)));
        let mut other = seen.clone();
        for step in 0..3 {
            other[7] += 0.001;
            assert!(trial.step(&scan(&other), REST), "{step}");
        }
        other[7] += 0.001;
        assert!(!trial.step(&scan(&other), REST));
    }
}

#[test]
fn noise_free_laser_at_rest_is_not_blind() {
    let mut trial = Trial::in_room(2.0).warmed_up();
    let seen = ranges(Pose::identity(), 2.0);
    // Encoders that jitter by a tick, for ten minutes.
    for step in 0..6000 {
        let tick = if step % 2 == 0 { 1e-3 } else { -1e-3 };
        assert!(!trial.step(&scan(&seen), Motion { length: tick, turn: tick }), "{step}");
    }
}

/// No wall is in range, and no beam returns: whatever the robot does, the laser is not blind.
#[test]
fn open_space_is_not_blindness() {
    for motion in [REST, DRIVE, Motion { length: 0.0, turn: 0.1 }] {
        for value in [f64::INFINITY, 0.0, 65.0] {
            let mut trial = Trial::in_room(30.0);
            assert_eq!(trial.time_to_blind(&scan(&[value; BEAMS]), motion), None, "{value}");
            // Also with walls that were seen before, from elsewhere.
            let mut trial = Trial { walls: room(30.0), half: 30.0, ..Trial::in_room(2.0).warmed_up() };
            assert_eq!(trial.time_to_blind(&scan(&[value; BEAMS]), motion), None, "{value}");
        }
    }
}

#[test]
fn a_single_bad_scan_and_a_missing_laser_are_not_blindness() {
    let mut trial = Trial::in_room(2.0).warmed_up();
    let void = [f64::NAN; BEAMS];
    for step in 0..50 {
        let seen = ranges(Pose::new(0.001 * f64::from(step), 0.0, Angle::zero()), 2.0);
        assert!(!trial.step(&scan(&void), REST) && !trial.step(&scan(&seen), REST), "{step}");
    }
    for _ in 0..5 {
        trial.step(&scan(&void), REST);
    }
    let later = |seconds| Stamp::from_seconds(trial.now + seconds);
    assert!(trial.monitor.is_blind(later(0.9)) && !trial.monitor.is_blind(later(1.1)));
}

proptest! {
    /// Whatever comes, the monitor does not panic; and good scans for the time-out end blindness.
    #[test]
    fn good_scans_end_any_blindness(
        bad in prop::collection::vec(prop::collection::vec(any::<f64>(), 0..40), 1..12),
        step in any::<f64>(),
        increment in any::<f64>(),
        length in any::<f64>(),
    ) {
        let mut trial = Trial::in_room(2.0);
        for ranges in &bad {
            let scan = Scan::new(Angle::zero(), step, ranges).with_time_increment(increment);
            trial.step(&scan, Motion { length, turn: length });
        }
        for step in 0..5 {
            let seen = ranges(Pose::new(0.01 * f64::from(step), 0.0, Angle::zero()), 2.0);
            trial.step(&scan(&seen), REST);
        }
        prop_assert!(!trial.monitor.is_blind(Stamp::from_seconds(trial.now)));
    }

    /// An honest laser is not blind, wherever the robot is in a room of any size, and however it moves.
    #[test]
    fn an_honest_laser_is_not_blind(
        half in 1.0_f64..40.0,
        x in -0.9_f64..0.9,
        y in -0.9_f64..0.9,
        heading in -3.1_f64..3.1,
        v in -0.05_f64..0.05,
        omega in -0.2_f64..0.2,
    ) {
        let mut monitor = LaserMonitor::new(CONFIG);
        let walls = room(half);
        let motion = Motion { length: v, turn: omega };
        let mut pose = Pose::new(x * half, y * half, Angle::from_radians(heading));
        for step in 0..30 {
            let now = Stamp::from_seconds(0.1 * f64::from(step));
            pose = pose.integrate(motion, surepose::kinematics::Integration::Arc);
            pose = Pose::new(pose.x.clamp(-0.95 * half, 0.95 * half), pose.y.clamp(-0.95 * half, 0.95 * half), pose.heading);
            monitor.on_motion(motion);
            let belief = Belief::new(pose, [0.02, 0.02, 0.01]);
            monitor.on_scan(now, &laser(), &scan(&ranges(pose, half)), Some(&belief), &walls);
            prop_assert!(!monitor.is_blind(now), "step {step} at {pose:?}");
        }
    }

    /// A laser that returns a tenth of the beams at random, or fewer, and NaN otherwise, is noticed.
    #[test]
    fn a_laser_without_valid_beams_is_noticed(valid in prop::collection::vec(0..BEAMS, 0..18), seed in 1..99_u32) {
        let mut trial = Trial::in_room(2.0).warmed_up();
        let seen = ranges(Pose::identity(), 2.0);
        let ranges: Vec<f64> = (0..BEAMS)
            .map(|beam| if valid.contains(&beam) { seen[beam] + 1e-4 * f64::from(seed) } else { f64::NAN })
            .collect();
        let time = trial.time_to_blind(&scan(&ranges), REST);
        prop_assert!(time.is_some_and(|time| time < 0.5), "{time:?}");
    }
}
