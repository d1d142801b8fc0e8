//! Scans of a laser that sweeps while the robot moves.

#![allow(clippy::unwrap_used, reason = "tests panic on failed preconditions")]

use surepose::estimation::{
    Belief, DelayedEkf, Ekf, Gate, HeadingMeasurement, Measurement, MeasurementOutcome, RejectReason,
    SWEEP_KNOTS,
};
use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist};
use surepose::lidar::{Deskewer, RangeFinder, Scan, ScanTiming, StampedBeam};
use surepose::time::{Stamp, Stamped};

const BEAMS: usize = 271;
const SWEEP: f64 = 0.1;
const FIRST: f64 = -2.356_194_490_192_345;
const STEP: f64 = 1.5 * std::f64::consts::PI / (BEAMS - 1) as f64;
/// Time from one odometry to the next \[s]; no divisor of the sweep.
const PERIOD: f64 = 0.03;

type MapPose = Pose<Map, Body, f64>;
type Filter = DelayedEkf<f64, 64>;

fn laser() -> RangeFinder<f64> {
    let body_from_laser = Pose::new(0.2, -0.1, Angle::from_degrees(20.0));
    RangeFinder { body_from_laser, range_std: 0.03, bearing_std: 0.004, range_min: 0.05, range_max: 30.0 }
}

/// Pose of a robot that moves at `twist` since time 0 \[s].
fn pose(twist: Twist<f64>, time: f64) -> MapPose {
    Pose::new(2.5, 1.5, Angle::from_degrees(31.3)).integrate(twist.integrate_for(time), Integration::Arc)
}

/// Range of a beam from `pose` to the walls of a room of 6 m by 4 m.
fn range(pose: MapPose, bearing: f64) -> f64 {
    let from = pose * laser().body_from_laser;
    let (sin, cos) = from.heading.rotated_by(bearing).sin_cos();
    let x = if cos > 0.0 { (6.0 - from.x) / cos } else { -from.x / cos };
    let y = if sin > 0.0 { (4.0 - from.y) / sin } else { -from.y / sin };
    x.min(y)
}

/// Filter that received the odometry of `twist` until `end` \[s].
fn filter(twist: Twist<f64>, end: f64) -> Filter {
    let drive = DiffDrive::new(0.05, 0.4);
    let ekf = Ekf { drive, delta: 0.0025, integration: Integration::Arc };
    let belief = Belief::new(pose(twist, 0.0), [0.01; 3]);
    let mut filter = Filter::new(ekf, Gate::new(0.999), 1.0, Stamp::from_seconds(0.0), belief);
    let steps = (end / PERIOD).round() as usize;
    for step in 1..=steps {
        let travel = drive.wheel_speeds_from_twist(twist).scaled(PERIOD);
        filter.predict(Stamp::from_seconds(PERIOD * step as f64), travel).unwrap();
    }
    filter
}

/// Swept ranges from the first beam at `first` \[s].
fn swept(twist: Twist<f64>, first: f64) -> Vec<f64> {
    let time = |beam: usize| first + SWEEP * beam as f64 / (BEAMS - 1) as f64;
    (0..BEAMS).map(|beam| range(pose(twist, time(beam)), FIRST + STEP * beam as f64)).collect()
}

fn scan(ranges: &[f64]) -> Scan<'_, f64> {
    Scan::new(Angle::from_radians(FIRST), STEP, ranges).with_time_increment(SWEEP / (BEAMS - 1) as f64)
}

/// Largest distance of an end point from the walls, seen from `pose` \[m].
fn worst(pose: MapPose, scan: &Scan<'_, f64>) -> f64 {
    let map_from_laser = pose * laser().body_from_laser;
    let distance = |(beam, range): (usize, &f64)| {
        let (sin, cos) = scan.angle(beam).sin_cos();
        let end = map_from_laser * Point::new(range * cos, range * sin);
        let across = |at: f64, size: f64| at.abs().min((size - at).abs());
        across(end.x, 6.0).min(across(end.y, 4.0))
    };
    scan.ranges.iter().enumerate().map(distance).fold(0.0, f64::max)
}

