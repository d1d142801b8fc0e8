//! Sine and cosine in single precision, for processors without double precision.
//!
//! `libm::sincosf` computes in double precision: on a Cortex-M4F 2100 instructions a call, a third of a step. These
//! take 60. They multiply and add separately, so that hosts with and without fused operations have the same bits.

use core::f32::consts::FRAC_2_PI;

/// (sin(√z)/√z − 1)/z for z ≤ (π/4)², relative error of the sine 2⁻²⁸: minimax fit (Remez).
pub const SINE: [f32; 3] = [-0.166_666_55, 0.008_332_176, -0.000_195_169_78];
/// (cos(√z) − 1 + z/2)/z² for z ≤ (π/4)², error of the cosine 2⁻³³: minimax fit (Remez).
pub const COSINE: [f32; 3] = [0.041_666_646, -0.001_388_736_4, 0.000_024_438_09];

/// π/2 in three parts [CodyWaite1980]. The first two have 11 and 12 bits: their products with an integer below 2¹² are exact.
const QUARTER: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
/// Largest angle \[rad] that the three parts reduce without loss.
const MAX_REDUCED: f32 = 6000.0;
/// Adding and subtracting 1.5·2²³ rounds to an integer; the low bits of the sum are those of the integer.
const SHIFT: f32 = 12_582_912.0;

/// Sine and cosine of an angle \[rad], to 1.5·10⁻⁷; NaN for NaN and infinity.
#[inline]
pub(super) fn sin_cos(angle: f32) -> (f32, f32) {
    // A NaN compares false.
    let is_reducible = angle.abs() <= MAX_REDUCED;
    if !is_reducible {
        return libm::sincosf(angle);
    }
    let shifted = angle * FRAC_2_PI + SHIFT;
    let (quadrant, quarters) = (shifted.to_bits(), shifted - SHIFT);
    let [high, middle, low] = QUARTER;
    let rest = ((angle - quarters * high) - quarters * middle) - quarters * low;
    let z = rest * rest;
    let sin = rest + rest * z * polynomial(z, SINE);
    let cos = 1.0 - 0.5 * z + z * z * polynomial(z, COSINE);
    let (sin, cos) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let flip_sin = (quadrant & 2) << 30;
    let flip_cos = (quadrant.wrapping_add(1) & 2) << 30;
    (f32::from_bits(sin.to_bits() ^ flip_sin), f32::from_bits(cos.to_bits() ^ flip_cos))
}

#[inline]
fn polynomial(z: f32, [a, b, c]: [f32; 3]) -> f32 {
    a + z * (b + z * c)
}

#[cfg(test)]
mod tests {
    use super::{MAX_REDUCED, sin_cos};

    /// Largest error of the sine and of the cosine at `count` angles from 0 to ±`end`.
    fn max_error(end: f32, count: i32) -> f64 {
        let mut max = 0.0_f64;
        for k in -count..=count {
            let angle = end * (k as f32 / count as f32);
            let (sin, cos) = sin_cos(angle);
            let (exact_sin, exact_cos) = libm::sincos(f64::from(angle));
            max = max.max((f64::from(sin) - exact_sin).abs()).max((f64::from(cos) - exact_cos).abs());
        }
        max
    }

    #[test]
    fn errors_are_about_an_ulp_at_every_angle() {
        for (end, count) in [(1e-3, 1000), (13.0, 300_000), (MAX_REDUCED, 300_000), (1e6, 1000)] {
            let error = max_error(end, count);
            assert!(error < 1.5e-7, "to {end} rad: {error}");
        }
        // Near multiples of π/2, where one of the two vanishes, the error is that of the last product: 2¹² · 7.5e-8 · 2⁻²⁴.
        for k in -3800_i32..=3800 {
            let angle = (f64::from(k) * core::f64::consts::FRAC_PI_2) as f32;
            let (sin, cos) = sin_cos(angle);
            let (small, exact) = if k % 2 == 0 {
                (sin, libm::sin(f64::from(angle)))
            } else {
                (cos, libm::cos(f64::from(angle)))
            };
            assert!((f64::from(small) - exact).abs() <= 1e-7 * exact.abs() + 2e-11, "{k}: {small}, {exact}");
        }
    }

    #[test]
    fn no_number_stays_none() {
        for angle in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (sin, cos) = sin_cos(angle);
            assert!(sin.is_nan() && cos.is_nan());
        }
    }
}
