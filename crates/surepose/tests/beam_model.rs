//! The beam model on scans of known rooms: the pose that results, and the directions that a scan leaves unobserved.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on has failed")]

use std::f64::consts::FRAC_PI_2;

use surepose::estimation::{Belief, Ekf, Measurement, PoseMeasurement};
use surepose::geometry::{Angle, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration};
use surepose::lidar::{BeamMatch, BeamModelMatcher, RangeFinder, Scan, ScanError};
use surepose::linalg::Matrix;
use surepose::map::Wall;
use surepose::scalar::Float;

const BEAMS: usize = 181;
const STEP: f64 = std::f64::consts::PI / 180.0;
type MapPose = Pose<surepose::geometry::Map, surepose::geometry::Body, f64>;

fn wall(from: (f64, f64), to: (f64, f64)) -> Wall<f64> {
    Wall::between(Point::new(from.0, from.1), Point::new(to.0, to.1)).unwrap()
}

/// A room of 6 m by 4 m with a short face in it.
fn room() -> Vec<Wall<f64>> {
    let corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0), (0.0, 0.0)];
    let mut walls: Vec<_> = corners.windows(2).map(|ends| wall(ends[0], ends[1])).collect();
    walls.push(wall((3.9, 2.8), (4.1, 3.0)));
    walls
}

fn laser() -> RangeFinder<f64> {
    let body_from_laser = Pose::new(0.2, -0.05, Angle::from_degrees(5.0));
    RangeFinder { body_from_laser, range_std: 0.03, bearing_std: 0.004, range_min: 0.05, range_max: 30.0 }
}

fn matcher() -> BeamModelMatcher<f64> {
    BeamModelMatcher { min_hit_ratio: 0.4, scan_std: [0.0; 3] }
}

fn ekf<S: Float>() -> Ekf<S> {
    let drive = DiffDrive::new(S::from_f64(0.05), S::from_f64(0.6));
    Ekf { drive, delta: S::from_f64(0.0025), integration: Integration::Arc }
}

/// Computes ranges over 180° with a fixed, noise-like error of at most 3σ.
fn ranges(pose: MapPose, walls: &[Wall<f64>]) -> Vec<f64> {
    let origin = pose * laser().body_from_laser;
    let mut noise = 12345_u32;
    (0..BEAMS)
        .map(|beam| {
            let bearing = (beam as f64 - 90.0).to_radians();
            let (sin, cos) = (origin.heading.radians() + bearing).sin_cos();
            let hits = walls.iter().filter_map(|wall| {
                let [a, b] = wall.ends();
                let (ex, ey) = (b.x - a.x, b.y - a.y);
                let (ox, oy) = (a.x - origin.x, a.y - origin.y);
                let turn = cos * ey - sin * ex;
                let (range, share) = ((ox * ey - oy * ex) / turn, (ox * sin - oy * cos) / turn);
                (range > 0.0 && (0.0..=1.0).contains(&share)).then_some(range)
            });
            let mut sum = -2.0;
            for _ in 0..4 {
                noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                sum += f64::from(noise >> 8) / f64::from(1 << 24);
            }
            hits.fold(f64::INFINITY, f64::min) + 0.03 * sum * f64::sqrt(3.0)
        })
        .collect()
}

fn matched(belief: Belief<f64>, ranges: &[f64], walls: &[Wall<f64>]) -> BeamMatch<f64> {
    let scan = Scan::new(Angle::from_degrees(-90.0), 1_f64.to_radians(), ranges);
    matcher().match_scan(&ekf(), &laser(), &scan, &belief, walls).unwrap()
}

fn corrected(belief: Belief<f64>, result: &BeamMatch<f64>) -> Belief<f64> {
    ekf().correct(belief, &result.fix.unwrap().innovation(&belief), 1e30).belief
}