/// Between two knots the laser moves on a chord instead of an arc, which differ by at most a·t²/8, with the acceleration a
/// of the laser and the time t between knots. Its heading is exact at a constant turn rate.
#[test]
fn deskewed_scan_equals_an_instantaneous_one() {
    let (first, mount) = (0.2, laser().body_from_laser);
    for (v, omega) in [(0.3, 0.0), (0.0, 1.5), (0.3, 1.0), (-0.5, 2.0), (0.4, -1.2)] {
        let twist = Twist::new(v, omega);
        let ranges = swept(twist, first);
        let filter = filter(twist, 0.33);
        let motion = filter.motion_during(Stamp::from_seconds(first), SWEEP).unwrap();
        assert_eq!(motion.reference, Stamp::from_seconds(first + 0.5 * SWEEP));
        let mut deskewer = Deskewer::<f64, BEAMS>::default();
        let still = deskewer.deskew(&laser(), &scan(&ranges), &motion).unwrap();
        let there = pose(twist, first + 0.5 * SWEEP);
        let acceleration = (v * omega).abs() + mount.x.hypot(mount.y) * omega * omega;
        let knots = SWEEP / (SWEEP_KNOTS - 1) as f64;
        let bound = acceleration * knots * knots / 8.0 + 1e-9;
        let (before, after) = (worst(there, &scan(&ranges)), worst(there, &still));
        assert!(after <= bound, "{v} {omega}: {after} m, expected at most {bound} m");
        assert!(before > 0.01, "{v} {omega}: the raw scan is off by {before} m only");
    }
}

#[test]
fn corrections_by_measurements_do_not_move_the_robot() {
    let twist = Twist::new(0.3, 1.0);
    let mut filter = filter(twist, 0.6);
    let motion = |filter: &Filter| filter.motion_during(Stamp::from_seconds(0.4), SWEEP).unwrap();
    let before = motion(&filter);
    // Inside the sweep, and inside an odometry interval, which it splits.
    let heading = pose(twist, 0.46).heading.rotated_by(0.02);
    let measurement = Measurement::Heading(HeadingMeasurement { heading, std: 0.005 });
    let outcome = filter.update(Stamped::new(Stamp::from_seconds(0.46), measurement));
    assert!(matches!(outcome, MeasurementOutcome::Accepted { .. }), "{outcome:?}");
    assert!((filter.belief().pose.heading - pose(twist, 0.6).heading).radians() > 0.005);
    let after = motion(&filter);
    for (before, after) in before.reference_from_body.iter().zip(after.reference_from_body) {
        assert!(before.origin().distance(after.origin()) < 1e-12, "{before:?} {after:?}");
        assert!((before.heading - after.heading).radians().abs() < 1e-12);
    }
}

#[test]
fn odometry_is_extrapolated_by_a_bounded_time() {
    let twist = Twist::new(0.4, 1.0);
    let filter = filter(twist, 0.6);
    let motion = |first: f64| filter.motion_during(Stamp::from_seconds(first), SWEEP);
    // The last beam is 40 ms later than odometry.
    let extrapolated = motion(0.54).unwrap();
    let reference = pose(twist, 0.59);
    for (knot, found) in extrapolated.reference_from_body.iter().enumerate() {
        let time = 0.54 + SWEEP * knot as f64 / (SWEEP_KNOTS - 1) as f64;
        let expected = reference.inverse() * pose(twist, time);
        assert!((found.x - expected.x).hypot(found.y - expected.y) < 1e-9, "{knot}");
    }
    assert_eq!(motion(0.56), Err(RejectReason::Future));
    assert!(motion(-0.04).is_ok());
    assert_eq!(motion(-0.06), Err(RejectReason::Stale));
    // Without any odometry the robot is at rest.
    let at_rest = DelayedEkf::<f64, 4>::new(
        *filter.ekf(),
        Gate::new(0.999),
        1.0,
        Stamp::from_seconds(1.0),
        Belief::new(reference, [0.1; 3]),
    );
    let still = at_rest.motion_during(Stamp::from_seconds(0.95), SWEEP).unwrap();
    assert!(still.reference_from_body.iter().all(|pose| *pose == Pose::identity()), "{still:?}");
}

#[test]
fn drivers_state_the_time_of_a_scan_in_several_ways() {
    let ranges = [1.0; 11];
    let seconds = Stamp::from_seconds;
    let stated = |increment: f64| {
        let scan = Scan::new(Angle::zero(), 0.1, &ranges).with_time_increment(increment);
        Stamped::new(seconds(5.0), scan)
    };
    let by_message = ScanTiming::default().resolve(stated(0.01));
    assert_eq!((by_message.stamp, by_message.value.sweep_duration()), (seconds(5.0), 0.1));
    for (stamped, first) in [(StampedBeam::First, 5.0), (StampedBeam::Middle, 4.9), (StampedBeam::Last, 4.8)]
    {
        let timing = ScanTiming { sweep: Some(0.2), stamped };
        let resolved = timing.resolve(stated(0.0));
        assert_eq!(resolved.stamp, seconds(first), "{stamped:?}");
        assert!((resolved.value.sweep_duration() - 0.2).abs() < 1e-12);
    }
    // A configured 0 overrides the message.
    let timing = ScanTiming { sweep: Some(0.0), stamped: StampedBeam::Last };
    assert_eq!(timing.resolve(stated(0.01)), stated(0.0));
}
