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
    pub(crate) fn driven(&self, drive: &DiffDrive<Interval>, twist: Twist<Interval>) -> DrivenTwist {
        if self.rim_speed <= 0.0 && self.rim_speed_part <= 0.0 {
            return DrivenTwist { all: twist, corners: [twist; 4], count: 1 };
        }
        let rims = drive.wheel_speeds_from_twist(twist);
        let most = |rim: Interval| {
            let part = Interval::point(self.rim_speed_part) * Interval::point(rim.magnitude());
            Interval::point((part + Interval::point(self.rim_speed)).hi())
        };
        let (right, left) = (most(rims.right), most(rims.left));
        let corners =
            [(right, left), (right, -left), (-right, left), (-right, -left)].map(|(right, left)| {
                let error = drive.twist_from_wheel_speeds(WheelPair::new(right, left));
                Twist::new(twist.v + error.v, twist.omega + error.omega)
            });
        let hull = |all: Twist<Interval>, corner: &Twist<Interval>| {
            Twist::new(all.v.hull(corner.v), all.omega.hull(corner.omega))
        };
        DrivenTwist { all: corners.iter().fold(twist, hull), corners, count: corners.len() }
    }
}

/// Twists that the robot may execute for a command.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrivenTwist {
    /// All of them, as independent intervals of v and ω.
    pub(crate) all: Twist<Interval>,
    /// The largest errors of both wheels, each positive or negative.
    corners: [Twist<Interval>; 4],
    /// Number of distinct corners: 1 without wheel errors.
    count: usize,
}

impl DrivenTwist {
    /// Returns the twists whose convex hull contains every executed twist.
    ///
    /// A function that is linear in the twist attains its maximum in one of them. Errors of the wheels shift v and ω together, so
    /// this maximum is smaller than that over [`DrivenTwist::all`].
    pub(crate) fn corners(&self) -> impl Iterator<Item = Twist<Interval>> + '_ {
        self.corners.iter().take(self.count).copied()
    }
}
