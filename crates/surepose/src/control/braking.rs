//! When to slow down, where the wheels need time for it.

use crate::kinematics::DiffDrive;
use crate::scalar::Scalar;

use super::gains::Gains;
use super::limits::Limits;

/// How hard the rims may brake on their way to the goal.
///
/// With a gain k alone, a rim that runs at V brakes with k·V: the harder the faster it runs. Here the gain shrinks with the
/// way s that is left: `k(s) = 2k/(1 + √(1 + 2k²s/a))`. The speed `v = k(s)·s` solves `v²/2a + v/k = s`: the way of braking
/// with `a`, and the exponential end of the drive.
///
/// # Guarantee
/// Along it the rim brakes with `a·v/(v + a/k) < a`, at every speed; and k(s) > 0, so that V̇ of (20) and (29) keeps its sign.
/// Tested by `braking::braking_is_never_harder_than_the_wheels_can`.
///
/// # Departure
/// [Tran2012] leaves out what wheels can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakingProfile<S> {
    /// 2/a \[s²/m].
    twice_per_deceleration: S,
    /// How far a rim rolls when the robot turns by 1 rad on the spot \[m].
    half_separation: S,
}

/// The part of the wheels' acceleration that braking takes: the rest corrects the path.
pub(super) const ACCELERATION_FRACTION: f64 = 0.7;

impl<S: Scalar> BrakingProfile<S> {
    /// For the robot of `drive` and `limits`.
    pub fn from_limits(drive: &DiffDrive<S>, limits: &Limits<S>) -> Self {
        Self {
            twice_per_deceleration: S::from_f64(2.0 / ACCELERATION_FRACTION) / limits.wheel_acceleration,
            half_separation: drive.wheel_separation * S::from_f64(0.5),
        }
    }

    /// What is left of the gain `gain` \[1/s] where a rim has `distance` \[m] to go, which is not negative: a part of 1.
    #[inline(always)]
    pub fn linear_gain_factor(&self, gain: S, distance: S) -> S {
        let one = S::from_f64(1.0);
        S::from_f64(2.0) / (one + (one + gain.squared() * self.twice_per_deceleration * distance).sqrt())
    }

    /// The same where the robot has `angle` \[rad] to turn.
    #[inline(always)]
    pub fn angular_gain_factor(&self, gain: S, angle: S) -> S {
        self.linear_gain_factor(gain, angle.abs() * self.half_separation)
    }
}

impl BrakingProfile<f64> {
    /// The same as [`BrakingProfile::from_limits`]; nothing where the wheels follow these gains from full speed, so that none need shrink.
    pub fn from_limits_if_needed(
        drive: &DiffDrive<f64>,
        limits: &Limits<f64>,
        gains: &Gains<f64>,
    ) -> Option<Self> {
        let hardest = gains.k_v.max(gains.k_alpha).max(gains.k_theta) * limits.wheel_speed;
        (hardest > ACCELERATION_FRACTION * limits.wheel_acceleration)
            .then(|| Self::from_limits(drive, limits))
    }

    /// The same, rounded to another format.
    pub fn cast<T: Scalar>(&self) -> BrakingProfile<T> {
        BrakingProfile {
            twice_per_deceleration: T::from_f64(self.twice_per_deceleration),
            half_separation: T::from_f64(self.half_separation),
        }
    }
}
