//! Kinematics of the differential drive: wheels, twist and motion of the pose, [Tran2012] Eq. (1), (7)–(9).

use crate::geometry::{Angle, Frame, Pose};
use crate::param::impl_choice;
use crate::scalar::{Float, Scalar};

/// Maximum plausible turn rate of a wheel \[rad/s]. Higher rates come from a faulty encoder or from wrong constants.
pub(crate) const MAX_WHEEL_RATE: f64 = 1e6;

/// Velocity of the robot: [Tran2012] Eq. (1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist<S> {
    /// Speed v along the x axis of the body \[m/s].
    pub v: S,
    /// Turn rate ω, counter-clockwise \[rad/s].
    pub omega: S,
}

impl<S: Scalar> core::ops::Sub for Twist<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.v - other.v, self.omega - other.omega)
    }
}

impl<S: Scalar> Twist<S> {
    /// Creates a twist from speed `v` \[m/s] and turn rate `omega` \[rad/s].
    #[inline(always)]
    pub fn new(v: S, omega: S) -> Self {
        Self { v, omega }
    }

    /// Returns the twist of a robot at rest.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::from_f64(0.0), S::from_f64(0.0))
    }

    /// Multiplies both components by `factor`; the path stays the same.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self::new(self.v * factor, self.omega * factor)
    }

    /// Returns `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self::new(S::select(mask, yes.v, no.v), S::select(mask, yes.omega, no.omega))
    }

    /// Returns the motion at this constant twist over `period` \[s].
    #[inline(always)]
    pub fn integrate_for(self, period: S) -> Motion<S> {
        Motion { length: self.v * period, turn: self.omega * period }
    }
}

/// One value per drive wheel: turn rate \[rad/s], angle \[rad], rim speed \[m/s] or rim travel \[m], depending on the context.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelPair<S> {
    /// Value of the right wheel.
    pub right: S,
    /// Value of the left wheel.
    pub left: S,
}

impl<S: Scalar> WheelPair<S> {
    /// Creates a pair from the values of the right and the left wheel.
    #[inline(always)]
    pub fn new(right: S, left: S) -> Self {
        Self { right, left }
    }

    /// Returns zero for both wheels.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::from_f64(0.0), S::from_f64(0.0))
    }

    /// Returns `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self::new(S::select(mask, yes.right, no.right), S::select(mask, yes.left, no.left))
    }

    /// Multiplies both values by `factor`.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self::new(self.right * factor, self.left * factor)
    }

    /// Returns the larger of both magnitudes.
    #[inline(always)]
    pub fn max_abs(self) -> S {
        self.right.abs().max(self.left.abs())
    }
}

/// Geometry of a differential drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffDrive<S> {
    /// Radius R of each drive wheel \[m].
    ///
    /// # Departure
    /// [Tran2012] has one radius. Real radii differ with tire wear and load, so that equal radii in the model bend
    /// straight paths.
    pub radius: WheelPair<S>,
    /// Distance L between the contact points of the wheels \[m].
    pub wheel_separation: S,
}

impl<S: Scalar> DiffDrive<S> {
    /// Creates a drive with equal wheel radii \[m] and the given wheel separation \[m].
    #[inline(always)]
    pub const fn new(wheel_radius: S, wheel_separation: S) -> Self {
        Self { radius: WheelPair { right: wheel_radius, left: wheel_radius }, wheel_separation }
    }

    /// Computes the motion from the rim travels Δs_R, Δs_L \[m]: [Tran2012] Eq. (8).
    #[inline(always)]
    pub fn motion_from_travel(&self, travel: WheelPair<S>) -> Motion<S> {
        Motion {
            length: (travel.right + travel.left) * S::from_f64(0.5),
            turn: (travel.right - travel.left) * (S::from_f64(1.0) / self.wheel_separation),
        }
    }

    /// Computes rim travels \[m] from wheel angles \[rad]: [Tran2012] Eq. (7).
    ///
    /// It also converts turn rates \[rad/s] to rim speeds \[m/s].
    #[inline(always)]
    pub fn wheel_travel_from_angle(&self, turns: WheelPair<S>) -> WheelPair<S> {
        WheelPair::new(turns.right * self.radius.right, turns.left * self.radius.left)
    }

    /// Computes wheel angles \[rad] from rim travels \[m]: the inverse of Eq. (7).
    ///
    /// It also converts rim speeds \[m/s] to turn rates \[rad/s].
    #[inline(always)]
    pub fn wheel_angle_from_travel(&self, rims: WheelPair<S>) -> WheelPair<S> {
        WheelPair::new(rims.right / self.radius.right, rims.left / self.radius.left)
    }

    /// Computes the rim speeds \[m/s] for `twist`: the inverse of Eq. (8), per second.
    #[inline(always)]
    pub fn wheel_speeds_from_twist(&self, twist: Twist<S>) -> WheelPair<S> {
        let swing = twist.omega * (self.wheel_separation * S::from_f64(0.5));
        WheelPair::new(twist.v + swing, twist.v - swing)
    }

    /// Computes the twist from rim speeds \[m/s]: Eq. (8), per second.
    #[inline(always)]
    pub fn twist_from_wheel_speeds(&self, rims: WheelPair<S>) -> Twist<S> {
        let motion = self.motion_from_travel(rims);
        Twist::new(motion.length, motion.turn)
    }

