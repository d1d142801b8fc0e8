//! When is moving no use? While the goal is nearer than the noise can tell.

use crate::scalar::{Mask, Scalar};

/// The distances at which the robot rests rather than follow the noise of its estimate to and fro.
///
/// The law is told how far off its estimate is. The robot does not drive where the goal is less than `reach` ahead, slows
/// down smoothly to that, and turns its travel round only for a goal 2.4 times as far behind.
///
/// # Departure
/// (23) and (28) of [Tran2012] drive for every ρ cos α ≠ 0, so that on the goal the wheels change their direction as
/// often as the noise changes its sign. v = 0 keeps V̇_l = −k_θ·θ_e² ≤ 0 and V̇_g = −k_α·α² ≤ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest<S> {
    /// \[m]
    pub reach: S,
}

/// The reach in standard deviations of the position, for a period of 1 s: the oftener the robot is told its place, the
/// oftener noise calls it to move.
const DEVIATIONS_AT_ONE_SECOND: f64 = 0.12;
/// The least \[m]: nowhere to be seen.
const LEAST: f64 = 1e-9;
/// The most, in capture radii: a robot that rests is one that the local law turns, see [`super::HybridLaw`].
const MOST_RADII: f64 = 0.13;
/// How much farther the goal must be for the robot to turn its travel round.
const TURN_ROUND: f64 = 2.4;

impl<S: Scalar> Rest<S> {
    /// The zone for an estimate whose coordinates have the standard deviation `noise` \[m], white from one period \[s]
    /// to the next.
    pub fn of(noise: S, period: S) -> Self {
        // A reach of 0 would be a quotient of nothing on the goal.
        Self { reach: (noise * S::of(DEVIATIONS_AT_ONE_SECOND) / period.sqrt()).max(S::of(LEAST)) }
    }

    /// The same, no larger than what a goal that captures within `capture_radius` \[m] leaves room for.
    #[inline(always)]
    #[must_use]
    pub(super) fn within(self, capture_radius: S) -> Self {
        Self { reach: self.reach.min(capture_radius * S::of(MOST_RADII)) }
    }

    /// What is left of the speed `v` \[m/s] where the goal is `ahead` \[m], having been about to travel in the direction
    /// `travel`; and the direction for the next tick.
    #[inline(always)]
    pub(super) fn of_speed(self, v: S, ahead: S, travel: S) -> (S, S) {
        let is_fresh = travel.abs().lt(S::of(0.5));
        let turns_round = is_fresh.or((ahead * travel).lt(self.reach * S::of(-TURN_ROUND)));
        let travel = S::select(turns_round, ahead.sign(), travel);
        let onward = (ahead * travel).max(self.reach);
        (v * (S::of(1.0) - self.reach / onward), travel)
    }
}

impl Rest<f64> {
    /// The same zone, rounded to another format.
    #[inline(always)]
    pub(super) fn cast<T: Scalar>(self) -> Rest<T> {
        Rest { reach: T::of(self.reach) }
    }
}
