//! Dual numbers: forward-mode automatic differentiation.

use core::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// Value and its derivatives with respect to `N` parameters.
///
/// With floats as scalars, the derivatives are exact up to rounding. With intervals they are enclosed, for the certificate.
/// At a corner of a function, the derivative is one-sided. Comparisons use the value only.
///
/// ```
/// use surepose::scalar::{Dual, Scalar};
/// let x: Dual<f64, 1> = Dual::parameter(2.0, 0);
/// let y = x * x * x;
/// assert_eq!((y.value, y.slope[0]), (8.0, 12.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S, const N: usize> {
    /// Value.
    pub value: S,
    /// Derivative of the value with respect to each parameter.
    pub slope: [S; N],
}

impl<S: Scalar, const N: usize> Dual<S, N> {
    /// Creates a constant: all derivatives are 0.
    #[inline]
    pub fn constant(value: S) -> Self {
        Self { value, slope: [S::from_f64(0.0); N] }
    }

    /// Creates the parameter `index` with the given value; an index out of range gives a constant.
    #[inline]
    pub fn parameter(value: S, index: usize) -> Self {
        let slope = core::array::from_fn(|i| S::from_f64(if i == index { 1.0 } else { 0.0 }));
        Self { value, slope }
    }

    /// Applies the chain rule for a function with this `value` and the derivative `rate`.
    #[inline]
    fn chain(self, value: S, rate: S) -> Self {
        Self { value, slope: self.slope.map(|s| s * rate) }
    }

    /// Applies the chain rule for a function of two arguments, with its two partial derivatives.
    #[inline]
    fn chain_two(self, other: Self, value: S, by_self: S, by_other: S) -> Self {
        let slope = core::array::from_fn(|i| self.slope[i] * by_self + other.slope[i] * by_other);
        Self { value, slope }
    }
}

impl<S: Scalar, const N: usize> Add for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let slope = core::array::from_fn(|i| self.slope[i] + other.slope[i]);
        Self { value: self.value + other.value, slope }
    }
}

impl<S: Scalar, const N: usize> Sub for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        let slope = core::array::from_fn(|i| self.slope[i] - other.slope[i]);
        Self { value: self.value - other.value, slope }
    }
}

impl<S: Scalar, const N: usize> Mul for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.chain_two(other, self.value * other.value, other.value, self.value)
    }
}

impl<S: Scalar, const N: usize> Div for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let ratio = self.value / other.value;
        let per = S::from_f64(1.0) / other.value;
        self.chain_two(other, ratio, per, -(ratio * per))
    }
}

impl<S: Scalar, const N: usize> Neg for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: self.slope.map(|s| -s) }
    }
}

impl<S: Scalar, const N: usize> Scalar for Dual<S, N> {
    type Mask = S::Mask;

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::constant(S::from_f64(value))
    }
    #[inline]
    fn lt(self, other: Self) -> S::Mask {
        self.value.lt(other.value)
    }
    #[inline]
    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        let slope = core::array::from_fn(|i| S::select(mask, yes.slope[i], no.slope[i]));
        Self { value: S::select(mask, yes.value, no.value), slope }
    }
    #[inline]
    fn abs(self) -> Self {
        let negative = self.value.lt(S::from_f64(0.0));
        self.chain(self.value.abs(), S::select(negative, S::from_f64(-1.0), S::from_f64(1.0)))
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        let chosen = Self::select(other.lt(self), other, self);
        Self { value: self.value.min(other.value), ..chosen }
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        let chosen = Self::select(self.lt(other), other, self);
        Self { value: self.value.max(other.value), ..chosen }
    }
    #[inline]
    fn round(self) -> Self {
        Self::constant(self.value.round())
    }
    #[inline]
    fn sqrt(self) -> Self {
        // At 0 the root has no derivative; 0 keeps sums finite.
        let root = self.value.sqrt();
        self.chain(root, S::from_f64(0.5).div_or_zero(root))
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let square = self.value.squared() + x.value.squared();
        let by_y = x.value.div_or_zero(square);
        let by_x = (-self.value).div_or_zero(square);
        self.chain_two(x, self.value.atan2(x.value), by_y, by_x)
    }
    #[inline]
    fn wrap_once(self) -> Self {
        Self { value: self.value.wrap_once(), ..self }
    }
    #[inline]
    fn sin_cos_sinc(self) -> (Self, Self, Self) {
        let (sin, cos, sinc) = self.value.sin_cos_sinc();
        (self.chain(sin, cos), self.chain(cos, -sin), self.chain(sinc, self.value.sinc_derivative(cos, sinc)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::geometry::Angle;

    use super::*;

    type Two = Dual<f64, 2>;

    /// Compares the derivatives of `f` with central differences.
    fn check(f: impl Fn(Two, Two) -> Two, x: f64, y: f64) -> Result<(), TestCaseError> {
        const STEP: f64 = 1e-6;
        let at = |x: f64, y: f64| f(Two::parameter(x, 0), Two::parameter(y, 1));
        let got = at(x, y).slope;
        let by_x = (at(x + STEP, y).value - at(x - STEP, y).value) / (2.0 * STEP);
        let by_y = (at(x, y + STEP).value - at(x, y - STEP).value) / (2.0 * STEP);
        for (got, want) in [(got[0], by_x), (got[1], by_y)] {
            prop_assert!((got - want).abs() < 1e-7 * (1.0 + want.abs()), "{got} is not {want}");
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn derivatives_match_differences(x in 0.2..3.0_f64, y in -3.0..-0.2_f64) {
            check(|a, b| a * b - a / b + b.squared(), x, y)?;
            check(|a, b| (a.squared() + b.squared()).sqrt() * b.abs(), x, y)?;
            check(|a, b| { let (s, c) = a.sin_cos(); s * b + c * b.sinc() }, x, y)?;
            check(|a, b| b.atan2(a) + a.min(b) * a.max(b).clamp(Two::from_f64(-9.0), Two::from_f64(9.0)), x, y)?;
            check(|a, b| Angle::from_radians(a).radians() * Angle::from_radians(b).radians() + (a * b).sinc(), x, y)?;
        }
    }

    #[test]
    fn derivatives_at_zero_are_finite() {
        let zero = Two::parameter(0.0, 0);
        for value in [zero.sqrt(), zero.atan2(Two::from_f64(0.0)), zero.sinc(), zero.abs()] {
            assert!(value.value.is_finite() && value.slope.iter().all(|s| s.is_finite()), "{value:?}");
        }
        assert!((zero.sinc().value - 1.0).abs() < 1e-15);
    }
}
