//! When to slow down, where the wheels need time for it.

use crate::drive::Drive;
use crate::limit::Limits;
use crate::scalar::Scalar;

use super::gains::Gains;

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
pub struct Braking<S> {
    /// 2/a \[s²/m].
    twice_per_deceleration: S,
    /// How far a rim rolls when the robot turns by 1 rad on the spot \[m].
    lever: S,
}

/// The part of the wheels' acceleration that braking takes: the rest corrects the path.
pub(super) const SHARE: f64 = 0.7;

impl<S: Scalar> Braking<S> {
    /// For the robot of `drive` and `limits`.
    pub fn of(drive: &Drive<S>, limits: &Limits<S>) -> Self {
        Self {
            twice_per_deceleration: S::of(2.0 / SHARE) / limits.wheel_acceleration,
            lever: drive.track * S::of(0.5),
        }
    }

    /// What is left of the gain `whole` \[1/s] where a rim has `way` \[m] to go, which is not negative: a part of 1.
    #[inline(always)]
    pub fn part_of_drive(&self, whole: S, way: S) -> S {
        let one = S::of(1.0);
        S::of(2.0) / (one + (one + whole.squared() * self.twice_per_deceleration * way).sqrt())
    }

    /// The same where the robot has `angle` \[rad] to turn.
    #[inline(always)]
    pub fn part_of_turn(&self, whole: S, angle: S) -> S {
        self.part_of_drive(whole, angle.abs() * self.lever)
    }
}

impl Braking<f64> {
    /// The same as [`Braking::of`]; nothing where the wheels follow these gains from full speed, so that none need shrink.
    pub fn needed(drive: &Drive<f64>, limits: &Limits<f64>, gains: &Gains<f64>) -> Option<Self> {
        let hardest = gains.k_v.max(gains.k_alpha).max(gains.k_theta) * limits.wheel_speed;
        (hardest > SHARE * limits.wheel_acceleration).then(|| Self::of(drive, limits))
    }

    /// The same, rounded to another format.
    pub fn cast<T: Scalar>(&self) -> Braking<T> {
        Braking { twice_per_deceleration: T::of(self.twice_per_deceleration), lever: T::of(self.lever) }
    }
}
