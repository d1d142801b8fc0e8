//! One lane's number, and its elementary functions without branches.

mod double;
mod functions;
mod single;

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use functions::element;

/// `f64` or `f32`, with functions a compiler can vectorise.
///
/// | function | domain | farthest from `libm`, `f64` | from the exact value, `f32` |
/// |---|---|---|---|
/// | `sin_cos` | \|x\| ≤ 1000 | 2.3·10⁻¹⁶ | 10⁻⁷ |
/// | `cos_sinc_bounded` | \|x\| ≤ 5π/4 | 2.5·10⁻¹⁵ | 1.2·10⁻⁶ |
/// | `small_sinc` | \|x\| ≤ π/4 | 2.3·10⁻¹⁶ | 6·10⁻⁸ |
/// | `polar` | a finite length whose square is a normal number | 5·10⁻¹⁶, relative | 2.3·10⁻⁷, relative |
///
/// NaN stays NaN, and an infinite angle or coordinate gives NaN, or infinity from `small_sinc`. Tested by `sine_and_cosine`,
/// `sinc_of_small_angles`, `turns_by_their_halves`, `length_and_angle`, `broken_numbers_stay_broken`.
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
    /// The constant `value`, rounded to this type.
    fn from_f64(value: f64) -> Self;
    /// The value as `f64`.
    fn to_f64(self) -> f64;
    /// The value of an `f32`.
    fn from_single(value: f32) -> Self;
    /// `self`·`factor` + `addend`, rounded once.
    #[must_use]
    fn times_plus(self, factor: Self, addend: Self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The nearest integer.
    #[must_use]
    fn round(self) -> Self;
    /// Sine and cosine of an angle in radians.
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
    /// The magnitude of this number with the sign of `other`, that of a zero too.
    #[must_use]
    fn copysign(self, other: Self) -> Self;
    /// The length of the vector (`x`, `self`), and its angle in (−π, π]; 0 for the null vector.
    fn polar(self, x: Self) -> (Self, Self);
    /// An angle that is at most a turn too large, wrapped to (−π, π].
    #[must_use]
    fn wrap_once(self) -> Self;

    /// The distance from 1 to the next larger number.
    const EPSILON: Self;

    /// `cos(x)` and `sin(x)/x` for |x| ≤ 5π/4, from those of half the angle: no quadrants to tell apart, and no division.
    #[inline(always)]
    fn cos_sinc_bounded(self) -> (Self, Self) {
        let square = self * self;
        let half = Self::half_sine(square);
        let sine = half * self;
        let cos = (-(sine + sine)).times_plus(sine, Self::from_f64(1.0));
        (cos, (half + half) * Self::half_cosine(square))
    }

    /// Whether the sign is a minus, that of a zero too.
    fn is_negative(self) -> bool;

    /// The smaller of two.
    #[must_use]
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two.
    #[must_use]
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

/// Σ `coefficients`ₖ·xᵏ: short ones by Horner's rule, in the fewest operations; long ones by Horner's rule in x² over pairs,
/// half as long a chain of operations that wait for each other.
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
