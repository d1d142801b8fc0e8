//! Angles on the circle: wrapped when made, so that no difference is ever a turn too large.

use core::f64::consts::{PI, TAU};
use core::ops::{Add, Neg, Sub};

use crate::scalar::Scalar;

/// An angle in (−π, π] \[rad], counter-clockwise positive.
///
/// Sums and differences wrap. What wrapping cannot give is a winding number: an [`Angle`] does not know how
/// often the robot has turned.
///
/// ```
/// use surepose::geometry::Angle;
/// let left = Angle::from_degrees(170.0_f64);
/// let right = Angle::from_degrees(-170.0);
/// assert!(((left - right).degrees() + 20.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Angle<S>(S);

impl<S: Scalar> Angle<S> {
    /// The angle of `radians`, wrapped to (−π, π].
    #[inline(always)]
    pub fn from_radians(radians: S) -> Self {
        let (pi, tau) = (S::from_f64(PI), S::from_f64(TAU));
        let near = radians - tau * (radians * S::from_f64(1.0 / TAU)).round();
        // Rounding may leave the remainder one ulp outside; −π itself is represented by π. NaN stays NaN: a made-up
        // angle could not be rejected.
        let inside = near.clamp(-pi, pi);
        Self(S::select(inside.gt(-pi), inside, inside.abs()))
    }

    /// The angle of `radians` that were wrapped before: what [`Angle::radians`] gave, kept as a bare number.
    ///
    /// Nothing checks that they are in (−π, π].
    #[inline(always)]
    pub fn from_radians_unchecked(radians: S) -> Self {
        Self(radians)
    }

    /// The angle of `degrees`, wrapped: for the edge of the system only.
    #[inline(always)]
    pub fn from_degrees(degrees: S) -> Self {
        Self::from_radians(degrees * S::from_f64(PI / 180.0))
    }

    /// The direction of the vector (`x`, `y`); 0 for the null vector.
    #[inline(always)]
    pub fn from_vector(x: S, y: S) -> Self {
        Self(y.atan2(x))
    }

    /// `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self(S::select(mask, yes.0, no.0))
    }

    /// No turn at all.
    #[inline(always)]
    pub fn zero() -> Self {
        Self(S::from_f64(0.0))
    }

    /// Half a turn, π.
    #[inline(always)]
    pub fn half_turn() -> Self {
        Self(S::from_f64(PI))
    }

    /// This angle turned by half a turn, for which no wrap is needed.
    #[must_use]
    #[inline(always)]
    pub fn opposite(self) -> Self {
        let half = S::from_f64(PI);
        Self(S::select(self.0.gt(S::from_f64(0.0)), self.0 - half, self.0 + half))
    }

    /// The value in (−π, π] \[rad].
    #[inline(always)]
    pub fn radians(self) -> S {
        self.0
    }

    /// The value in (−180, 180] \[°], for the edge of the system only.
    #[inline(always)]
    pub fn degrees(self) -> S {
        self.0 * S::from_f64(180.0 / PI)
    }

    /// Sine and cosine.
    #[inline(always)]
    pub fn sin_cos(self) -> (S, S) {
        self.0.sin_cos()
    }

    /// This angle turned by `radians`, which may be any size.
    #[must_use]
    #[inline(always)]
    pub fn rotated_by(self, radians: S) -> Self {
        Self::from_radians(self.0 + radians)
    }

    /// This angle turned by less than a whole turn, as by the motion of one period.
    #[must_use]
    #[inline(always)]
    pub fn rotated_by_small(self, radians: S) -> Self {
        Self((self.0 + radians).wrap_once())
    }
}

impl<S: Scalar> Add for Angle<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self((self.0 + other.0).wrap_once())
    }
}

impl<S: Scalar> Sub for Angle<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self((self.0 - other.0).wrap_once())
    }
}

impl<S: Scalar> Neg for Angle<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::from_radians(-self.0)
    }
}
