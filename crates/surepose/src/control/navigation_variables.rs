//! Navigation variables: the goal relative to the robot, [Tran2012] Eq. (3)–(6).

use crate::geometry::{Angle, Body, Goal, Map, Point, Pose};
use crate::kinematics::Twist;
use crate::scalar::Scalar;

/// ρ, α and φ of the goal: [Tran2012] Eq. (3).
///
/// | symbol | meaning | unit | range |
/// |---|---|---|---|
/// | `rho` | distance from robot to goal | m | ≥ 0 |
/// | `alpha` | direction of the goal, seen from the robot's heading | rad | (−π, π] |
/// | `phi` | direction of the goal, seen from the goal's heading | rad | (−π, π] |
///
/// φ − α = θ − θ₂, the heading error. On the goal itself (ρ = 0) the direction is taken as 0 in the map, so that
/// every value is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigationVariables<S> {
    /// Distance ρ \[m].
    pub rho: S,
    /// Bearing of the goal α.
    pub alpha: Angle<S>,
    /// Direction of approach φ.
    pub phi: Angle<S>,
}

impl<S: Scalar> NavigationVariables<S> {
    /// Computes the goal relative to the robot: [Tran2012] Eq. (3), or (5) where the pose is an estimate.
    #[inline(always)]
    pub fn from_poses(map_from_body: Pose<Map, Body, S>, map_from_goal: Pose<Map, Goal, S>) -> Self {
        let goal = map_from_goal.origin();
        let seen = Self::from_goal_frame(Pose::new(
            map_from_body.x - goal.x,
            map_from_body.y - goal.y,
            map_from_body.heading,
        ));
        Self { phi: seen.phi - map_from_goal.heading, ..seen }
    }

    /// Computes the variables from the pose in the goal frame.
    #[inline(always)]
    pub fn from_goal_frame(goal_from_body: Pose<Goal, Body, S>) -> Self {
        let (body, goal) = (goal_from_body.origin(), Point::new(S::from_f64(0.0), S::from_f64(0.0)));
        let (rho, bearing) = body.polar_to(goal);
        Self::from_polar(rho, bearing, goal_from_body.heading)
    }

    /// The goal `rho` \[m] away in the direction `bearing`, seen by a robot with this `heading`, both in the goal's frame.
    #[inline(always)]
    pub fn from_polar(rho: S, bearing: Angle<S>, heading: Angle<S>) -> Self {
        Self { rho, alpha: bearing - heading, phi: bearing }
    }

    /// θ_e = θ − θ₂ = φ − α, how far the robot is turned from the commanded heading.
    #[inline(always)]
    pub fn heading_error(&self) -> Angle<S> {
        self.phi - self.alpha
    }

    /// Returns the variables for driving in reverse: front and rear are exchanged.
    #[must_use]
    #[inline(always)]
    pub fn reversed(self) -> Self {
        Self { rho: self.rho, alpha: self.alpha.opposite(), phi: self.phi.opposite() }
    }

    /// `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self {
            rho: S::select(mask, yes.rho, no.rho),
            alpha: Angle::select(mask, yes.alpha, no.alpha),
            phi: Angle::select(mask, yes.phi, no.phi),
        }
    }

    /// The rates (ρ̇, α̇, φ̇) \[m/s, rad/s, rad/s] under `twist`: [Tran2012] Eq. (2).
    ///
    /// With `twist` the commanded one plus its disturbance (ε_v, ε_ω) this is Eq. (6). Only for ρ > 0.
    #[inline(always)]
    pub fn rates(&self, twist: Twist<S>) -> (S, S, S) {
        let (sin, cos) = self.alpha.sin_cos();
        let swing = twist.v * sin / self.rho;
        (-twist.v * cos, swing - twist.omega, swing)
    }
}

/// Error of the navigation variables caused by pose noise: [Tran2012] Eq. (4).
///
/// # Departure
/// The printed line for ε_φ repeats the line for ε_ρ. Here ε_φ is the wrapped difference of the two bearings; ε_α =
/// ε_φ − ε_θ as printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigationNoise<S> {
    /// ε_ρ \[m].
    pub rho: S,
    /// ε_α.
    pub alpha: Angle<S>,
    /// ε_φ.
    pub phi: Angle<S>,
}

impl<S: Scalar> NavigationNoise<S> {
    /// Estimated minus true.
    #[inline(always)]
    pub fn between(estimated: NavigationVariables<S>, truth: NavigationVariables<S>) -> Self {
        Self {
            rho: estimated.rho - truth.rho,
            alpha: estimated.alpha - truth.alpha,
            phi: estimated.phi - truth.phi,
        }
    }
}
