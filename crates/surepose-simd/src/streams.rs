//! Random number streams for lanes: one independent generator per stream.

/// `L` parallel xoshiro128+ generators: [BlackmanVigna2021].
///
/// A seed and a number identify a stream, so a trial draws the same numbers in any lane, block, or thread.
/// The lowest bits are weak and are not used; the generator is meant for `f32`.
#[derive(Clone, Copy, Debug)]
pub struct Streams<const L: usize> {
    state: [[u32; L]; 4],
}

impl<const L: usize> Default for Streams<L> {
    fn default() -> Self {
        Self { state: [[1; L]; 4] }
    }
}

impl<const L: usize> Streams<L> {
    /// Starts stream `number` of `seed` in lane `lane`. A lane index of `L` or more has no effect.
    pub fn start(&mut self, lane: usize, seed: u64, number: u64) {
        // For each seed, the hash of (seed, number) is a bijection of `number`; two rounds give 128 bits.
        let mut hash = mixed(seed.wrapping_add(GOLDEN)) ^ number;
        for pair in self.state.chunks_exact_mut(2) {
            hash = mixed(hash.wrapping_add(GOLDEN));
            for (words, part) in pair.iter_mut().zip([hash, hash >> 32]) {
                if let Some(word) = words.get_mut(lane) {
                    *word = part as u32;
                }
            }
        }
        if let Some(word) = self.state[0].get_mut(lane) {
            // The all-zero state is a fixed point and must not occur.
            *word |= 1;
        }
    }

    /// Copies the state of lane `from` to lane `to`. A lane index of `L` or more has no effect.
    pub fn copy(&mut self, from: usize, to: usize) {
        for words in &mut self.state {
            if let Some(word) = words.get(from).copied()
                && let Some(copy) = words.get_mut(to)
            {
                *copy = word;
            }
        }
    }

    /// State words of all streams.
    #[inline(always)]
    pub(crate) fn state(&mut self) -> &mut [[u32; L]; 4] {
        &mut self.state
    }
}

/// Draws the next 32 bits.
#[inline(always)]
pub(crate) fn draw([a, b, c, d]: &mut [u32; 4]) -> u32 {
    let drawn = a.wrapping_add(*d);
    let t = *b << 9;
    *c ^= *a;
    *d ^= *b;
    *b ^= *c;
    *a ^= *d;
    *c ^= t;
    *d = d.rotate_left(11);
    drawn
}

/// Number `number` of `seed`, uniform in [0, 1); random access without generator state.
pub fn uniform(seed: u64, number: u64) -> f64 {
    let hash = mixed((mixed(seed.wrapping_add(GOLDEN)) ^ number).wrapping_add(GOLDEN));
    (hash >> 11) as f64 / (1_u64 << 53) as f64
}

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Output function of SplitMix64.
fn mixed(state: u64) -> u64 {
    let state = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let state = (state ^ (state >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    state ^ (state >> 31)
}