    /// Computes the turn rates of the wheels \[rad/s] for `twist`.
    #[inline(always)]
    pub fn wheel_rates_from_twist(&self, twist: Twist<S>) -> WheelPair<S> {
        self.wheel_angle_from_travel(self.wheel_speeds_from_twist(twist))
    }
}

impl DiffDrive<f64> {
    /// Converts the geometry to the scalar type `T`, rounded.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> DiffDrive<T> {
        let radius = WheelPair::new(T::from_f64(self.radius.right), T::from_f64(self.radius.left));
        DiffDrive { radius, wheel_separation: T::from_f64(self.wheel_separation) }
    }
}

/// Motion along an arc, such as the motion of one odometry period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<S> {
    /// Path length Δs \[m], negative in reverse.
    pub length: S,
    /// Rotation Δθ \[rad].
    pub turn: S,
}

/// Integration rule of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integration {
    /// Circular arc: exact for constant speed and turn rate.
    ///
    /// # Departure
    /// [Tran2012] Eq. (9) is the midpoint rule, of second order in Δθ. The ratio of the chord to the length of the arc is
    /// sinc(Δθ/2). With this factor the motion is exact for commands that are constant over the period.
    #[default]
    Arc,
    /// Midpoint rule: the length of the arc in the direction of its chord, [Tran2012] Eq. (9) as printed.
    Midpoint,
}

impl_choice!(Integration { Arc = "arc", Midpoint = "midpoint" });

impl<S: Scalar> Motion<S> {
    /// Computes the arc from one pose to another: the inverse of [`Pose::integrate`].
    ///
    /// A lateral offset of the second pose from this arc is ignored, because wheels cannot produce it.
    #[inline(always)]
    pub fn between<To: Frame, From: Frame>(from: Pose<To, From, S>, to: Pose<To, From, S>) -> Self {
        let (one, turn) = (S::from_f64(1.0), (to.heading - from.heading).radians());
        let (sin, cos) = from.heading.rotated_by(S::from_f64(0.5) * turn).sin_cos();
        let chord = (to.x - from.x) * cos + (to.y - from.y) * sin;
        let start = Pose::<To, From, S>::identity();
        let unit = start.integrate(Self { length: one, turn }, Integration::Arc);
        Self { length: chord / unit.origin().distance(start.origin()), turn }
    }

    /// Splits the way from one pose to another into a turn, a straight line and a turn, which keep all of it.
    ///
    /// For a gap in odometry, over which the way was no arc. The line is driven forward or in reverse, whichever turns less at
    /// first.
    pub fn turn_drive_turn<To: Frame, From: Frame>(
        from: Pose<To, From, S>,
        to: Pose<To, From, S>,
    ) -> [Self; 3]
    where
        S: Float,
    {
        let zero = S::from_f64(0.0);
        let step = from.inverse() * to;
        let turn = (to.heading - from.heading).radians();
        let length = from.origin().distance(to.origin());
        let is_reverse = step.x < zero;
        let sign = S::from_f64(if is_reverse { -1.0 } else { 1.0 });
        let first = (step.y * sign).atan2(step.x * sign);
        let last = Angle::from_radians(turn - first).radians();
        [
            Self { length: zero, turn: first },
            Self { length: length * sign, turn: zero },
            Self { length: zero, turn: last },
        ]
    }

    /// Returns the ratio of the chord to the length Δs.
    #[inline(always)]
    fn chord(self, integration: Integration) -> S {
        match integration {
            Integration::Midpoint => S::from_f64(1.0),
            Integration::Arc => (self.turn * S::from_f64(0.5)).sinc(),
        }
    }

    /// Returns the ratio of the chord to the length Δs, and its derivative with respect to Δθ.
    #[inline(always)]
    pub(crate) fn chord_and_derivative(self, integration: Integration) -> (S, S) {
        match integration {
            Integration::Midpoint => (S::from_f64(1.0), S::from_f64(0.0)),
            Integration::Arc => {
                let half = self.turn * S::from_f64(0.5);
                let (_, cos, sinc) = half.sin_cos_sinc();
                (sinc, half.sinc_derivative(cos, sinc) * S::from_f64(0.5))
            }
        }
    }
}

impl<To: Frame, From: Frame, S: Scalar> Pose<To, From, S> {
    /// Moves the pose by `motion`, with the given integration rule: [Tran2012] Eq. (9) or its exact form.
    #[must_use]
    #[inline(always)]
    pub fn integrate(self, motion: Motion<S>, integration: Integration) -> Self {
        let (sin, cos) = (self.heading.radians() + motion.turn * S::from_f64(0.5)).sin_cos_bounded();
        let length = motion.length * motion.chord(integration);
        Self::new(self.x + length * cos, self.y + length * sin, self.heading.rotated_by_small(motion.turn))
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Angle, Body, Map, Pose};

    use super::{Integration, Motion};

    #[test]
    fn motion_between_poses_inverts_integrate() {
        let from: Pose<Map, Body, f64> = Pose::new(1.0, -2.0, Angle::from_degrees(170.0));
        for motion in [(0.3, 0.5), (-0.2, -3.0), (0.4, 0.0), (0.0, 1.0)] {
            let motion = Motion { length: motion.0, turn: motion.1 };
            let to = from.integrate(motion, Integration::Arc);
            let found = Motion::between(from, to);
            assert!((found.length - motion.length).abs() < 1e-12 && (found.turn - motion.turn).abs() < 1e-12);
        }
    }
}
