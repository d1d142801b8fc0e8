//! `f32` without branches. The coefficients are minimax fits (Remez), with the errors stated.

use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

use super::{Element, horner, polynomial};

/// Adding and subtracting 1.5·2^(digits − 1) rounds to a whole number, whose lowest bits then are those of the sum.
const SHIFT: f32 = 12_582_912.0;
/// What π/2 is more than its `f32`.
const QUARTER_LOW: f32 = -4.371_139e-8;
/// tan(π/8): beyond it the arc tangent is taken from π/4.
const TAN_22_5: f32 = 0.414_213_57;
const SIGN: u32 = 1 << 31;

/// (sin(√z)/√z − 1)/z for z ≤ (π/4)², relative error of the sine 2⁻²⁸.
const SINE: [f32; 3] = [-0.166_666_55, 0.008_332_176, -0.000_195_169_78];
/// (cos(√z) − 1 + z/2)/z² for z ≤ (π/4)², error of the cosine 2⁻³³.
const COSINE: [f32; 3] = [0.041_666_646, -0.001_388_736_4, 0.000_024_438_09];
/// sin(√z/2)/√z for z ≤ (5π/4)², error 2⁻²⁵·⁶.
const HALF_SINE: [f32; 5] = [0.499_999_97, -0.020_833_27, 0.000_260_383_8, -1.544_080_4e-6, 4.929_714e-9];
/// cos(√z/2) for z ≤ (5π/4)², error 2⁻²¹.
const HALF_COSINE: [f32; 5] = [0.999_999_6, -0.124_998_63, 0.002_603_451_5, -2.157_031_3e-5, 8.699_871e-8];
/// (atan(√z)/√z − 1)/z for z ≤ tan²(π/8), relative error of the arc tangent 2⁻²⁵·⁶.
const ARC_TANGENT: [f32; 4] = [-0.333_329_56, 0.199_779_2, -0.138_797_8, 0.080_600_66];

impl Element for f32 {
    const EPSILON: Self = f32::EPSILON;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn from_single(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        (self + SHIFT) - SHIFT
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        // x = q·π/2 + r with |r| ≤ π/4. π/2 in parts keeps the digits of r: the products by a small q are exact.
        let shifted = self.mul_add(FRAC_2_PI, SHIFT);
        let quadrant = shifted.to_bits();
        let quarters = shifted - SHIFT;
        let r = (-quarters).mul_add(QUARTER_LOW, (-quarters).mul_add(FRAC_PI_2, self));
        let z = r * r;
        let sin = (r * z).mul_add(polynomial(z, SINE), r);
        let cos = (z * z).mul_add(polynomial(z, COSINE), z.mul_add(-0.5, 1.0));

        let odd = quadrant & 1 != 0;
        let (sin, cos) = (if odd { cos } else { sin }, if odd { sin } else { cos });
        let flip_sin = (quadrant & 2) << 30;
        let flip_cos = (quadrant.wrapping_add(1) & 2) << 30;
        (f32::from_bits(sin.to_bits() ^ flip_sin), f32::from_bits(cos.to_bits() ^ flip_cos))
    }
    #[inline(always)]
    fn small_sinc(self) -> Self {
        let z = self * self;
        z.mul_add(horner(z, SINE), 1.0)
    }
    #[inline(always)]
    fn half_sine(square: Self) -> Self {
        horner(square, HALF_SINE)
    }
    #[inline(always)]
    fn half_cosine(square: Self) -> Self {
        horner(square, HALF_COSINE)
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self.to_bits() & SIGN != 0
    }
    #[inline(always)]
    fn with_sign_of(self, other: Self) -> Self {
        Self::from_bits((self.to_bits() & !SIGN) | (other.to_bits() & SIGN))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        // The angle within the octant, from 0 or from π/4, whichever is nearer: the quotient stays below tan(π/8).
        let (across, up) = (x.abs(), self.abs());
        let (low, high) = (Element::min(up, across), Element::max(across, up));
        let steep = low > high * TAN_22_5;
        let numerator = if steep { low - high } else { low };
        let denominator = if steep { low + high } else { high };
        let tangent = numerator / (denominator + Self::MIN_POSITIVE);
        let z = tangent * tangent;
        let from = if steep { FRAC_PI_4 } else { 0.0 };
        let octant = from + (tangent * z).mul_add(horner(z, ARC_TANGENT), tangent);

        let quarter = if up > across { FRAC_PI_2 - octant } else { octant };
        // Below the axis the largest angle is a hair less than π: −π is the same direction as π, which stands for both.
        let straight = f32::from_bits(PI.to_bits() - (self.to_bits() >> 31));
        let half = Element::min(if x < 0.0 { PI - quarter } else { quarter }, straight);
        half.with_sign_of(self)
    }
}
