//! Measurement models: residuals of poses, walls and geometry, with derivatives.

use surepose::estimation::{Belief, Ekf, WheelOdometry};
use surepose::geometry::{Angle, Body, Laser, Line, Map, Pose};
use surepose::kinematics::{Integration, Motion, WheelPair};
use surepose::scalar::{Dual, Scalar};

use super::parameter::{COUNT, CalibrationParameter, Geometry};
use super::recording::OdometryStep;

/// Derivative indices of a factor: pose before, pose after, wall, geometry.
pub(super) const FROM: usize = 0;
pub(super) const TO: usize = 3;
pub(super) const WALL: usize = 6;
pub(super) const GEOMETRY: usize = 8;
/// Maximum number of variables of a factor.
pub(super) const LOCAL: usize = GEOMETRY + COUNT;

/// A dual number with derivatives by all variables of a factor.
pub(super) type Local = Dual<f64, LOCAL>;
/// A pose of the trajectory (x, y, θ), with θ not wrapped.
pub(super) type PoseVector = [f64; 3];

/// Standard deviation of motion that encoders do not observe \[m]; it keeps the motion covariance invertible.
const FLOOR: f64 = 5e-5;

/// Returns a pose as a variable whose derivatives begin at `offset`.
pub(super) fn unknown_pose(place: PoseVector, offset: usize) -> Pose<Map, Body, Local> {
    let [x, y, heading] = core::array::from_fn(|i| Dual::parameter(place[i], offset + i));
    Pose::new(x, y, Angle::from_radians(heading))
}

/// Returns a pose as a constant.
pub(super) fn known_pose(place: PoseVector) -> Pose<Map, Body, f64> {
    Pose::new(place[0], place[1], Angle::from_radians(place[2]))
}

/// Returns a wall (r, ψ) as a variable.
pub(super) fn unknown_wall(wall: [f64; 2]) -> Line<Map, Local> {
    Line::new(Dual::parameter(wall[0], WALL), Angle::from_radians(Dual::parameter(wall[1], WALL + 1)))
}

/// Returns the geometry as a variable.
pub(super) fn unknown_geometry(geometry: &Geometry<f64>) -> Geometry<Local> {
    Geometry(core::array::from_fn(|i| Dual::parameter(geometry.0[i], GEOMETRY + i)))
}

/// Returns the motion of a step by its encoders: [Tran2012] Eq. (7), (8), with a radius for each wheel.
pub(super) fn motion<S: Scalar>(geometry: &Geometry<S>, turned: WheelPair<f64>) -> Motion<S> {
    let turned = WheelPair::new(S::from_f64(turned.right), S::from_f64(turned.left));
    let drive = geometry.drive();
    drive.motion_from_travel(drive.wheel_travel_from_angle(turned))
}

/// Residual between the motion of the poses and that of the wheels: (x \[m], y \[m], θ \[rad]) in the frame
/// of the later pose.
pub(super) fn odometry<S: Scalar>(
    from: Pose<Map, Body, S>,
    to: Pose<Map, Body, S>,
    motion: Motion<S>,
) -> [S; 3] {
    let left: Pose<Body, Body, S> = from.integrate(motion, Integration::Arc).inverse() * to;
    [left.x, left.y, left.heading.radians()]
}

/// Returns the covariance of that residual as two matrices: δ times the first plus the second, [Tran2012] Eq.
/// (15).
///
/// Computed by the filter's own prediction from an exact pose, rotated so that the step ends with heading 0.
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
    // Quantization: each end of a step is rounded to a tick.
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

/// Interpolates the pose at `fraction` of a step on the arc between its two ends.
///
/// The arc is of second order in its turn: its offset from the chord d is ½·f·(1 − f)·Δθ·|d|, to the right
/// for a left turn.
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

/// Returns the fraction of `step` at the time of a measurement with the given `stamp` and `latency`.
pub(super) fn fraction<S: Scalar>(step: &OdometryStep, stamp: f64, latency: S) -> S {
    (S::from_f64(stamp - step.begin) - latency) / S::from_f64(step.duration)
}

/// Predicts the line of a wall in the laser frame.
pub(super) fn seen<S: Scalar>(
    map_from_body: Pose<Map, Body, S>,
    geometry: &Geometry<S>,
    wall: Line<Map, S>,
) -> Line<Laser, S> {
    (map_from_body * geometry.body_from_laser()).inverse() * wall
}

/// Predicts the compass reading.
pub(super) fn compass_reading<S: Scalar>(
    map_from_body: Pose<Map, Body, S>,
    geometry: &Geometry<S>,
) -> Angle<S> {
    map_from_body.heading.rotated_by(geometry.get(CalibrationParameter::CompassOffset))
}
