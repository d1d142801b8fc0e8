//! The loop for a path instead of a goal.

use crate::drive::{Drive, Twist, Wheels};
use crate::frame::{Body, Map};
use crate::law::{FollowLaw, Following};
use crate::limit::Limits;
use crate::path::Path;
use crate::pose::Pose;
use crate::scalar::Scalar;

/// A controller that keeps the robot on a path: constants only, no hidden state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower<S, const N: usize> {
    /// The wheels' geometry.
    pub drive: Drive<S>,
    /// The path.
    pub path: Path<S, N>,
    /// The control law.
    pub law: FollowLaw<S>,
    /// What the wheels can do.
    pub limits: Limits<S>,
    /// Time between ticks \[s].
    pub period: S,
}

/// What a follower carries from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed<S> {
    /// How far along the path the target is \[m], over as many rounds as it took.
    pub along: S,
    /// The twist granted last.
    pub granted: Twist<S>,
}

impl<S: Scalar> Followed<S> {
    /// At rest, at the start of the path.
    pub fn fresh() -> Self {
        Self { along: S::of(0.0), granted: Twist::rest() }
    }
}

impl<S: Scalar, const N: usize> Follower<S, N> {
    /// From where the robot is to how its wheels turn \[rad/s], for one period.
    #[inline]
    pub fn step(&self, followed: Followed<S>, map_from_body: Pose<Map, Body, S>) -> (Wheels<S>, Followed<S>) {
        let wanted = self.law.on_path(map_from_body, &self.path, followed.along, self.period);
        let Following { twist, pace } = wanted;
        let granted = self.limits.grant(&self.drive, twist, followed.granted, self.period);
        // The target slows down with the robot: one factor on (v, ω, ṡ).
        let part = (granted.v * twist.v).over_positive(twist.v.squared()).clamp(S::of(0.0), S::of(1.0));
        let along = followed.along + pace * part * self.period;
        (self.drive.rates_from_twist(granted), Followed { along, granted })
    }
}
