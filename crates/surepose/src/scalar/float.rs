//! `f32` and `f64` as scalars. Functions come from `libm`, or from [`single`], so that results are bit-identical on every target.

use super::{Scalar, single};

/// Scalar with an order: a single number, for gates, histories and interfaces.
pub trait Float: Scalar<Mask = bool> + PartialOrd + Default {
    /// Returns whether the value is neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// Converts the value to `f64`, for reports.
    fn to_f64(self) -> f64;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
}

macro_rules! float {
    ($float:ident, $shift:expr, $sqrt:ident, $sincos:expr, $atan2:ident) => {
        impl Scalar for $float {
            type Mask = bool;

            #[inline]
            #[allow(clippy::cast_lossless, reason = "lossless for f64 only; one macro serves both")]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            #[inline]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }
            #[inline]
            fn round(self) -> Self {
                // At the magnitude of 1.5·2^(digits − 1), floats have no fraction, so the addition rounds it away. These
                // two operations replace the forty of `libm::rint`. Larger values than 2^(digits − 2) are not rounded.
                (self + $shift) - $shift
            }
            #[inline]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                let angle = libm::$atan2(self, x);
                // atan2(−0, x < 0) is −π, the same direction as π. NaN stays NaN.
                if angle > -core::$float::consts::PI { angle } else { <$float>::abs(angle) }
            }
        }

        impl Float for $float {
            const EPSILON: Self = $float::EPSILON;

            #[inline]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
            #[inline]
            #[allow(clippy::cast_lossless, reason = "one macro serves both")]
            fn to_f64(self) -> f64 {
                self as f64
            }
        }
    };
}

float!(f32, 12_582_912.0, sqrtf, single::sin_cos, atan2f);
float!(f64, 6_755_399_441_055_744.0, sqrt, libm::sincos, atan2);
