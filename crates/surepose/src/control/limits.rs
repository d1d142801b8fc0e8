//! Wheel limits: one factor scales (v, ω), so that the robot stays on its path.

use crate::kinematics::{DiffDrive, Twist, WheelPair};
use crate::scalar::{Mask, Scalar};

/// Speed and acceleration limits of the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::control::Limits;
/// use surepose::kinematics::{DiffDrive, Twist};
///
/// let limits = Limits::symmetric(0.5, 1.0);
/// let desired = Twist::new(2.0, 1.0);
/// // After one period of 0.1 s from rest, the faster rim runs at 0.1 m/s, on the same path.
/// let limited = limits.limit(&DiffDrive::new(0.05, 0.4), desired, Twist::zero(), 0.1);
/// assert!((limited.v + 0.2 * limited.omega - 0.1_f64).abs() < 1e-12);
/// assert!((limited.v / limited.omega - 2.0).abs() < 1e-12);
/// ```
pub struct Limits<S> {
    /// Maximum wheel speed \[m/s].
    pub wheel_speed: S,
    /// Maximum wheel acceleration \[m/s²].
    pub wheel_acceleration: S,
    /// Maximum wheel deceleration \[m/s²].
    pub wheel_deceleration: S,
}

impl<S: Scalar> Limits<S> {
    /// Limits of wheels that brake as hard as they accelerate: speed \[m/s], acceleration \[m/s²].
    #[inline(always)]
    pub const fn symmetric(wheel_speed: S, wheel_acceleration: S) -> Self {
        Self { wheel_speed, wheel_acceleration, wheel_deceleration: wheel_acceleration }
    }

    /// The part s ≤ 1 of these `rims`' speeds \[m/s] at which the faster one runs at its limit: [Tran2012] leaves limits
    /// out.
    ///
    /// Both V̇_g and V̇_l are linear in (v, ω): scaled by s they keep their sign, and the path is the same.
    #[inline(always)]
    pub fn scale_factor(&self, rims: WheelPair<S>) -> S {
        self.wheel_speed / rims.max_abs().max(self.wheel_speed)
    }

    /// Scales `desired` to the wheel speed limit.
    #[inline(always)]
    pub fn limit_speed(&self, drive: &DiffDrive<S>, desired: Twist<S>) -> Twist<S> {
        desired.scaled(self.scale_factor(drive.wheel_speeds_from_twist(desired)))
    }

    /// Returns the limits with the wheel speed capped at `rim_speed` > 0 \[m/s].
    #[must_use]
    #[inline(always)]
    pub fn with_speed_cap(&self, rim_speed: S) -> Self {
        Self { wheel_speed: self.wheel_speed.min(rim_speed), ..*self }
    }

    /// Limits `desired` to the twist reachable from `previous` within one `period` \[s].
    ///
    /// The largest common factor s ∈ (0, 1] that both accelerations allow. Where no factor does (a wheel cannot
    /// reverse at once), both wheels go the same part of the way towards `desired`: the path is left for as long as
    /// that takes, the limit is not.
    #[inline(always)]
    pub fn limit(&self, drive: &DiffDrive<S>, desired: Twist<S>, previous: Twist<S>, period: S) -> Twist<S> {
        let desired = self.limit_speed(drive, desired);
        let (target, start) =
            (drive.wheel_speeds_from_twist(desired), drive.wheel_speeds_from_twist(previous));
        let (right, left) = (self.reach(start.right, period), self.reach(start.left, period));

        let (right_range, left_range) =
            (right.factor_range(target.right, start.right), left.factor_range(target.left, start.left));
        let low = right_range.0.max(left_range.0);
        let high = right_range.1.min(left_range.1).min(S::from_f64(1.0));
        let on_path = desired.scaled(high);

        let fraction =
            right.fraction(target.right - start.right).min(left.fraction(target.left - start.left));
        let toward = Twist::new(
            previous.v + (desired.v - previous.v) * fraction,
            previous.omega + (desired.omega - previous.omega) * fraction,
        );
        let feasible = S::from_f64(0.0).lt(high).and(!high.lt(low));
        Twist::select(feasible, on_path, toward)
    }

    /// The largest change of a wheel's speed from `speed` \[m/s] toward `direction` within one `period` \[s].
    #[inline(always)]
    pub(super) fn largest_change(&self, speed: S, direction: S, period: S) -> S {
        let reach = self.reach(speed, period);
        S::select(direction.lt(S::from_f64(0.0)), reach.down, reach.up)
    }

    /// Largest changes of the speed of a wheel from `speed` \[m/s] within one `period` \[s].
    #[inline(always)]
    fn reach(&self, speed: S, period: S) -> SpeedReach<S> {
        let (faster, slower) = (self.wheel_acceleration * period, self.wheel_deceleration * period);
        // A wheel that reverses within the period counts as no stronger than the weaker of both.
        let slower = slower.min(faster.min(slower).max(speed.abs()));
        let is_backward = speed.lt(S::from_f64(0.0));
        SpeedReach {
            up: S::select(is_backward, slower, faster),
            down: S::select(is_backward, faster, slower),
        }
    }
}

impl Limits<f64> {
    /// Converts the limits to the scalar type `T`, rounded.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> Limits<T> {
        Limits {
            wheel_speed: T::from_f64(self.wheel_speed),
            wheel_acceleration: T::from_f64(self.wheel_acceleration),
            wheel_deceleration: T::from_f64(self.wheel_deceleration),
        }
    }
}

/// Largest increase and decrease of a wheel's speed in one period \[m/s].
struct SpeedReach<S> {
    up: S,
    down: S,
}

impl<S: Scalar> SpeedReach<S> {
    /// The factors s for which s·`target` can be reached from `start`, as (lowest, highest).
    #[inline(always)]
    fn factor_range(&self, target: S, start: S) -> (S, S) {
        let tiny = S::from_f64(1e-12);
        let stationary = target.abs().lt(tiny);
        let per_target = S::from_f64(1.0) / S::select(stationary, S::from_f64(1.0), target);
        let (a, b) = ((start - self.down) * per_target, (start + self.up) * per_target);
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        // A wheel with target speed 0 allows every factor if it can stop in time, and none otherwise.
        let can_stop = !start.lt(-self.up).or(self.down.lt(start));
        let highest = S::select(can_stop, one, -one);
        (S::select(stationary, zero, a.min(b)), S::select(stationary, highest, a.max(b)))
    }

    /// The part of `change` \[m/s] that one period allows, in \[0, 1].
    #[inline(always)]
    fn fraction(&self, change: S) -> S {
        let most = S::select(change.lt(S::from_f64(0.0)), self.down, self.up);
        most.div_or_zero(change.abs().max(most))
    }
}
