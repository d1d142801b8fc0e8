//! The loop for a path instead of a goal.

use crate::drive::{Drive, Twist, Wheels};
use crate::frame::{Body, Map};
use crate::law::{FollowLaw, Following};
use crate::limit::Limits;
use crate::path::Path;
use crate::pose::Pose;
use crate::scalar::Scalar;

use super::possible;

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
    /// How far along the path the target is \[m], less than a round: what grows without end loses its last digits.
    pub along: S,
    /// How many rounds it has behind it.
    pub rounds: S,
    /// The twist granted last.
    pub granted: Twist<S>,
}

impl<S: Scalar> Followed<S> {
    /// At rest, at the start of the path.
    pub fn fresh() -> Self {
        Self { along: S::of(0.0), rounds: S::of(0.0), granted: Twist::rest() }
    }
}

impl<S: Scalar, const N: usize> Follower<S, N> {
    /// From where the robot is to how its wheels turn \[rad/s], for one period. Where the robot is nowhere its wheels rest, and
    /// the target waits.
    #[inline]
    pub fn step(&self, followed: Followed<S>, map_from_body: Pose<Map, Body, S>) -> (Wheels<S>, Followed<S>) {
        let wanted = self.law.on_path(map_from_body, &self.path, followed.along, self.period);
        let Following { twist, pace } = wanted;
        let (granted, wheels, possible) =
            possible(&self.drive, self.limits.grant(&self.drive, twist, followed.granted, self.period));
        // The target slows down with the robot: one factor on (v, ω, ṡ).
        let part = (granted.v * twist.v).over_positive(twist.v.squared()).clamp(S::of(0.0), S::of(1.0));
        let step = S::select(possible, pace * part * self.period, S::of(0.0));
        let (along, length, one) = (followed.along + step, self.path.length(), S::of(1.0));
        let is_round = !along.lt(length);
        let rounds = followed.rounds + S::select(is_round, one, S::of(0.0));
        (wheels, Followed { along: S::select(is_round, along - length, along), rounds, granted })
    }
}
