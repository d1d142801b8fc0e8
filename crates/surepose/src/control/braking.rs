//! Braking profile: reduces gains so that the wheels can follow the deceleration.

use crate::kinematics::DiffDrive;
use crate::scalar::Scalar;

use super::gains::Gains;
use super::limits::Limits;
use super::tuning::ACCELERATION_FRACTION;

/// Gain schedule that limits the deceleration of the wheels on the way to the goal.
///
/// With a constant gain k, a wheel at speed V decelerates by k·V, which grows with the speed. The schedule reduces the gain
/// with the remaining distance s: `k(s) = 2k/(1 + √(1 + 2k²s/a))`. The speed `v = k(s)·s` solves `v²/2a + v/k = s`. The
/// first term is the braking distance at `a`; the second is the exponential settling.
///
/// # Guarantee
/// Along the profile a wheel decelerates by `a·v/(v + a/k) < a` at every speed. k(s) > 0, so that V̇ of (20) and (29)
/// keeps its sign.
/// Tested by `braking::braking_is_never_harder_than_the_wheels_can`.
///
/// # Departure
/// [Tran2012] does not model limits of the wheels' acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakingProfile<S> {
    /// 2/a \[s²/m].
    twice_per_deceleration: S,
    /// Wheel travel per radian of rotation in place \[m].
    half_separation: S,
}

impl<S: Scalar> BrakingProfile<S> {
    /// Derives the profile from `drive` and `limits`.
    pub fn from_limits(drive: &DiffDrive<S>, limits: &Limits<S>) -> Self {
        Self {
            twice_per_deceleration: S::from_f64(2.0 / ACCELERATION_FRACTION) / limits.wheel_deceleration,
            half_separation: drive.wheel_separation * S::from_f64(0.5),
        }
    }

    /// Returns the factor in (0, 1] of `gain` \[1/s] at a remaining wheel travel `distance` ≥ 0 \[m].
    #[inline(always)]
    pub fn linear_gain_factor(&self, gain: S, distance: S) -> S {
        let one = S::from_f64(1.0);
        S::from_f64(2.0) / (one + (one + gain.squared() * self.twice_per_deceleration * distance).sqrt())
    }

    /// Returns the factor in (0, 1] of `gain` \[1/s] at a remaining rotation of `angle` \[rad].
    #[inline(always)]
    pub fn angular_gain_factor(&self, gain: S, angle: S) -> S {
        self.linear_gain_factor(gain, angle.abs() * self.half_separation)
    }
}

impl BrakingProfile<f64> {
    /// Derives the profile, or `None` if the wheels can follow `gains` from full speed without it.
    pub fn from_limits_if_needed(
        drive: &DiffDrive<f64>,
        limits: &Limits<f64>,
        gains: &Gains<f64>,
    ) -> Option<Self> {
        let hardest = gains.k_v.max(gains.k_alpha).max(gains.k_theta) * limits.wheel_speed;
        (hardest > ACCELERATION_FRACTION * limits.wheel_deceleration)
            .then(|| Self::from_limits(drive, limits))
    }

    /// Converts the profile to the scalar type `T`, rounded.
    pub fn cast<T: Scalar>(&self) -> BrakingProfile<T> {
        BrakingProfile {
            twice_per_deceleration: T::from_f64(self.twice_per_deceleration),
            half_separation: T::from_f64(self.half_separation),
        }
    }
}
