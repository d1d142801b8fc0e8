//! Deadband: the robot stands still while the goal distance is below the estimate noise.

use crate::scalar::{Mask, Scalar};

use super::tuning::{DEADBAND_STD_DEVS, MAX_DEADBAND_RADIUS, REVERSAL_FACTOR};

/// Distances at which the robot stands still instead of following estimate noise.
///
/// The speed is zero where the goal is less than `radius` ahead, and decreases smoothly toward that distance. The travel
/// direction reverses only for a goal 2.4 times as far behind.
///
/// # Departure
/// (23) and (28) of [Tran2012] drive for every ρ cos α ≠ 0, so that on the goal the wheels change their direction as
/// often as the noise changes its sign. v = 0 keeps V̇_l = −k_θ·θ_e² ≤ 0 and V̇_g = −k_α·α² ≤ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deadband<S> {
    /// \[m]
    pub radius: S,
}

/// Minimum radius \[m]: negligible.
const MIN_RADIUS: f64 = 1e-9;

impl<S: Scalar> Deadband<S> {
    /// Derives the deadband for an estimate whose coordinates have the standard deviation `noise` \[m], white from one period \[s]
    /// to the next.
    pub fn from_noise(noise: S, period: S) -> Self {
        // A radius of 0 would divide 0 by 0 at the goal.
        Self { radius: (noise * S::from_f64(DEADBAND_STD_DEVS) / period.sqrt()).max(S::from_f64(MIN_RADIUS)) }
    }

    /// Limits the radius to a fraction of `capture_radius` \[m].
    #[inline(always)]
    #[must_use]
    pub(super) fn capped(self, capture_radius: S) -> Self {
        Self { radius: self.radius.min(capture_radius * S::from_f64(MAX_DEADBAND_RADIUS)) }
    }

    /// Reduces the speed `v` \[m/s] for a goal `ahead` \[m] and the last travel direction `drive_direction`.
    ///
    /// Returns the speed and the direction for the next tick.
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
    /// Converts the deadband to the scalar type `T`, rounded.
    #[inline(always)]
    pub(super) fn cast<T: Scalar>(self) -> Deadband<T> {
        Deadband { radius: T::from_f64(self.radius) }
    }
}
