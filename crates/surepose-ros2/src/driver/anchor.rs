//! A given pose, moved along by odometry, from which an estimate can restart without measurements.

use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::Motion;

use super::Odom;

/// Increase of the standard deviation of the position per meter \[1].
const POSITION_STD_PER_METER: f64 = 0.05;

/// Increase of the standard deviation of the heading per meter \[rad/m] and per radian \[1].
const HEADING_STD_PER_METER: f64 = 0.05;
const HEADING_STD_PER_RADIAN: f64 = 0.05;

/// Given pose with the odometry since.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    given: Belief<f64>,
    odom_from_given: Pose<Odom, Body, f64>,
    odom_from_body: Pose<Odom, Body, f64>,
    /// Path length \[m] and sum of all rotations \[rad] since.
    length: f64,
    turn: f64,
}

impl Anchor {
    /// Anchor at the pose of `given`, where odometry is `odom_from_body`.
    pub(super) fn new(given: Belief<f64>, odom_from_body: Pose<Odom, Body, f64>) -> Self {
        Self { given, odom_from_given: odom_from_body, odom_from_body, length: 0.0, turn: 0.0 }
    }

    /// Adds the motion to the next odometry pose.
    pub(super) fn move_to(&mut self, odom_from_body: Pose<Odom, Body, f64>) {
        let motion = Motion::between(self.odom_from_body, odom_from_body);
        self.length += motion.length.abs();
        self.turn += motion.turn.abs();
        self.odom_from_body = odom_from_body;
    }

    /// Estimate of the current pose by odometry alone.
    pub(super) fn belief(&self) -> Belief<f64> {
        let given_from_body: Pose<Body, Body, f64> = self.odom_from_given.inverse() * self.odom_from_body;
        let pose: Pose<Map, Body, f64> = self.given.pose * given_from_body;
        let std = |component: usize| self.given.covariance.std(component);
        let position = POSITION_STD_PER_METER * self.length;
        let heading = HEADING_STD_PER_METER * self.length + HEADING_STD_PER_RADIAN * self.turn;
        Belief::new(pose, [std(0) + position, std(1) + position, std(2) + heading])
    }
}
