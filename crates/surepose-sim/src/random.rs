//! Seeded randomness: one seed, as many independent streams as there are names.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// What everything random in a world is drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(pub u64);

impl Seed {
    /// The stream called `name`: the same for the same seed and name, independent of every other.
    ///
    /// ChaCha takes a key and a stream number; the seed makes the key and the name the number.
    pub fn stream(self, name: &str) -> Stream {
        let mut generator = ChaCha8Rng::seed_from_u64(self.0);
        generator.set_stream(hash(name));
        Stream(generator)
    }
}

/// One source of randomness.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// A standard normal number.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A number between `low` and `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let part: f64 = StandardUniform.sample(&mut self.0);
        low + (high - low) * part
    }

    /// True with `probability`.
    pub fn bernoulli(&mut self, probability: f64) -> bool {
        self.uniform(0.0, 1.0) < probability
    }

    /// A seed for something that has streams of its own.
    pub fn seed(&mut self) -> Seed {
        Seed(self.0.next_u64())
    }
}

/// FNV-1a of 64 bits: fixed for all time, unlike the standard library's hash.
fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::Seed;

    #[test]
    fn same_name_same_bits_other_name_or_seed_others() {
        let draw = |seed: u64, name: &str| {
            let mut stream = Seed(seed).stream(name);
            [stream.normal(), stream.normal(), stream.uniform(0.0, 1.0)].map(f64::to_bits)
        };
        assert_eq!(draw(7, "laser"), draw(7, "laser"));
        assert_ne!(draw(7, "laser"), draw(7, "compass"));
        assert_ne!(draw(7, "laser"), draw(8, "laser"));
    }

    #[test]
    fn streams_of_two_names_are_not_correlated() {
        let (mut a, mut b) = (Seed(1).stream("left wheel"), Seed(1).stream("right wheel"));
        let n = 20_000;
        let (mut product, mut square) = (0.0, 0.0);
        for _ in 0..n {
            let (x, y) = (a.normal(), b.normal());
            product += x * y;
            square += x * x;
        }
        // Four standard errors of the sample correlation and of the sample variance.
        let n = f64::from(n);
        assert!((product / n).abs() < 4.0 / n.sqrt());
        assert!((square / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
    }
}
