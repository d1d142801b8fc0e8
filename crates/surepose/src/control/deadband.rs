//! When is moving no use? While the goal is nearer than the noise can tell.

use crate::scalar::{Mask, Scalar};

/// The distances at which the robot rests rather than follow the noise of its estimate to and fro.
///
/// The law is told how far off its estimate is. The robot does not drive where the goal is less than `radius` ahead, slows
/// down smoothly to that, and turns its travel round only for a goal 2.4 times as far behind.
///
/// # Departure
/// (23) and (28) of [Tran2012] drive for every ρ cos α ≠ 0, so that on the goal the wheels change their direction as
/// often as the noise changes its sign. v = 0 keeps V̇_l = −k_θ·θ_e² ≤ 0 and V̇_g = −k_α·α² ≤ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deadband<S> {
    /// \[m]
    pub radius: S,
}

/// The radius in standard deviations of the position, for a period of 1 s: the oftener the robot is told its place, the
/// oftener noise calls it to move.
const STD_DEVS_AT_ONE_SECOND: f64 = 0.12;
/// The least \[m]: nowhere to be seen.
const MIN_RADIUS: f64 = 1e-9;
/// The most, in capture radii: a robot that rests is one that the local law turns, see [`super::HybridLaw`].
const MAX_CAPTURE_RADII: f64 = 0.13;
/// How much farther the goal must be for the robot to turn its travel round.
const REVERSAL_FACTOR: f64 = 2.4;

impl<S: Scalar> Deadband<S> {
    /// The zone for an estimate whose coordinates have the standard deviation `noise` \[m], white from one period \[s]
    /// to the next.
    pub fn from_noise(noise: S, period: S) -> Self {
        // A radius of 0 would be a quotient of nothing on the goal.
        Self {
            radius: (noise * S::from_f64(STD_DEVS_AT_ONE_SECOND) / period.sqrt())
                .max(S::from_f64(MIN_RADIUS)),
        }
    }

    /// The same, no larger than what a goal that captures within `capture_radius` \[m] leaves room for.
    #[inline(always)]
    #[must_use]
    pub(super) fn capped(self, capture_radius: S) -> Self {
        Self { radius: self.radius.min(capture_radius * S::from_f64(MAX_CAPTURE_RADII)) }
    }

    /// What is left of the speed `v` \[m/s] where the goal is `ahead` \[m], having been about to travel in the direction
    /// `drive_direction`; and the direction for the next tick.
    #[inline(always)]
    pub(super) fn apply(self, v: S, ahead: S, drive_direction: S) -> (S, S) {
        let is_undecided = drive_direction.abs().lt(S::from_f64(0.5));
        let reverses =
            is_undecided.or((ahead * drive_direction).lt(self.radius * S::from_f64(-REVERSAL_FACTOR)));
        let drive_direction = S::select(reverses, ahead.signum(), drive_direction);
        let onward = (ahead * drive_direction).max(self.radius);
        (v * (S::from_f64(1.0) - self.radius / onward), drive_direction)
    }
}

impl Deadband<f64> {
    /// The same zone, rounded to another format.
    #[inline(always)]
    pub(super) fn cast<T: Scalar>(self) -> Deadband<T> {
        Deadband { radius: T::from_f64(self.radius) }
    }
}
