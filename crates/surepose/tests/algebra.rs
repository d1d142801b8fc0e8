//! Algebraic properties of poses, angles and motions.

use core::f64::consts::PI;

use proptest::prelude::*;
use surepose::geometry::{Angle, Body, Goal, Line, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Motion, Twist, WheelPair};
use surepose::scalar::Scalar;

type MapFromBody = Pose<Map, Body, f64>;

fn pose() -> impl Strategy<Value = MapFromBody> {
    (-50.0..50.0, -50.0..50.0, -10.0..10.0).prop_map(|(x, y, t)| Pose::new(x, y, Angle::from_radians(t)))
}

fn close(a: MapFromBody, b: MapFromBody, tolerance: f64) -> bool {
    (a.x - b.x).abs() < tolerance
        && (a.y - b.y).abs() < tolerance
        && (a.heading - b.heading).radians().abs() < tolerance
}

proptest! {
    #[test]
    fn wrapping_stays_in_range_and_keeps_the_direction(radians in -1e6..1e6_f64) {
        let angle = Angle::from_radians(radians);
        prop_assert!(angle.radians() > -PI && angle.radians() <= PI);
        let (sin, cos) = angle.sin_cos();
        // The rounding of an argument of 10⁶ limits the accuracy of its sine to 10⁻¹⁰.
        prop_assert!((sin - radians.sin()).abs() < 1e-9 && (cos - radians.cos()).abs() < 1e-9);
    }

    #[test]
    fn a_pose_and_its_inverse_cancel(pose in pose()) {
        let there_and_back = pose * pose.inverse() * pose;
        prop_assert!(close(there_and_back, pose, 1e-12));
    }

    #[test]
    fn composition_transforms_points_in_sequence(a in pose(), x in -9.0..9.0, y in -9.0..9.0, t in -3.0..3.0) {
        let body_from_goal: Pose<Body, Goal, f64> = Pose::new(x, y, Angle::from_radians(t));
        let point = Point::new(y, x);
        let at_once = (a * body_from_goal) * point;
        let in_turn = a * (body_from_goal * point);
        prop_assert!(at_once.distance(in_turn) < 1e-12);
    }

    #[test]
    fn two_half_arcs_make_the_whole(pose in pose(), length in -2.0..2.0, turn in -3.0..3.0) {
        let half = Motion { length: length / 2.0, turn: turn / 2.0 };
        let whole = Motion { length, turn };
        let in_two = pose.integrate(half, Integration::Arc).integrate(half, Integration::Arc);
        prop_assert!(close(in_two, pose.integrate(whole, Integration::Arc), 1e-12));
    }

    #[test]
    fn wheels_and_twist_are_inverse(v in -1.0..1.0, omega in -3.0..3.0, wheel_separation in 0.1..1.0) {
        let drive = DiffDrive::new(0.05, wheel_separation);
        let back = drive.twist_from_wheel_speeds(drive.wheel_speeds_from_twist(Twist::new(v, omega)));
        prop_assert!((back.v - v).abs() < 1e-14 && (back.omega - omega).abs() < 1e-13);
    }

    #[test]
    fn a_line_moves_with_its_points(pose in pose(), r in -5.0..5.0, t in -3.0..3.0, along in -4.0..4.0) {
        let line: Line<Body, f64> = Line::new(r, Angle::from_radians(t));
        let (nx, ny) = line.normal();
        let point = Point::new(nx * r - ny * along, ny * r + nx * along);
        prop_assert!(line.distance_from(point).abs() < 1e-12);
        prop_assert!((pose * line).distance_from(pose * point).abs() < 1e-10);
    }
}

/// The error of the midpoint rule is of third order in Δθ per step; the arc is exact. [Tran2012] Eq. (9).
#[test]
fn midpoint_rule_is_second_order() {
    let start: MapFromBody = Pose::identity();
    let error = |turn: f64| {
        let motion = Motion { length: turn, turn };
        let exact = Point::new(turn.sin(), 1.0 - turn.cos());
        let arc = start.integrate(motion, Integration::Arc).origin();
        assert!(arc.distance(exact) < 1e-15, "a circle of radius 1 does not close");
        start.integrate(motion, Integration::Midpoint).origin().distance(exact)
    };
    let ratio = error(0.2) / error(0.1);
    assert!((ratio - 8.0).abs() < 0.1, "halving the turn divides the error by {ratio}");
}

/// Values of the paper's robot: 0.3 m/s on both wheels for 0.1 s give 3 cm straight ahead, Eq. (7), (8).
#[test]
fn wheel_increments_match_the_paper() {
    let drive = DiffDrive::new(0.05, 0.6);
    let straight = drive.motion_from_travel(drive.wheel_travel_from_angle(WheelPair::new(0.6, 0.6)));
    assert!((straight.length - 0.03).abs() < 1e-15 && straight.turn.abs() < 1e-15);
    // With 0.05 m/s on one wheel, the robot turns by (0.03 − 0.005)/0.6 rad.
    let turning = drive.motion_from_travel(drive.wheel_travel_from_angle(WheelPair::new(0.6, 0.1)));
    assert!((turning.turn - 0.025 / 0.6).abs() < 1e-15);
}

/// On a straight path the larger wheel turns more slowly; Eq. (7), (8) invert the conversion.
#[test]
fn unequal_radii_give_unequal_wheel_angles() {
    let drive = DiffDrive { radius: WheelPair::new(0.06, 0.05), wheel_separation: 0.6 };
    let turns = drive.wheel_rates_from_twist(Twist::new(0.3, 0.0));
    assert!((turns.right - 5.0).abs() < 1e-14 && (turns.left - 6.0).abs() < 1e-14, "{turns:?}");
    let twist = drive.twist_from_wheel_speeds(
        drive.wheel_travel_from_angle(drive.wheel_rates_from_twist(Twist::new(0.2, -0.7))),
    );
    assert!((twist.v - 0.2).abs() < 1e-15 && (twist.omega + 0.7).abs() < 1e-14, "{twist:?}");
}

#[test]
fn sinc_is_continued_through_zero() {
    assert!((Scalar::sinc(0.0) - 1.0).abs() < 1e-16 && (Scalar::sinc(1e-300) - 1.0).abs() < 1e-16);
    for x in [1e-9, -1e-7, 1e-6, 1e-5, -1e-4, 1e-3, 1e-2] {
        // Taylor series; the next term is x⁶/5040.
        let series = 1.0 - x * x / 6.0 + x * x * x * x / 120.0;
        assert!((Scalar::sinc(x) - series).abs() < 1e-15, "at {x}");
        assert!((f64::from(Scalar::sinc(x as f32)) - series).abs() < 1.5e-7, "at {x} in f32");
    }
    assert!(Scalar::sinc(PI).abs() < 1e-15);
}

#[test]
fn wrapping_maps_minus_pi_to_pi() {
    assert!((Angle::from_radians(PI).radians() - PI).abs() < 1e-15);
    assert!((Angle::from_radians(-PI).radians() - PI).abs() < 1e-15);
    assert!((Angle::from_vector(-1.0, -0.0).radians() - PI).abs() < 1e-15);
}

/// NaN stays NaN, so that the filter can reject it.
#[test]
fn wrapping_a_non_finite_angle_is_nan() {
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Angle::from_radians(broken).radians().is_nan(), "{broken}");
        assert!(Angle::zero().rotated_by(broken).radians().is_nan(), "{broken}");
    }
    assert!(Angle::from_vector(f64::NAN, 1.0).radians().is_nan());
}
