//! Path controller: an invalid pose keeps the target, and accuracy does not degrade over a thousand laps.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use surepose::control::{Limits, Path, PathController, PathFollowingLaw, PathProgress};
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
use surepose::scalar::Float;

fn controller<S: Float>() -> PathController<S, 8> {
    let num = S::from_f64;
    let start = Pose::new(num(2.0), num(1.0), Angle::zero());
    PathController {
        drive: DiffDrive::new(num(0.05), num(0.6)),
        path: Path::rounded_rectangle(start, num(3.0), num(2.0), num(0.5)).unwrap(),
        law: PathFollowingLaw {
            speed: num(0.2),
            k_along: num(1.0),
            k_across: num(12.0),
            k_heading: num(2.1),
        },
        limits: Limits::symmetric(num(0.3), num(5.0)),
        period: num(0.1),
    }
}

/// Follows the path for `laps` with ideal wheels; returns the largest distance from the target after the first lap \[m].
fn max_path_error<S: Float>(laps: f64) -> f64 {
    let controller = controller::<S>();
    let start = controller.path.at(S::from_f64(0.0)).map_from_target;
    let mut pose: Pose<Map, Body, S> = Pose::new(start.x, start.y, start.heading);
    let (mut progress, mut most) = (PathProgress::<S>::new(), 0.0_f64);
    while progress.laps.to_f64() < laps {
        let (wheels, next) = controller.step(progress, pose);
        let rims = controller.drive.wheel_travel_from_angle(wheels.scaled(controller.period));
        pose = pose.integrate(controller.drive.motion_from_travel(rims), Integration::Arc);
        progress = next;
        let target = controller.path.at(progress.distance).map_from_target;
        if progress.laps.to_f64() >= 1.0 {
            most = most.max(pose.origin().distance(target.origin()).to_f64());
        }
        assert!(progress.distance < controller.path.length());
    }
    most
}

/// 9 km: a distance counted over all laps would have a resolution of 1 mm in `f32`, at steps of 20 mm.
#[test]
fn thousand_laps_match_the_first_in_f32() {
    let (first, all, exactly) =
        (max_path_error::<f32>(3.0), max_path_error::<f32>(1000.0), max_path_error::<f64>(3.0));
    assert!(first < 0.01 && (first - exactly).abs() < 1e-4, "{first} m, {exactly} m in f64");
    assert!(all < 2.0 * first, "{all} m after {first} m");
}

#[test]
fn invalid_pose_stops_the_wheels_and_the_target() {
    let controller = controller::<f64>();
    let start: Pose<Map, Body, f64> = Pose::new(2.0, 1.0, Angle::zero());
    let (wheels, before) = controller.step(PathProgress::new(), start);
    assert!(wheels.right > 0.0 && before.distance > 0.0);
    for invalid in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (wheels, waiting) = controller.step(before, Pose::new(invalid, 1.0, Angle::zero()));
        assert_eq!(
            (wheels, waiting),
            (WheelPair::zero(), PathProgress { limited: Twist::zero(), ..before }),
            "{invalid}"
        );
        let (wheels, after) = controller.step(waiting, start);
        assert!(wheels.right > 0.0 && after.distance > before.distance, "{invalid}: {after:?}");
    }
}