#[test]
fn finds_the_pose_in_a_room() {
    let truth: MapPose = Pose::new(2.0, 1.5, Angle::from_degrees(40.0));
    let start = Pose::new(2.15, 1.4, Angle::from_degrees(44.0));
    let belief = Belief::new(start, [0.2, 0.2, 0.1]);
    let result = matched(belief, &ranges(truth, &room()), &room());
    let after = corrected(belief, &result);
    assert!(after.error(truth).iter().all(|e| e.abs() < 0.008), "{:?}", after.error(truth));
    assert!(after.nees(truth) < 11.3, "{}", after.nees(truth));
    // The standard deviation matches 91 beams of 3 cm on three walls.
    assert!((0.003..0.015).contains(&after.covariance.std(0)), "{}", after.covariance.std(0));
    assert!(result.stats.beams == 91 && result.stats.hits > 85, "{result:?}");
}

#[test]
fn finds_a_heading_that_is_half_a_radian_off() {
    let truth: MapPose = Pose::new(2.0, 1.5, Angle::from_degrees(40.0));
    let belief = Belief::new(Pose::new(2.1, 1.5, Angle::from_degrees(68.0)), [0.2, 0.2, 0.25]);
    let result = matched(belief, &ranges(truth, &room()), &room());
    assert!(corrected(belief, &result).error(truth).iter().all(|e| e.abs() < 0.01));
}

#[test]
fn corridor_leaves_its_axis_unobserved() {
    let corridor = [wall((-50.0, 0.0), (50.0, 0.0)), wall((-50.0, 2.0), (50.0, 2.0))];
    let truth: MapPose = Pose::new(0.0, 1.0, Angle::zero());
    let belief = Belief::new(Pose::new(0.3, 1.05, Angle::from_degrees(1.0)), [0.4, 0.1, 0.03]);
    let after = corrected(belief, &matched(belief, &ranges(truth, &corridor), &corridor));
    let error = after.error(truth);
    assert!(error[1].abs() < 0.01 && error[2].abs() < 0.01, "{error:?}");
    assert!((error[0] - 0.3).abs() < 0.01 && after.covariance.std(0) > 0.38, "{error:?}");
}

/// The information of a scan in a corridor is positive semi-definite in every direction of the corridor, although the
/// rounding error along it is that of a million across.
#[test]
fn corridor_information_is_valid_in_every_direction() {
    fn refused<S: Float>(range_std: f64) -> usize {
        let num = S::from_f64;
        let laser = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: num(range_std),
            bearing_std: num(0.004),
            range_min: num(0.05),
            range_max: num(20.0),
        };
        // Walls 1 m to the left and to the right.
        let range = |beam: usize| {
            let across = (STEP * beam as f64 - FRAC_PI_2).sin().abs();
            num(if across < 0.03 { f64::INFINITY } else { 1.0 / across })
        };
        let ranges: Vec<S> = (0..BEAMS).map(range).collect();
        let scan = Scan::new(Angle::from_radians(num(-FRAC_PI_2)), num(STEP), &ranges);
        let matcher =
            BeamModelMatcher { min_hit_ratio: num(0.4), scan_std: [num(0.06), num(0.06), num(0.01)] };
        let is_refused = |quarters: &usize| {
            let heading = Angle::from_degrees(num(0.25 * *quarters as f64));
            let (sin, cos) = heading.sin_cos();
            let wall = |side: f64| {
                let end = |along: f64| {
                    let (along, side) = (num(along), num(side));
                    Point::new(num(5.0) + along * cos - side * sin, along * sin + side * cos)
                };
                Wall::between(end(-50.0), end(50.0)).unwrap()
            };
            let belief =
                Belief::new(Pose::new(num(5.0), num(0.0), heading), [0.005, 0.005, 0.002].map(S::from_f64));
            let fix = matcher.match_scan(&ekf(), &laser, &scan, &belief, &[wall(1.0), wall(-1.0)]).unwrap();
            let fix = fix.fix.unwrap();
            Measurement::Pose(fix).check().is_err()
        };
        (0..720).filter(is_refused).count()
    }
    for range_std in [0.03, 0.01] {
        assert_eq!((refused::<f64>(range_std), refused::<f32>(range_std)), (0, 0), "at {range_std} m");
    }
}

