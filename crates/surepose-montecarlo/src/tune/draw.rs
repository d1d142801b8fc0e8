//! Where the candidates of a round lie.

use surepose_simd::{LaneArray, Streams};

use super::candidate::NUMBERS;

/// Standard normal deviates for candidate `number` of `round`.
pub(super) fn deviates(seed: u64, round: usize, number: usize) -> [f64; NUMBERS] {
    let mut streams = Streams::<1>::default();
    streams.start(0, seed ^ STREAM, (round as u64) << 32 | number as u64);
    let mut drawn = [LaneArray([0.0_f32]); NUMBERS];
    streams.normals(&mut drawn);
    drawn.map(|deviate| f64::from(deviate.0[0]))
}

/// The seed of the trials of a round: none of them is a trial that the result is judged by.
pub(super) fn seed_of_round(seed: u64, round: usize) -> u64 {
    seed ^ (STREAM.rotate_left(17).wrapping_add(round as u64 + 1))
}

/// What sets the search's draws apart from the trials' with the same seed.
const STREAM: u64 = 0x7E57_0F6A_175A_2D31;
