//! Compares every Jacobian with central differences.

use proptest::prelude::*;
use surepose::estimation::{
    Belief, Ekf, HeadingMeasurement, Innovation, LineMeasurement, PoseMeasurement, PositionMeasurement,
    RangeBearingMeasurement, WheelOdometry,
};
use surepose::geometry::{Angle, Body, Line, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::linalg::Matrix;

type MapFromBody = Pose<Map, Body, f64>;
const STEP: f64 = 1e-5;
/// The error of central differences is STEP² times the third derivative, here below 100, plus rounding divided by STEP.
const TOLERANCE: f64 = 1e-7;

fn shifted(pose: MapFromBody, component: usize, by: f64) -> MapFromBody {
    let mut d = [0.0; 3];
    d[component] = by;
    Pose::new(pose.x + d[0], pose.y + d[1], pose.heading.rotated_by(d[2]))
}

fn difference(a: MapFromBody, b: MapFromBody) -> [f64; 3] {
    [a.x - b.x, a.y - b.y, (a.heading - b.heading).radians()]
}

fn ekf(integration: Integration) -> Ekf<f64> {
    Ekf { drive: DiffDrive::new(0.05, 0.6), delta: 0.0025, integration }
}

/// Computes the covariance after one prediction with Jacobians from central differences of the pose.
fn expected_covariance(ekf: &Ekf<f64>, belief: Belief<f64>, travel: WheelOdometry<f64>) -> Matrix<f64, 3, 3> {
    let moved = |pose: MapFromBody, rims: WheelPair<f64>| {
        pose.integrate(ekf.drive.motion_from_travel(rims), ekf.integration)
    };
    let slope = |ahead: MapFromBody, behind: MapFromBody| difference(ahead, behind).map(|d| d / (2.0 * STEP));
    let (pose, rims) = (belief.pose, travel.travel);
    let a: [[f64; 3]; 3] = core::array::from_fn(|j| {
        slope(moved(shifted(pose, j, STEP), rims), moved(shifted(pose, j, -STEP), rims))
    });
    let right = |by| moved(pose, WheelPair::new(rims.right + by, rims.left));
    let left = |by| moved(pose, WheelPair::new(rims.right, rims.left + by));
    let w = [slope(right(STEP), right(-STEP)), slope(left(STEP), left(-STEP))];
    let q = Matrix::from_diagonal([travel.variance.right, travel.variance.left]);
    let (a, w) = (Matrix(a).transpose(), Matrix(w).transpose());
    let mut sum = &(&a * &belief.covariance.matrix()) * &a.transpose();
    let noise = &(&w * &q) * &w.transpose();
    for i in 0..9 {
        sum[(i / 3, i % 3)] += noise[(i / 3, i % 3)];
    }
    sum
}

/// Returns the largest deviation of a Jacobian from the central difference of −ν: ν = z − h, so ∂ν/∂x = −H.
fn jacobian_error<const M: usize>(
    belief: Belief<f64>,
    f: impl Fn(&Belief<f64>) -> Innovation<f64, M>,
) -> f64 {
    let at = f(&belief);
    let mut worst: f64 = 0.0;
    for j in 0..3 {
        let ahead = f(&Belief { pose: shifted(belief.pose, j, STEP), ..belief });
        let behind = f(&Belief { pose: shifted(belief.pose, j, -STEP), ..belief });
        for m in 0..M {
            let slope = (ahead.residual[m] - behind.residual[m]) / (2.0 * STEP);
            worst = worst.max((slope + at.jacobian[m][j]).abs());
        }
    }
    worst
}

proptest! {
    /// Compares with [Tran2012] Eq. (12)–(14), with the corrected W.
    #[test]
    fn prediction_covariance_is_that_of_the_motion_model(
        heading in -3.0..3.0, right in -0.4..0.4, left in -0.4..0.4, midpoint in any::<bool>(),
    ) {
        let ekf = ekf(if midpoint { Integration::Midpoint } else { Integration::Arc });
        let belief = Belief::new(Pose::new(1.0, -2.0, Angle::from_radians(heading)), [0.3, 0.2, 0.1]);
        let travel = WheelOdometry { travel: WheelPair::new(right, left), variance: WheelPair::new(0.02, 0.03) };
        let predicted = ekf.predict(belief, travel);
        let expected = expected_covariance(&ekf, belief, travel);
        for i in 0..9 {
            let (row, column) = (i / 3, i % 3);
            prop_assert!((predicted.covariance.entry(row, column) - expected[(row, column)]).abs() < TOLERANCE);
        }
        let moved = belief.pose.integrate(ekf.drive.motion_from_travel(travel.travel), ekf.integration);
        prop_assert!(difference(predicted.pose, moved).iter().all(|d| d.abs() < 1e-14));
    }

    #[test]
    fn measurement_jacobians(
        x in -3.0..3.0_f64, y in -3.0..3.0_f64, heading in -3.1..3.1_f64,
        direction in -3.0..3.0_f64, distance in 4.5..9.0_f64, flip in any::<bool>(),
    ) {
        let belief = Belief::new(Pose::new(x, y, Angle::from_radians(heading)), [0.1, 0.1, 0.1]);
        let compass = HeadingMeasurement { heading: Angle::from_radians(heading + 0.2), std: 0.01 };
        prop_assert!(jacobian_error(belief, |b| compass.innovation(b)) < TOLERANCE);

        let side = if flip { core::f64::consts::PI } else { 0.0 };
        let wall = LineMeasurement {
            wall: Line::new(distance, Angle::from_radians(direction)),
            seen: Line::new(if flip { -distance } else { distance }, Angle::from_radians(direction - heading + 0.1 + side)),
            distance_variance: 0.02,
            direction_variance: 0.01,
            covariance: 0.005,
            wall_variance: 0.0,
        };
        prop_assert!(jacobian_error(belief, |b| wall.innovation(b)) < TOLERANCE);

        let landmark = RangeBearingMeasurement {
            landmark: Point::new(distance * f64::cos(direction), distance * f64::sin(direction)),
            range: 5.0,
            bearing: Angle::from_radians(direction - heading),
            range_std: 0.1,
            bearing_std: 0.01,
        };
        prop_assert!(jacobian_error(belief, |b| landmark.innovation(b)) < TOLERANCE);

        let fix = PositionMeasurement {
            position: Point::new(y, x), x_variance: 0.1, y_variance: 0.2, covariance: -0.05,
        };
        prop_assert!(jacobian_error(belief, |b| fix.innovation(b)) < TOLERANCE);

        let pose = PoseMeasurement {
            pose: Pose::new(y, x, Angle::from_radians(heading + 0.3)),
            information: Matrix([[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 9.0]]),
        };
        prop_assert!(jacobian_error(belief, |b| pose.innovation(b)) < TOLERANCE);
    }

    /// The direction of the observed normal does not matter, and the innovation at the predicted line is zero.
    #[test]
    fn a_wall_has_two_normals(x in -3.0..3.0, y in -3.0..3.0, heading in -3.1..3.1, direction in -3.0..3.0) {
        let pose: MapFromBody = Pose::new(x, y, Angle::from_radians(heading));
        let belief = Belief::new(pose, [0.1, 0.1, 0.1]);
        let wall: Line<Map, f64> = Line::new(1.0, Angle::from_radians(direction));
        let seen = pose.inverse() * wall;
        let other: Line<Body, f64> = Line::new(-seen.distance, seen.direction + Angle::half_turn());
        for seen in [seen, other] {
            let sighting = LineMeasurement {
                wall, seen, distance_variance: 1e-4, direction_variance: 1e-4, covariance: 0.0, wall_variance: 0.0,
            };
            prop_assert!(sighting.innovation(&belief).residual.iter().all(|r| r.abs() < 1e-12));
        }
    }

    /// Decorrelated rows have the joint information: νᵀS⁻¹ν equals that of the correlated pair.
    #[test]
    fn a_correlated_pair_keeps_its_information(u in -1.0..1.0, v in -1.0..1.0, share in -0.9..0.9) {
        let (first, second) = (0.04, 0.09);
        let covariance = share * f64::sqrt(first * second);
        let (a, b) = ([1.0, 0.5, 0.0], [0.0, 1.0, -1.0]);
        let belief = Belief::new(Pose::identity(), [0.3, 0.2, 0.1]);
        let p = [0.09, 0.04, 0.01];
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * p[i] * b[i]).sum::<f64>();
        let s = [[dot(a, a) + first, dot(a, b) + covariance], [dot(a, b) + covariance, dot(b, b) + second]];
        let determinant = s[0][0] * s[1][1] - s[0][1] * s[1][0];
        let joint = (s[1][1] * u * u - 2.0 * s[0][1] * u * v + s[0][0] * v * v) / determinant;
        let pair = Innovation::with_correlated_pair([u, v], [a, b], [first, second], covariance);
        let found = ekf(Integration::Arc).correct(belief, &pair, 1e9);
        prop_assert!((found.nis - joint).abs() < 1e-9 * (1.0 + joint));
    }
}
