//! `f32` and `f64` as scalars, on `libm`: the same bits on every target.

use super::Scalar;

/// A scalar that is one ordered number: what gates, histories and the edge of the system need.
pub trait Float: Scalar<Mask = bool> + PartialOrd + Default {
    /// Neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// The value as `f64`, for reports.
    fn to_f64(self) -> f64;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
}

macro_rules! float {
    ($float:ident, $shift:expr, $sqrt:ident, $fabs:ident, $sincos:ident, $atan2:ident) => {
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
                libm::$fabs(self)
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
                // Adding 1.5·2^(digits − 1) leaves no room for a fraction: IEEE 754 rounds it away, in two operations
                // where `libm::rint` takes forty. Beyond 2^(digits − 2) every number this coarse is whole anyway.
                (self + $shift) - $shift
            }
            #[inline]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                libm::$sincos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                let angle = libm::$atan2(self, x);
                // −0 is on the side of −π: the same direction as π. NaN stays NaN.
                if angle > -core::$float::consts::PI { angle } else { libm::$fabs(angle) }
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

float!(f32, 12_582_912.0, sqrtf, fabsf, sincosf, atan2f);
float!(f64, 6_755_399_441_055_744.0, sqrt, fabs, sincos, atan2);
