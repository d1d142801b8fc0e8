//! The loop for a path instead of a goal.

use crate::geometry::{Body, Map, Pose};
use crate::kinematics::{DiffDrive, Twist, WheelPair};
use crate::scalar::Scalar;

use super::controller::zero_if_infeasible;
use super::limits::Limits;
use super::path::Path;
use super::path_following::{PathCommand, PathFollowingLaw};

/// Controller that keeps the robot on a path: constants only; the state is passed in and out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathController<S, const N: usize> {
    /// Geometry of the drive.
    pub drive: DiffDrive<S>,
    /// The path.
    pub path: Path<S, N>,
    /// The control law.
    pub law: PathFollowingLaw<S>,
    /// Limits of the wheels.
    pub limits: Limits<S>,
    /// Time between ticks \[s].
    pub period: S,
}

/// State of a path controller from one tick to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathProgress<S> {
    /// Distance of the target along the path \[m], below the length of one lap: an unbounded distance would lose digits.
    pub distance: S,
    /// Number of completed laps.
    pub laps: S,
    /// The limited twist of the last tick.
    pub limited: Twist<S>,
}

impl<S: Scalar> Default for PathProgress<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> PathProgress<S> {
    /// At rest, at the start of the path.
    pub fn new() -> Self {
        Self { distance: S::from_f64(0.0), laps: S::from_f64(0.0), limited: Twist::zero() }
    }
}

impl<S: Scalar, const N: usize> PathController<S, N> {
    /// From where the robot is to how its wheels turn \[rad/s], for one period. Where the robot is nowhere its wheels rest, and
    /// the target waits.
    #[inline]
    pub fn step(
        &self,
        progress: PathProgress<S>,
        map_from_body: Pose<Map, Body, S>,
    ) -> (WheelPair<S>, PathProgress<S>) {
        let desired = self.law.compute_on_path(map_from_body, &self.path, progress.distance, self.period);
        let PathCommand { twist, target_speed } = desired;
        let (limited, wheels, feasible) = zero_if_infeasible(
            &self.drive,
            self.limits.limit(&self.drive, twist, progress.limited, self.period),
        );
        // The target slows down with the robot: one factor on (v, ω, ṡ).
        let part =
            (limited.v * twist.v).div_or_zero(twist.v.squared()).clamp(S::from_f64(0.0), S::from_f64(1.0));
        let step = S::select(feasible, target_speed * part * self.period, S::from_f64(0.0));
        let (distance, length, one) = (progress.distance + step, self.path.length(), S::from_f64(1.0));
        let is_lap = !distance.lt(length);
        let laps = progress.laps + S::select(is_lap, one, S::from_f64(0.0));
        (wheels, PathProgress { distance: S::select(is_lap, distance - length, distance), laps, limited })
    }
}
