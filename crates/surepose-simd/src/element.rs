//! The number type of one lane and its branch-free elementary functions.

mod double;
mod functions;
mod single;

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use functions::element;

/// `f64` or `f32` with elementary functions that a compiler can vectorize.
///
/// | function | domain | largest error against `libm`, `f64` | against the exact value, `f32` |
/// |---|---|---|---|
/// | `sin_cos` | \|x\| ≤ 1000 | 2.3·10⁻¹⁶ | 10⁻⁷ |
/// | `cos_sinc_bounded` | \|x\| ≤ 5π/4 | 2.5·10⁻¹⁵ | 1.2·10⁻⁶ |
/// | `small_sinc` | \|x\| ≤ π/4 | 2.3·10⁻¹⁶ | 6·10⁻⁸ |
/// | `polar` | finite length whose square is a normal number | 5·10⁻¹⁶, relative | 2.3·10⁻⁷, relative |
///
/// NaN arguments give NaN. An infinite angle or coordinate gives NaN; `small_sinc` may give infinity. Tested
/// by `sine_and_cosine`, `sinc_of_small_angles`, `cos_sinc_by_half_angles`, `length_and_angle`,
/// `nan_and_infinity_propagate`.
pub trait Element:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Converts a constant, rounded to this type.
    fn from_f64(value: f64) -> Self;
    /// Converts to `f64`.
    fn to_f64(self) -> f64;
    /// Converts an `f32`, exactly.
    fn from_single(value: f32) -> Self;
    /// Fused multiply–add: `self`·`factor` + `addend`, rounded once.
    #[must_use]
    fn times_plus(self, factor: Self, addend: Self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Nearest integer.
    #[must_use]
    fn round(self) -> Self;
    /// Sine and cosine of an angle \[rad].
    fn sin_cos(self) -> (Self, Self);
    /// `sin(x)/x` for |x| ≤ π/4.
    #[must_use]
    fn small_sinc(self) -> Self;
    /// `sin(x/2)/x` for |x| ≤ 5π/4, given x².
    #[must_use]
    fn half_sine(square: Self) -> Self;
    /// `cos(x/2)` for |x| ≤ 5π/4, given x².
    #[must_use]
    fn half_cosine(square: Self) -> Self;
    /// Magnitude of `self` with the sign of `other`, signed zeros included.
    #[must_use]
    fn copysign(self, other: Self) -> Self;
    /// Length and angle in (−π, π] \[rad] of the vector (`x`, `self`); the angle of the zero vector is 0.
    fn polar(self, x: Self) -> (Self, Self);
    /// Wraps an angle within (−3π, 3π] to (−π, π] \[rad].
    #[must_use]
    fn wrap_once(self) -> Self;

    /// Distance from 1 to the next larger number.
    const EPSILON: Self;

    /// `cos(x)` and `sin(x)/x` for |x| ≤ 5π/4, by half-angle formulas without quadrants or division.
    #[inline(always)]
    fn cos_sinc_bounded(self) -> (Self, Self) {
        let square = self * self;
        let half = Self::half_sine(square);
        let sine = half * self;
        let cos = (-(sine + sine)).times_plus(sine, Self::from_f64(1.0));
        (cos, (half + half) * Self::half_cosine(square))
    }

    /// Whether the sign bit is set, signed zeros included.
    fn is_negative(self) -> bool;

    /// Smaller of two numbers.
    #[must_use]
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// Larger of two numbers.
    #[must_use]
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

/// Evaluates the polynomial Σ `coefficients`ₖ·xᵏ.
///
/// Short polynomials use Horner's rule, which needs the fewest operations. Long ones use Horner's rule in x²
/// over pairs, which halves the dependency chain.
#[inline(always)]
pub(crate) fn polynomial<T: Element, const K: usize>(x: T, coefficients: [T; K]) -> T {
    const SHORT: usize = 5;
    if K <= SHORT {
        return coefficients
            .into_iter()
            .rev()
            .reduce(|sum, next| sum.times_plus(x, next))
            .unwrap_or_default();
    }
    let square = x * x;
    let pair = |k: usize| x.times_plus(coefficients[k + 1], coefficients[k]);
    let (mut k, mut sum) =
        if K.is_multiple_of(2) { (K - 2, pair(K - 2)) } else { (K - 1, coefficients[K - 1]) };
    while k > 0 {
        k -= 2;
        sum = sum.times_plus(square, pair(k));
    }
    sum
}
