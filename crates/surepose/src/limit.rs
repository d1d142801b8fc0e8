//! What the wheels can do: one factor on (v, ω), so that the robot slows down along its path instead of leaving it.

use crate::drive::{Drive, Twist, Wheels};
use crate::scalar::{Mask, Scalar};

/// The limits of the drive wheels' rims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<S> {
    /// Largest rim speed \[m/s].
    pub wheel_speed: S,
    /// Largest change of a rim's speed \[m/s²].
    pub wheel_acceleration: S,
}

impl<S: Scalar> Limits<S> {
    /// The part s ≤ 1 of these `rims`' speeds \[m/s] at which the faster one runs at its limit: [Tran2012] leaves limits
    /// out.
    ///
    /// Both V̇_g and V̇_l are linear in (v, ω): scaled by s they keep their sign, and the path is the same.
    #[inline(always)]
    pub fn share(&self, rims: Wheels<S>) -> S {
        self.wheel_speed / rims.largest().max(self.wheel_speed)
    }

    /// The part of `wanted` that the limit of speed leaves.
    #[inline(always)]
    pub fn within_speed(&self, drive: &Drive<S>, wanted: Twist<S>) -> Twist<S> {
        wanted.scaled(self.share(drive.rims_from_twist(wanted)))
    }

    /// What of `wanted` the wheels can do after one `period` \[s], having done `before`.
    ///
    /// The largest common factor s ∈ (0, 1] that both accelerations allow. Where no factor does (a wheel cannot
    /// reverse at once), both wheels go the same part of the way towards `wanted`: the path is left for as long as
    /// that takes, the limit is not.
    #[inline(always)]
    pub fn grant(&self, drive: &Drive<S>, wanted: Twist<S>, before: Twist<S>, period: S) -> Twist<S> {
        let wanted = self.within_speed(drive, wanted);
        let (target, from) = (drive.rims_from_twist(wanted), drive.rims_from_twist(before));
        let reach = self.wheel_acceleration * period;

        let right = factors(target.right, from.right, reach);
        let left = factors(target.left, from.left, reach);
        let (low, high) = (right.0.max(left.0), right.1.min(left.1).min(S::of(1.0)));
        let on_path = wanted.scaled(high);

        let apart = Wheels::new(target.right - from.right, target.left - from.left).largest();
        let part = reach.over_positive(apart.max(reach));
        let towards = Twist::new(
            before.v + (wanted.v - before.v) * part,
            before.omega + (wanted.omega - before.omega) * part,
        );
        let possible = S::of(0.0).lt(high).and(!high.lt(low));
        Twist::select(possible, on_path, towards)
    }
}

impl Limits<f64> {
    /// The same limits, rounded to another format.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Limits<T> {
        Limits { wheel_speed: T::of(self.wheel_speed), wheel_acceleration: T::of(self.wheel_acceleration) }
    }
}

/// The factors s for which s·`target` is within `reach` of `from`, as (lowest, highest).
#[inline(always)]
fn factors<S: Scalar>(target: S, from: S, reach: S) -> (S, S) {
    let tiny = S::of(1e-12);
    let still = target.abs().lt(tiny);
    let per_target = S::of(1.0) / S::select(still, S::of(1.0), target);
    let (a, b) = ((from - reach) * per_target, (from + reach) * per_target);
    let (zero, one) = (S::of(0.0), S::of(1.0));
    // A wheel that shall stand still allows every factor if it can stop in time, and none otherwise.
    let can_stop = !reach.lt(from.abs());
    let highest = S::select(can_stop, one, -one);
    (S::select(still, zero, a.min(b)), S::select(still, highest, a.max(b)))
}
