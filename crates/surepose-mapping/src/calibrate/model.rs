//! What is measured, as residuals of poses, walls and geometry, with their derivatives.

use surepose::estimation::{Belief, Ekf, WheelOdometry};
use surepose::geometry::{Angle, Body, Laser, Line, Map, Pose};
use surepose::kinematics::{Integration, Motion, WheelPair};
use surepose::scalar::{Dual, Scalar};

use super::parameter::{COUNT, CalibrationParameter, Geometry};
use super::recording::OdometryStep;

/// Where a factor's derivatives begin: by the pose before, the pose after, the wall and the geometry.
pub(super) const FROM: usize = 0;
pub(super) const TO: usize = 3;
pub(super) const WALL: usize = 6;
pub(super) const GEOMETRY: usize = 8;
/// How many numbers a factor may depend on.
pub(super) const LOCAL: usize = GEOMETRY + COUNT;

/// A number with its derivatives by all that a factor depends on.
pub(super) type Local = Dual<f64, LOCAL>;
/// A pose of the trajectory (x, y, θ), not wrapped.
pub(super) type PoseVector = [f64; 3];

/// Sideways and lengthwise scatter that no encoder explains \[m]; it keeps the motion's covariance invertible.
const FLOOR: f64 = 5e-5;

/// A pose as the unknown that begins at `offset`.
pub(super) fn unknown_pose(place: PoseVector, offset: usize) -> Pose<Map, Body, Local> {
    let [x, y, heading] = core::array::from_fn(|i| Dual::parameter(place[i], offset + i));
    Pose::new(x, y, Angle::from_radians(heading))
}

/// A pose as it is.
pub(super) fn known_pose(place: PoseVector) -> Pose<Map, Body, f64> {
    Pose::new(place[0], place[1], Angle::from_radians(place[2]))
}

/// A wall (r, ψ) as the unknown.
pub(super) fn unknown_wall(wall: [f64; 2]) -> Line<Map, Local> {
    Line::new(Dual::parameter(wall[0], WALL), Angle::from_radians(Dual::parameter(wall[1], WALL + 1)))
}

/// The geometry as the unknown.
pub(super) fn unknown_geometry(geometry: &Geometry<f64>) -> Geometry<Local> {
    Geometry(core::array::from_fn(|i| Dual::parameter(geometry.0[i], GEOMETRY + i)))
}

/// The motion of a step by its encoders: [Tran2012] Eq. (7), (8), with a radius for each wheel.
pub(super) fn motion<S: Scalar>(geometry: &Geometry<S>, turned: WheelPair<f64>) -> Motion<S> {
    let turned = WheelPair::new(S::from_f64(turned.right), S::from_f64(turned.left));
    let drive = geometry.drive();
    drive.motion_from_travel(drive.wheel_travel_from_angle(turned))
}

/// What is left between the motion of the poses and that of the wheels: (x \[m], y \[m], θ \[rad]) in the body after.
pub(super) fn odometry<S: Scalar>(
    from: Pose<Map, Body, S>,
    to: Pose<Map, Body, S>,
    motion: Motion<S>,
) -> [S; 3] {
    let left: Pose<Body, Body, S> = from.integrate(motion, Integration::Arc).inverse() * to;
    [left.x, left.y, left.heading.radians()]
}

/// The covariance of that residual: δ times the first matrix, plus the second, by [Tran2012] Eq. (15).
///
/// The filter's own prediction makes it, from a certain pose so turned that the step ends with heading 0.
pub(super) fn odometry_covariance(
    geometry: &Geometry<f64>,
    turned: WheelPair<f64>,
    tick: f64,
) -> [[[f64; 3]; 3]; 2] {
    let drive = geometry.drive();
    let ekf = Ekf { drive, delta: 1.0, integration: Integration::Arc };
    let rims = drive.wheel_travel_from_angle(turned);
    let turn = drive.motion_from_travel(rims).turn;
    let start = Belief::new(Pose::new(0.0, 0.0, Angle::from_radians(-turn)), [0.0; 3]);
    // Each end of a step is rounded to a tick.
    let rounding = |radius: f64| (tick * radius).powi(2) / 6.0;
    let rounding = WheelPair::new(rounding(drive.radius.right), rounding(drive.radius.left));
    let by_slip = ekf.predict(start, ekf.wheel_odometry(rims)).covariance;
    let by_ticks = ekf.predict(start, WheelOdometry { travel: rims, variance: rounding }).covariance;
    let matrix = |covariance: surepose::linalg::Covariance<f64, 3>| -> [[f64; 3]; 3] {
        core::array::from_fn(|i| core::array::from_fn(|j| covariance.entry(i, j)))
    };
    let mut constant = matrix(by_ticks);
    for (i, floor) in [FLOOR, FLOOR, FLOOR / drive.wheel_separation].into_iter().enumerate() {
        constant[i][i] += floor * floor;
    }
    [matrix(by_slip), constant]
}

/// Where the robot was at `fraction` of a step, on the arc that joins its two ends.
///
/// The arc is taken to second order in its turn: it stands off its chord d to the right of a left turn by
/// ½·f·(1 − f)·Δθ·|d|.
pub(super) fn during<S: Scalar>(
    from: Pose<Map, Body, S>,
    to: Pose<Map, Body, S>,
    fraction: S,
) -> Pose<Map, Body, S> {
    let step: Pose<Body, Body, S> = from.inverse() * to;
    let turn = step.heading.radians();
    let bulge = S::from_f64(0.5) * fraction * (S::from_f64(1.0) - fraction) * turn;
    let x = fraction * step.x + bulge * step.y;
    let y = fraction * step.y - bulge * step.x;
    let part: Pose<Body, Body, S> = Pose::new(x, y, Angle::from_radians(fraction * turn));
    from * part
}

/// How far into `step` something was measured whose record is stamped `stamp` and came `latency` late.
pub(super) fn fraction<S: Scalar>(step: &OdometryStep, stamp: f64, latency: S) -> S {
    (S::from_f64(stamp - step.begin) - latency) / S::from_f64(step.duration)
}

/// A wall as the laser should see it from a pose.
pub(super) fn seen<S: Scalar>(
    map_from_body: Pose<Map, Body, S>,
    geometry: &Geometry<S>,
    wall: Line<Map, S>,
) -> Line<Laser, S> {
    (map_from_body * geometry.body_from_laser()).inverse() * wall
}

/// What the compass should read.
pub(super) fn compass_reading<S: Scalar>(
    map_from_body: Pose<Map, Body, S>,
    geometry: &Geometry<S>,
) -> Angle<S> {
    map_from_body.heading.rotated_by(geometry.get(CalibrationParameter::CompassOffset))
}
