//! Angles wrapped to (−π, π], so that differences never contain a full turn.

use core::f64::consts::PI;
use core::ops::{Add, Neg, Sub};

use crate::scalar::{Scalar, wrap_radians};

/// Angle in (−π, π] \[rad], counter-clockwise positive.
///
/// Sums and differences wrap. An [`Angle`] does not count full turns.
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
    /// Wraps `radians` to (−π, π]; NaN stays NaN.
    #[inline(always)]
    pub fn from_radians(radians: S) -> Self {
        Self(wrap_radians(radians))
    }

    /// Creates an angle from `radians` already in (−π, π], for example from [`Angle::radians`].
    ///
    /// The range is not checked.
    #[inline(always)]
    pub fn from_radians_unchecked(radians: S) -> Self {
        Self(radians)
    }

    /// Converts `degrees` to an angle, wrapped; for user interfaces only.
    #[inline(always)]
    pub fn from_degrees(degrees: S) -> Self {
        Self::from_radians(degrees * S::from_f64(PI / 180.0))
    }

    /// Returns the direction of the vector (`x`, `y`); 0 for the null vector.
    #[inline(always)]
    pub fn from_vector(x: S, y: S) -> Self {
        Self(y.atan2(x))
    }

    /// Returns `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self(S::select(mask, yes.0, no.0))
    }

    /// Returns the angle 0.
    #[inline(always)]
    pub fn zero() -> Self {
        Self(S::from_f64(0.0))
    }

    /// Returns π.
    #[inline(always)]
    pub fn half_turn() -> Self {
        Self(S::from_f64(PI))
    }

    /// Returns the angle rotated by π; needs no general wrap.
    #[must_use]
    #[inline(always)]
    pub fn opposite(self) -> Self {
        let half = S::from_f64(PI);
        Self(S::select(self.0.gt(S::from_f64(0.0)), self.0 - half, self.0 + half))
    }

    /// Returns the value in (−π, π] \[rad].
    #[inline(always)]
    pub fn radians(self) -> S {
        self.0
    }

    /// Returns the value in (−180, 180] \[°]; for user interfaces only.
    #[inline(always)]
    pub fn degrees(self) -> S {
        self.0 * S::from_f64(180.0 / PI)
    }

    /// Returns sine and cosine.
    #[inline(always)]
    pub fn sin_cos(self) -> (S, S) {
        self.0.sin_cos()
    }

    /// Returns the angle rotated by `radians` of any size \[rad].
    #[must_use]
    #[inline(always)]
    pub fn rotated_by(self, radians: S) -> Self {
        Self::from_radians(self.0 + radians)
    }

    /// Returns the angle rotated by |`radians`| < 2π, such as the motion of one period \[rad].
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
