//! Normal random numbers for lanes, by the Box–Muller transform in `f32`.

use core::f32::consts::{LN_2, SQRT_2};

use crate::element::polynomial;
use crate::lane_array::LaneArray;
use crate::streams::{Streams, draw};

impl<const L: usize> Streams<L> {
    /// Draws `COUNT` independent standard normal deviates per stream: [BoxMuller1958].
    ///
    /// The relative error is 3·10⁻⁵. The resolution is 2⁻³⁰ for the radius and 2⁻²⁴ turns for the direction.
    /// The largest magnitude is 6.56. Tested by `moments_and_tails_are_normal`, `streams_are_independent`.
    #[inline(always)]
    pub fn normals<const COUNT: usize>(&mut self, deviates: &mut [LaneArray<f32, L>; COUNT]) {
        // Several short loops let the processor overlap many iterations of each.
        for columns in deviates.chunks_mut(2) {
            match columns {
                [first, second] => {
                    self.fill(|k, words| (first.0[k], second.0[k]) = polar(words));
                    for k in 0..L {
                        (first.0[k], second.0[k]) = normal_pair(first.0[k], second.0[k]);
                    }
                }
                [last] => self.fill(|k, words| {
                    let (square, direction) = polar(words);
                    last.0[k] = normal_pair(square, direction).0;
                }),
                _ => {}
            }
        }
    }

    /// Draws two words from every stream.
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

/// Coefficients of −2 ln(1 + f)/f for 1 + f in [√½, √2], relative error 5·10⁻⁵.
const LOGARITHM: [f32; 5] = [-1.999_932_4, 0.998_901_3, -0.672_777_7, 0.541_892, -0.353_161_05];
/// Coefficients of sin πt/t and cos πt in t² for |t| ≤ ½, errors 9·10⁻⁷ and 7·10⁻⁶.
const SINE: [f32; 4] = [3.141_589_7, -5.167_368, 2.543_605, -0.558_396_05];
const COSINE: [f32; 4] = [0.999_993_3, -4.933_938, 4.041_283_8, -1.222_127_1];

/// Bit fields of an `f32`.
const SIGN: u32 = 1 << 31;
const FRACTION: u32 = (1 << 23) - 1;
const EXPONENT: u32 = !(SIGN | FRACTION);

/// Converts two random words to the squared length of a normal vector and its direction (see
/// [`normal_pair`]).
#[inline(always)]
fn polar([radial, angular]: [u32; 2]) -> (f32, f32) {
    (radius_squared(radial), f32::from_bits((angular & !EXPONENT) | 1.0_f32.to_bits()))
}

/// Coordinates of a vector of squared length `square`.
///
/// `direction` has a magnitude from 1 to 2, which spans half a turn; its sign selects the half.
#[inline(always)]
fn normal_pair(square: f32, direction: f32) -> (f32, f32) {
    let radius = square.sqrt();
    let turns = f32::from_bits(direction.to_bits() & !SIGN) - 1.5;
    let square = turns * turns;
    let along = radius * polynomial(square, COSINE);
    let along = f32::from_bits(along.to_bits() ^ (direction.to_bits() & SIGN));
    (radius * (turns * polynomial(square, SINE)), along)
}

/// −2 ln u for u = k/2³¹ with an odd 31-bit k.
#[inline(always)]
fn radius_squared(word: u32) -> f32 {
    const MIN_UNIFORM: u32 = (SQRT_2 * 0.5).to_bits();
    // The bits of k encode m·2^(31 + e) with m in [√½, √2).
    let bits = (((word >> 1) | 1).cast_signed() as f32).to_bits().wrapping_sub(MIN_UNIFORM + (31 << 23));
    let exponent = bits.cast_signed() >> 23;
    let f = f32::from_bits((bits & FRACTION) + MIN_UNIFORM) - 1.0;
    (exponent as f32).mul_add(-2.0 * LN_2, f * polynomial(f, LOGARITHM))
}
