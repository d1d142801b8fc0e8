//! Differential drive: wheels ↔ twist ↔ motion of the pose, [Tran2012] Eq. (1), (7)–(9).

use crate::geometry::{Frame, Pose};
use crate::param::impl_choice;
use crate::scalar::Scalar;

/// No wheel turns as fast as this \[rad/s]: a rate beyond it is of a broken encoder, or of constants that no robot has.
pub(crate) const MAX_WHEEL_RATE: f64 = 1e6;

/// How fast the robot moves: [Tran2012] Eq. (1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist<S> {
    /// Speed along the body's x axis `v` \[m/s].
    pub v: S,
    /// Turn rate `ω`, counter-clockwise \[rad/s].
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
    /// The twist of `v` \[m/s] and `omega` \[rad/s].
    #[inline(always)]
    pub fn new(v: S, omega: S) -> Self {
        Self { v, omega }
    }

    /// At rest.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::from_f64(0.0), S::from_f64(0.0))
    }

    /// Both parts times `factor`: the same path, driven at another speed.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self::new(self.v * factor, self.omega * factor)
    }

    /// `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self::new(S::select(mask, yes.v, no.v), S::select(mask, yes.omega, no.omega))
    }

    /// The motion of holding this twist for `period` \[s].
    #[inline(always)]
    pub fn integrate_for(self, period: S) -> Motion<S> {
        Motion { length: self.v * period, turn: self.omega * period }
    }
}

/// One value for each drive wheel: turn rates \[rad/s], rim speeds \[m/s] or travels \[m], as the context says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelPair<S> {
    /// The right wheel's.
    pub right: S,
    /// The left wheel's.
    pub left: S,
}

impl<S: Scalar> WheelPair<S> {
    /// One value for each wheel.
    #[inline(always)]
    pub fn new(right: S, left: S) -> Self {
        Self { right, left }
    }

    /// Neither turns.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::from_f64(0.0), S::from_f64(0.0))
    }

    /// `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self::new(S::select(mask, yes.right, no.right), S::select(mask, yes.left, no.left))
    }

    /// Both times `factor`.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self::new(self.right * factor, self.left * factor)
    }

    /// The larger of the two magnitudes.
    #[inline(always)]
    pub fn max_abs(self) -> S {
        self.right.abs().max(self.left.abs())
    }
}

/// The geometry that turns wheel rotation into motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffDrive<S> {
    /// Radius `R` of each drive wheel \[m].
    ///
    /// # Departure
    /// [Tran2012] has one: wheels of a pair differ by what their tyres carry, and a robot with equal radii in mind then
    /// drives circles.
    pub radius: WheelPair<S>,
    /// Distance `L` between the wheels' contact points \[m].
    pub wheel_separation: S,
}

impl<S: Scalar> DiffDrive<S> {
    /// Two wheels of the same radius \[m], so far apart \[m].
    #[inline(always)]
    pub const fn new(wheel_radius: S, wheel_separation: S) -> Self {
        Self { radius: WheelPair { right: wheel_radius, left: wheel_radius }, wheel_separation }
    }

    /// Motion from rim travels Δs_R, Δs_L \[m]: [Tran2012] Eq. (8).
    #[inline(always)]
    pub fn motion_from_travel(&self, travel: WheelPair<S>) -> Motion<S> {
        Motion {
            length: (travel.right + travel.left) * S::from_f64(0.5),
            turn: (travel.right - travel.left) * (S::from_f64(1.0) / self.wheel_separation),
        }
    }

    /// Rim travels \[m] of wheels that turned by these angles \[rad]; rim speeds \[m/s] for turn rates \[rad/s]:
    /// [Tran2012] Eq. (7).
    #[inline(always)]
    pub fn wheel_travel_from_angle(&self, turns: WheelPair<S>) -> WheelPair<S> {
        WheelPair::new(turns.right * self.radius.right, turns.left * self.radius.left)
    }

    /// How far the wheels turn \[rad] for these rim travels \[m], or how fast for rim speeds: the inverse of Eq. (7).
    #[inline(always)]
    pub fn wheel_angle_from_travel(&self, rims: WheelPair<S>) -> WheelPair<S> {
        WheelPair::new(rims.right / self.radius.right, rims.left / self.radius.left)
    }

