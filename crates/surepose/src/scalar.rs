//! The numbers the law is evaluated with: one trait, so that there is one law.
//!
//! The same source runs in `f32` on a microcontroller, in `f64` on a robot, in SIMD lanes over millions of
//! trials, in intervals for the certificate and in dual numbers for derivatives. A scalar therefore has **no
//! order and no `if`**: comparisons give a [`Mask`], and [`Scalar::select`] chooses. For an interval the mask has
//! three values and `select` answers with the hull; for lanes it chooses lane by lane.

mod dual;
mod float;

use core::ops::{Add, Div, Mul, Neg, Not, Sub};

pub use dual::Dual;
pub use float::Float;

/// The outcome of comparing scalars: one `bool`, or one per lane, or "cannot tell" for an interval.
pub trait Mask: Copy + core::fmt::Debug + PartialEq + Not<Output = Self> + 'static {
    /// The mask that is `value` everywhere.
    fn splat(value: bool) -> Self;
    /// True where both are.
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// True where either is.
    #[must_use]
    fn or(self, other: Self) -> Self;
    /// `other` where `self` is true, else `otherwise`: how a hysteresis keeps or changes its mind.
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

/// A number, or a bundle of numbers, that the model, the law and the filter can be evaluated with.
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
    /// What comparing gives.
    type Mask: Mask;

    /// The constant `value`, rounded to this type.
    fn from_f64(value: f64) -> Self;

    /// True where `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` is true, else `no`.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// The smaller of two.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The larger of two.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The nearest integer (which of two at a tie is left to the implementation).
    #[must_use]
    fn round(self) -> Self;
    /// Square root; callers pass values that are not negative.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// The angle of the vector (`x`, `self`), in (−π, π]; 0 for the null vector.
    #[must_use]
    fn atan2(self, x: Self) -> Self;

    /// The length of the vector (`x`, `self`), and its angle.
    ///
    /// For scalars that come to the angle by the length.
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

    /// Sine and cosine of an angle of at most 5π/4, as a wrapped one is that turns on for a period \[rad].
    ///
    /// For scalars that know a shorter way than [`Scalar::sin_cos`], which takes any angle.
    #[inline(always)]
    fn sin_cos_bounded(self) -> (Self, Self) {
        self.sin_cos()
    }

    /// Cosine and `sin(x)/x` of such an angle.
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

    /// An angle \[rad] that is at most a turn too large, as the sum of two wrapped ones is, wrapped to (−π, π].
    ///
    /// For scalars that know a shorter way than [`Angle::from_radians`](crate::geometry::Angle::from_radians), which takes any angle.
    #[must_use]
    #[inline(always)]
    fn wrap_once(self) -> Self {
        crate::geometry::Angle::from_radians(self).radians()
    }

    /// The value limited to [`low`, `high`].
    #[must_use]
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// The square.
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

    /// The magnitude of `self` with the sign of `other`; which of the two where that is 0 is left to the implementation.
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

    /// `self / divisor`, or 0 where the divisor is not positive: a direction without variance has nothing to share.
    #[must_use]
    #[inline(always)]
    fn div_or_zero(self, divisor: Self) -> Self {
        let zero = Self::from_f64(0.0);
        let positive = divisor.gt(zero);
        Self::select(positive, self / Self::select(positive, divisor, Self::from_f64(1.0)), zero)
    }
}
