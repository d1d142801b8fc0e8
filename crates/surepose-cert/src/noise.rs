//! What may go wrong, bounded.

use surepose::kinematics::{DiffDrive, Twist, WheelPair};

use crate::interval::Interval;

/// Bounds of the disturbances, each in any direction at every tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseBounds {
    /// Distance of the estimated from the true position \[m].
    pub position: f64,
    /// Estimated minus true heading \[rad].
    pub heading: f64,
    /// Error of each rim's speed \[m/s].
    pub rim_speed: f64,
    /// Error of each rim's speed, as a part of that speed.
    pub rim_speed_part: f64,
}

impl NoiseBounds {
    /// All twists that the robot may do when told `twist`.
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