    /// Rim speeds \[m/s] that give `twist`: the inverse of Eq. (8), per second.
    #[inline(always)]
    pub fn wheel_speeds_from_twist(&self, twist: Twist<S>) -> WheelPair<S> {
        let swing = twist.omega * (self.wheel_separation * S::from_f64(0.5));
        WheelPair::new(twist.v + swing, twist.v - swing)
    }

    /// The twist of rim speeds \[m/s]: Eq. (8), per second.
    #[inline(always)]
    pub fn twist_from_wheel_speeds(&self, rims: WheelPair<S>) -> Twist<S> {
        let motion = self.motion_from_travel(rims);
        Twist::new(motion.length, motion.turn)
    }

    /// Wheel turn rates \[rad/s] that give `twist`.
    #[inline(always)]
    pub fn wheel_rates_from_twist(&self, twist: Twist<S>) -> WheelPair<S> {
        self.wheel_angle_from_travel(self.wheel_speeds_from_twist(twist))
    }
}

impl DiffDrive<f64> {
    /// The same geometry, rounded to another format.
    #[inline(always)]
    pub fn cast<T: Scalar>(&self) -> DiffDrive<T> {
        let radius = WheelPair::new(T::from_f64(self.radius.right), T::from_f64(self.radius.left));
        DiffDrive { radius, wheel_separation: T::from_f64(self.wheel_separation) }
    }
}

/// A short drive along an arc: what one period of odometry measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<S> {
    /// Path length Δs, negative backwards \[m].
    pub length: S,
    /// Turn Δθ \[rad].
    pub turn: S,
}

/// How a motion moves the pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integration {
    /// Along the circular arc: exact while speed and turn rate are constant.
    ///
    /// # Departure
    /// [Tran2012] Eq. (9) is the midpoint rule, second order in Δθ. The chord of the arc is shorter than its length by
    /// sinc(Δθ/2); with that factor the motion is exact for inputs that are held over the period, as ours are.
    #[default]
    Arc,
    /// Along the chord's direction by the arc's length: [Tran2012] Eq. (9) as printed.
    Midpoint,
}

impl_choice!(Integration { Arc = "arc", Midpoint = "midpoint" });

impl<S: Scalar> Motion<S> {
    /// The motion along the arc that leads from one pose to the other: the inverse of [`Pose::integrate`].
    ///
    /// An offset of the second pose across that arc is no motion of wheels, and is left out.
    #[inline(always)]
    pub fn between<To: Frame, From: Frame>(from: Pose<To, From, S>, to: Pose<To, From, S>) -> Self {
        let (one, turn) = (S::from_f64(1.0), (to.heading - from.heading).radians());
        let (sin, cos) = from.heading.rotated_by(S::from_f64(0.5) * turn).sin_cos();
        let chord = (to.x - from.x) * cos + (to.y - from.y) * sin;
        let start = Pose::<To, From, S>::identity();
        let unit = start.integrate(Self { length: one, turn }, Integration::Arc);
        Self { length: chord / unit.origin().distance(start.origin()), turn }
    }

    /// The chord of the arc over its length Δs.
    #[inline(always)]
    fn chord(self, integration: Integration) -> S {
        match integration {
            Integration::Midpoint => S::from_f64(1.0),
            Integration::Arc => (self.turn * S::from_f64(0.5)).sinc(),
        }
    }

    /// The same, and its derivative by Δθ.
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
    /// The pose after `motion` along its own x axis: [Tran2012] Eq. (9), or its exact form, by `integration`.
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
    fn the_motion_between_poses_leads_from_one_to_the_other() {
        let from: Pose<Map, Body, f64> = Pose::new(1.0, -2.0, Angle::from_degrees(170.0));
        for motion in [(0.3, 0.5), (-0.2, -3.0), (0.4, 0.0), (0.0, 1.0)] {
            let motion = Motion { length: motion.0, turn: motion.1 };
            let to = from.integrate(motion, Integration::Arc);
            let found = Motion::between(from, to);
            assert!((found.length - motion.length).abs() < 1e-12 && (found.turn - motion.turn).abs() < 1e-12);
        }
    }
}
