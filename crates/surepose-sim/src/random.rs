//! Seeded random numbers: one seed, and independent streams by name.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// Seed of all random numbers of a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(pub u64);

impl Seed {
    /// Creates the stream `name`, deterministic and independent of all other streams.
    ///
    /// ChaCha takes a key and a stream number; the key derives from the seed, and the number from the name.
    pub fn stream(self, name: &str) -> Stream {
        let mut generator = ChaCha8Rng::seed_from_u64(self.0);
        generator.set_stream(hash(name));
        Stream(generator)
    }
}

/// One random number stream.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// Draws a standard normal number.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Draws a number uniformly from [`low`, `high`).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let part: f64 = StandardUniform.sample(&mut self.0);
        low + (high - low) * part
    }

    /// Returns `true` with the given probability.
    pub fn bernoulli(&mut self, probability: f64) -> bool {
        self.uniform(0.0, 1.0) < probability
    }

    /// Draws a seed for an object with its own streams.
    pub fn seed(&mut self) -> Seed {
        Seed(self.0.next_u64())
    }
}

/// 64-bit FNV-1a hash; stable across releases, unlike the hash of the standard library.
fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::Seed;

    #[test]
    fn streams_depend_on_seed_and_name_only() {
        let draw = |seed: u64, name: &str| {
            let mut stream = Seed(seed).stream(name);
            [stream.normal(), stream.normal(), stream.uniform(0.0, 1.0)].map(f64::to_bits)
        };
        assert_eq!(draw(7, "laser"), draw(7, "laser"));
        assert_ne!(draw(7, "laser"), draw(7, "compass"));
        assert_ne!(draw(7, "laser"), draw(8, "laser"));
    }

    #[test]
    fn streams_are_uncorrelated() {
        let (mut a, mut b) = (Seed(1).stream("left wheel"), Seed(1).stream("right wheel"));
        let n = 20_000;
        let (mut product, mut square) = (0.0, 0.0);
        for _ in 0..n {
            let (x, y) = (a.normal(), b.normal());
            product += x * y;
            square += x * x;
        }
        // Bounds of four standard errors of the sample correlation and of the sample variance.
        let n = f64::from(n);
        assert!((product / n).abs() < 4.0 / n.sqrt());
        assert!((square / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
    }
}
