//! Normal deviates for lanes, by Box and Muller's transform in `f32`.

use core::f32::consts::{FRAC_PI_2, LN_2, SQRT_2};

use crate::column::Column;
use crate::element::horner;
use crate::streams::{Streams, draw};

impl<const L: usize> Streams<L> {
    /// `COUNT` independent standard normal deviates of every stream: [BoxMuller1958].
    ///
    /// Radius and direction are right to 3·10⁻⁶ of the deviate, their grid is 2⁻³¹ in probability, and the largest
    /// deviate is 6.7. Tested by `moments_and_tails_are_normal`, `streams_are_independent`.
    #[inline(always)]
    pub fn normals<const COUNT: usize>(&mut self, deviates: &mut [Column<f32, L>; COUNT]) {
        // A loop for each pair is short: the processor works on several turns of it at once.
        for columns in deviates.chunks_mut(2) {
            match columns {
                [first, second] => self.fill(|k, words| (first.0[k], second.0[k]) = normal_pair(words)),
                [last] => self.fill(|k, words| last.0[k] = normal(words)),
                _ => {}
            }
        }
    }

    /// Gives two words of every stream.
    #[inline(always)]
    fn fill(&mut self, mut take: impl FnMut(usize, [u32; 2])) {
        let [a, b, c, d] = self.state();
        for k in 0..L {
            let mut state = [a[k], b[k], c[k], d[k]];
            take(k, [draw(&mut state), draw(&mut state)]);
            [a[k], b[k], c[k], d[k]] = state;
        }
    }
}

/// −2 ln(1 + f)/f for 1 + f in [√½, √2], relative error 2⁻¹⁹·⁷.
const LOGARITHM: [f32; 7] =
    [-2.000_001_7, 1.000_028, -0.666_320_56, 0.497_936_04, -0.409_095_47, 0.375_653_18, -0.244_216_26];
/// sin a/a and cos a in a² for |a| ≤ π/2, errors 2⁻²⁰ and 2⁻²⁴.
const SINE: [f32; 4] = [0.999_999_2, -0.166_656_82, 0.008_313_259, -0.000_185_243_57];
const COSINE: [f32; 5] = [0.999_999_94, -0.499_999_05, 0.041_663_583, -0.001_385_370_4, 2.315_393_2e-5];

/// Two deviates from two random words.
#[inline(always)]
fn normal_pair([radial, angular]: [u32; 2]) -> (f32, f32) {
    let (radius, angle) = (radius(radial), angle(angular));
    let square = angle * angle;
    let along = radius * horner(square, COSINE);
    // The word's highest bit, which the angle does without, chooses the half of the circle.
    let along = f32::from_bits(along.to_bits() ^ (angular & (1 << 31)));
    (radius * (angle * horner(square, SINE)), along)
}

/// One deviate from two random words: the first of that pair.
#[inline(always)]
fn normal([radial, angular]: [u32; 2]) -> f32 {
    let angle = angle(angular);
    radius(radial) * (angle * horner(angle * angle, SINE))
}

/// √(−2 ln u) with u from 31 bits.
#[inline(always)]
fn radius(word: u32) -> f32 {
    // (k + ½)/2³¹ is in (0, 1]; its bits are those of m·2^e with m in [√½, √2).
    let uniform = ((word >> 1).cast_signed() as f32).mul_add(1.0 / 2_147_483_648.0, 0.5 / 2_147_483_648.0);
    let exponent = uniform.to_bits().wrapping_sub((SQRT_2 * 0.5).to_bits()).cast_signed() >> 23;
    let mantissa = f32::from_bits(uniform.to_bits().wrapping_sub((exponent << 23) as u32));
    let f = mantissa - 1.0;
    (exponent as f32).mul_add(-2.0 * LN_2, f * horner(f, LOGARITHM)).sqrt()
}

/// An angle in [−π/2, π/2) from 31 bits.
#[inline(always)]
fn angle(word: u32) -> f32 {
    ((word << 1).cast_signed() as f32) * (FRAC_PI_2 / 2_147_483_648.0)
}
