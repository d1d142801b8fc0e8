//! Bounds of the disturbances.

use surepose::kinematics::{DiffDrive, Twist, WheelPair};

use crate::interval::Interval;

/// Bounds of the disturbances; at every tick, each may take any value within its bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseBounds {
    /// Distance between the estimated and the true position \[m].
    pub position: f64,
    /// Absolute heading error \[rad].
    pub heading: f64,
    /// Absolute error of each wheel speed at the rim \[m/s].
    pub rim_speed: f64,
    /// Error of each wheel speed as a fraction of that speed.
    pub rim_speed_part: f64,
}

impl NoiseBounds {
    /// All twists that the robot may execute for the command `twist`.
    pub(crate) fn driven(&self, drive: &DiffDrive<Interval>, twist: Twist<Interval>) -> Twist<Interval> {
        if self.rim_speed <= 0.0 && self.rim_speed_part <= 0.0 {
            return twist;
        }
        let rims = drive.wheel_speeds_from_twist(twist);
        let off = |rim: Interval| {
            rim * Interval::symmetric(self.rim_speed_part) + Interval::symmetric(self.rim_speed)
        };
        let error = drive.twist_from_wheel_speeds(WheelPair::new(off(rims.right), off(rims.left)));
        Twist::new(twist.v + error.v, twist.omega + error.omega)
    }
}
