//! `f64` without branches. The coefficients are minimax fits (Remez), with the errors stated.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

use super::{Element, horner, polynomial};

/// Adding and subtracting 1.5·2^(digits − 1) rounds to a whole number, whose lowest bits then are those of the sum.
const SHIFT: f64 = 6_755_399_441_055_744.0;
/// What π/2 is more than its `f64`.
const QUARTER_LOW: f64 = 6.123_233_995_736_766e-17;
/// tan(π/8): beyond it the arc tangent is taken from π/4.
const TAN_22_5: f64 = 0.414_213_562_373_095_03;
const SIGN: u64 = 1 << 63;

/// (sin(√z)/√z − 1)/z for z ≤ (π/4)², relative error of the sine 2⁻⁵⁸.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_37,
    -0.000_198_412_698_297_710_97,
    2.755_731_367_864_798_7e-6,
    -2.505_075_595_930_86e-8,
    1.589_666_641_121_670_4e-10,
];
/// (cos(√z) − 1 + z/2)/z² for z ≤ (π/4)², error of the cosine 2⁻⁵³·⁵.
const COSINE: [f64; 5] = [
    0.041_666_666_666_601_93,
    -0.001_388_888_887_823_180_2,
    2.480_158_095_266_42e-5,
    -2.755_556_362_810_103e-7,
    2.064_750_945_063_471_5e-9,
];
/// sin(√z/2)/√z for z ≤ (5π/4)², error 2⁻⁵⁷.
const HALF_SINE: [f64; 9] = [
    0.5,
    -0.020_833_333_333_333_273,
    0.000_260_416_666_666_564_1,
    -1.550_099_206_280_826_2e-6,
    5.382_288_888_098_014e-9,
    -1.223_247_051_162_100_3e-11,
    1.960_285_212_333_011_4e-14,
    -2.330_683_640_076_388_2e-17,
    2.038_770_704_154_469_5e-20,
];
/// cos(√z/2) for z ≤ (5π/4)², error 2⁻⁵².
const HALF_COSINE: [f64; 9] = [
    0.999_999_999_999_999_8,
    -0.124_999_999_999_997_75,
    0.002_604_166_666_662_786_4,
    -2.170_138_888_630_211_5e-5,
    9.688_119_953_279_753e-8,
    -2.691_142_833_555_883e-10,
    5.096_685_502_279_44e-13,
    -6.989_654_072_774_588e-16,
    6.890_367_378_614_653e-19,
];
/// (atan(√z)/√z − 1)/z for z ≤ tan²(π/8), relative error of the arc tangent 2⁻⁵⁴·⁷.
const ARC_TANGENT: [f64; 10] = [
    -0.333_333_333_333_302_2,
    0.199_999_999_991_039_62,
    -0.142_857_141_964_631_45,
    0.111_111_067_007_855_3,
    -0.090_907_834_611_338_15,
    0.076_900_823_727_749_66,
    -0.066_412_375_162_278_55,
    0.056_931_183_143_455_404,
    -0.043_606_892_901_618_316,
    0.021_278_457_843_089_45,
];

impl Element for f64 {
    const EPSILON: Self = f64::EPSILON;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn from_single(value: f32) -> Self {
        f64::from(value)
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
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
        let flip_sin = (quadrant & 2) << 62;
        let flip_cos = (quadrant.wrapping_add(1) & 2) << 62;
        (f64::from_bits(sin.to_bits() ^ flip_sin), f64::from_bits(cos.to_bits() ^ flip_cos))
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
        let straight = f64::from_bits(PI.to_bits() - (self.to_bits() >> 63));
        let half = Element::min(if x < 0.0 { PI - quarter } else { quarter }, straight);
        half.with_sign_of(self)
    }
}