#[test]
fn too_few_explained_beams_yield_no_pose() {
    let truth: MapPose = Pose::new(2.0, 1.5, Angle::zero());
    let belief = Belief::new(truth, [0.05, 0.05, 0.02]);
    let seen = ranges(truth, &room());
    let without_map = matched(belief, &seen, &[]);
    assert!(without_map.fix.is_none() && without_map.stats.hits == 0, "{without_map:?}");
    for void in [f64::INFINITY, f64::NAN] {
        assert!(matched(belief, &[void; BEAMS], &room()).fix.is_none());
    }
    // Three of four beams end on people.
    let people: Vec<f64> = seen
        .iter()
        .enumerate()
        .map(|(beam, range)| if beam % 8 < 2 { *range } else { 0.3 * range })
        .collect();
    let result = matched(belief, &people, &room());
    assert!(result.fix.is_none() && result.stats.hit_ratio() < 0.4, "{result:?}");
    let broken = RangeFinder { range_std: f64::NAN, ..laser() };
    let scan = Scan::new(Angle::zero(), 0.01, &seen);
    let refused = matcher().match_scan(&ekf(), &broken, &scan, &belief, &room());
    assert_eq!(refused, Err(ScanError::InvalidLaser));
}

/// (Λ⁻¹ + Σ)⁻¹ by its definition: with both added, the gain of a blurred fix is that of a vaguer one.
#[test]
fn inflation_adds_variance() {
    let information: Matrix<f64, 3, 3> =
        Matrix([[400.0, 30.0, -10.0], [30.0, 250.0, 5.0], [-10.0, 5.0, 900.0]]);
    let fix = PoseMeasurement { pose: Pose::new(1.0, 2.0, Angle::zero()), information };
    let more = [0.01, 0.02, 0.003];
    // Λ' (Λ⁻¹ + Σ) = 1, so Λ' + Λ' Σ Λ = Λ.
    let inflated = fix.inflated(more).information;
    let product = &(&inflated * &Matrix::from_diagonal(more)) * &information;
    for row in 0..3 {
        for column in 0..3 {
            let sum = inflated[(row, column)] + product[(row, column)];
            assert!((sum - information[(row, column)]).abs() < 1e-9, "{row} {column}");
        }
    }
}

#[test]
fn pose_measurement_solves_the_observed_subspace() {
    let near: MapPose = Pose::new(1.0, 2.0, Angle::zero());
    let information = Matrix([[4.0, 0.0, 2.0], [0.0, 0.0, 0.0], [2.0, 0.0, 9.0]]);
    let fix = PoseMeasurement::from_information(
        near,
        information,
        [4.0 * 0.1 + 2.0 * 0.2, 0.0, 2.0 * 0.1 + 9.0 * 0.2],
    )
    .unwrap();
    assert!((fix.pose.x - 1.1).abs() < 1e-12 && (fix.pose.heading.radians() - 0.2).abs() < 1e-12);
    assert!((fix.pose.y - 2.0).abs() < 1e-12);
    // What rounding leaves of walls along an axis is not information.
    let rounding = Matrix([[1e-30, 1e-13, 0.0], [1e-13, 100.0, 0.0], [0.0, 0.0, 100.0]]);
    let fix = PoseMeasurement::from_information(near, rounding, [1e-14, 10.0, 0.0]).unwrap();
    assert!((fix.pose.x - 1.0).abs() < 1e-9 && (fix.pose.y - 2.1).abs() < 1e-9, "{fix:?}");
    let negative = Matrix([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert!(PoseMeasurement::from_information(near, negative, [0.0; 3]).is_err());
    assert!(PoseMeasurement::from_information(near, information, [f64::NAN, 0.0, 0.0]).is_err());
    let broken = Matrix([[4.0, f64::NAN, 2.0], [f64::NAN, 1.0, 0.0], [2.0, 0.0, 9.0]]);
    assert!(PoseMeasurement::from_information(near, broken, [1.0, 0.0, 0.0]).is_err());
}
