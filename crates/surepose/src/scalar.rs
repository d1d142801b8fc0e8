//! Scalar types with which models, laws and filters are evaluated.
//!
//! One source runs in `f32` on a microcontroller, in `f64` on a robot and in SIMD lanes over millions of trials. It also
//! runs in intervals for the certificate and in dual numbers for derivatives. A scalar therefore has **no order and no
//! `if`**: comparisons return a [`Mask`], and [`Scalar::select`] chooses. The mask of an interval has three values, and
//! `select` returns the hull of both operands. For lanes, `select` chooses in each lane.

mod dual;
mod float;
pub mod single;

use core::f64::consts::{PI, TAU};
use core::ops::{Add, Div, Mul, Neg, Not, Sub};

pub use dual::Dual;
pub use float::Float;

/// Result of a scalar comparison: one `bool`, one per lane, or undecided for an interval.
pub trait Mask: Copy + core::fmt::Debug + PartialEq + Not<Output = Self> + 'static {
    /// Returns a mask with `value` in every lane.
    fn splat(value: bool) -> Self;
    /// True where both masks are true.
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// True where either mask is true.
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// Returns `other` where `self` is true, else `otherwise`.
    #[must_use]
    fn select(self, other: Self, otherwise: Self) -> Self {
        self.and(other).or((!self).and(otherwise))
    }
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }
}

/// Number, or vector of numbers, with which models, laws and filters are evaluated.
///
/// Implementations must be *total*: no method panics, whatever the value.
pub trait Scalar:
    Copy
    + core::fmt::Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// Result type of comparisons.
    type Mask: Mask;

    /// Converts the constant `value` to this type, rounded.
    fn from_f64(value: f64) -> Self;

    /// True where `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` is true, else `no`.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Minimum of two values.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// Maximum of two values.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// Rounds to the nearest integer; ties are implementation-defined.
    #[must_use]
    fn round(self) -> Self;
    /// Square root; callers pass values ≥ 0.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// The angle of the vector (`x`, `self`), in (−π, π]; 0 for the null vector.
    #[must_use]
    fn atan2(self, x: Self) -> Self;

    /// Length and angle \[rad] of the vector (`x`, `self`).
    ///
    /// Types override it if they compute the angle from the length.
    #[inline(always)]
    fn polar(self, x: Self) -> (Self, Self) {
        ((x.squared() + self.squared()).sqrt(), self.atan2(x))
    }

    /// Sine, cosine and `sin(x)/x` (1 at 0) of an angle in radians.
    #[inline(always)]
    fn sin_cos_sinc(self) -> (Self, Self, Self) {
        // Below 1e-8, sin(x)/x differs from 1 by less than x²/6 < 2e-17: under half an ulp of 1 in every format.
        let near_zero = self.abs().lt(Self::from_f64(1e-8));
        let (sin, cos) = self.sin_cos();
        let one = Self::from_f64(1.0);
        let ratio = sin / Self::select(near_zero, one, self);
        (sin, cos, Self::select(near_zero, one, ratio))
    }

    /// `sin(x)/x`, continued to 1 at 0.
    #[must_use]
    #[inline(always)]
    fn sinc(self) -> Self {
        self.sin_cos_sinc().2
    }

    /// Sine and cosine of an angle \[rad] with |angle| ≤ 5π/4.
    ///
    /// A wrapped angle plus the rotation of one period is in this range. Types override it if they have a faster method
    /// than [`Scalar::sin_cos`], which accepts any angle.
    #[inline(always)]
    fn sin_cos_bounded(self) -> (Self, Self) {
        self.sin_cos()
    }

    /// Cosine and `sin(x)/x` of an angle \[rad] with |angle| ≤ 5π/4.
    #[inline(always)]
    fn cos_sinc_bounded(self) -> (Self, Self) {
        let (_, cos, sinc) = self.sin_cos_sinc();
        (cos, sinc)
    }

    /// The derivative of `sin(x)/x`, given `cos(x)` and `sin(x)/x`.
    #[must_use]
    #[inline(always)]
    fn sinc_derivative(self, cos: Self, sinc: Self) -> Self {
        // (cos x − sinc x)/x loses all digits near 0, where the series −x/3 takes over.
        let small = self.abs().lt(Self::from_f64(1e-3));
        let safe = Self::select(small, Self::from_f64(1.0), self);
        Self::select(small, -self * Self::from_f64(1.0 / 3.0), (cos - sinc) / safe)
    }

    /// Wraps an angle \[rad] that is at most one turn out of range to (−π, π].
    ///
    /// The sum of two wrapped angles is in this range. Types override it if they have a faster method than the general
    /// wrap of `Angle::from_radians`.
    #[must_use]
    #[inline(always)]
    fn wrap_once(self) -> Self {
        wrap_radians(self)
    }

    /// Limits the value to [`low`, `high`].
    #[must_use]
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// Square.
    #[must_use]
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }

    /// True where `self > other`; false where either is NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Magnitude of `self` with the sign of `other`; the sign of 0 is implementation-defined.
    #[must_use]
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        let magnitude = self.abs();
        Self::select(other.lt(Self::from_f64(0.0)), -magnitude, magnitude)
    }

    /// 1 with the sign of `self`.
    #[must_use]
    #[inline(always)]
    fn signum(self) -> Self {
        Self::from_f64(1.0).copysign(self)
    }

    /// `self / divisor`, or 0 where the divisor is not positive, as for a direction without variance.
    #[must_use]
    #[inline(always)]
    fn div_or_zero(self, divisor: Self) -> Self {
        let zero = Self::from_f64(0.0);
        let positive = divisor.gt(zero);
        Self::select(positive, self / Self::select(positive, divisor, Self::from_f64(1.0)), zero)
    }
}

/// Wraps an angle of any size \[rad] to (−π, π].
#[inline(always)]
pub(crate) fn wrap_radians<S: Scalar>(radians: S) -> S {
    let (pi, tau) = (S::from_f64(PI), S::from_f64(TAU));
    let near = radians - tau * (radians * S::from_f64(1.0 / TAU)).round();
    // Rounding may leave the remainder one ulp outside. −π is represented by π. NaN stays NaN, so that filters can
    // reject it.
    let inside = near.clamp(-pi, pi);
    S::select(inside.gt(-pi), inside, inside.abs())
}
