//! Normal deviates for lanes, by Box and Muller's transform in `f32`.

use core::f32::consts::{FRAC_PI_4, LN_2, SQRT_2};

use crate::element::polynomial;
use crate::streams::{Streams, draw};

impl<const L: usize> Streams<L> {
    /// `PAIRS` pairs of independent standard normal deviates of every stream: [BoxMuller1958].
    ///
    /// Radius and direction are right to 3·10⁻⁶ of the deviate, their grid is 2⁻³¹ in probability, and the largest
    /// deviate is 6.7. Tested by `moments_and_tails_are_normal`, `streams_are_independent`.
    #[inline(always)]
    pub fn normals<const PAIRS: usize>(&mut self, deviates: &mut [[[f32; L]; 2]; PAIRS]) {
        let [a, b, c, d] = self.state();
        for k in 0..L {
            let mut state = [a[k], b[k], c[k], d[k]];
            for [first, second] in deviates.iter_mut() {
                (first[k], second[k]) = normal_pair(draw(&mut state), draw(&mut state));
            }
            [a[k], b[k], c[k], d[k]] = state;
        }
    }
}

/// ln(1 + f)/f for 1 + f in [√½, √2], relative error 2⁻¹⁹·⁸.
const LOGARITHM: [f32; 7] =
    [1.000_001, -0.500_011_15, 0.333_145, -0.249_097_03, 0.204_964_74, -0.186_683_22, 0.118_961_03];
/// sin a/a and cos a in a² for |a| ≤ π/4, errors 2⁻¹⁹ and 2⁻²³.
const SINE: [f32; 3] = [1.0, -0.166_634_52, 0.008_164_442];
const COSINE: [f32; 4] = [1.0, -0.5, 0.041_661_268, -0.001_365_221_5];

/// √(−2 ln u)·(sin, cos) of a direction, with u and the direction from 31 and 32 random bits.
#[inline(always)]
fn normal_pair(radial: u32, angular: u32) -> (f32, f32) {
    // (k + ½)/2³¹ is in (0, 1]; its bits are those of m·2^e with m in [√½, √2).
    let uniform = ((radial >> 1).cast_signed() as f32).mul_add(1.0 / 2_147_483_648.0, 0.5 / 2_147_483_648.0);
    let exponent = uniform.to_bits().wrapping_sub((SQRT_2 * 0.5).to_bits()).cast_signed() >> 23;
    let mantissa = f32::from_bits(uniform.to_bits().wrapping_sub((exponent << 23) as u32));
    let f = mantissa - 1.0;
    let logarithm = f.mul_add(polynomial(f, LOGARITHM), exponent as f32 * LN_2);
    let radius = (logarithm * -2.0).sqrt();

    // 30 bits turn by up to π/4 either way; two choose which axis that is about, and its sign.
    let angle = ((angular << 2).cast_signed() as f32) * (FRAC_PI_4 / 2_147_483_648.0);
    let z = angle * angle;
    let (sin, cos) = (angle * polynomial(z, SINE), polynomial(z, COSINE));
    let along = radius * f32::from_bits(cos.to_bits() | (angular & (1 << 31)));
    let across = radius * sin;
    let swap = angular & (1 << 30) != 0;
    if swap { (along, across) } else { (across, along) }
}
