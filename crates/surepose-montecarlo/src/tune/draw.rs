//! Random numbers of the search.

use surepose_simd::{LaneArray, Streams};

use super::candidate::NUMBERS;

/// Returns standard normal deviates for candidate `number` of `round`.
pub(super) fn deviates(seed: u64, round: usize, number: usize) -> [f64; NUMBERS] {
    let mut streams = Streams::<1>::default();
    streams.start(0, seed ^ STREAM, (round as u64) << 32 | number as u64);
    let mut drawn = [LaneArray([0.0_f32]); NUMBERS];
    streams.normals(&mut drawn);
    drawn.map(|deviate| f64::from(deviate.0[0]))
}

/// Returns the seed of a round's trials, which differ from those of the final evaluation.
pub(super) fn seed_of_round(seed: u64, round: usize) -> u64 {
    seed ^ (STREAM.rotate_left(17).wrapping_add(round as u64 + 1))
}

/// Separates the search's streams from the trials' streams with the same seed.
const STREAM: u64 = 0x7E57_0F6A_175A_2D31;
