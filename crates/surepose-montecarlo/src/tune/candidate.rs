//! What is tuned, as numbers of one kind: all are positive, and matter by their ratio.

use surepose::control::{Gains, HybridLaw, Law, Tran2012Law};
use surepose_simd::{LaneArray, Streams};

/// Gains, with the capture radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainCandidate {
    /// The gains of both laws.
    pub gains: Gains<f64>,
    /// ε_P \[m].
    pub capture_radius: f64,
}

/// How many numbers that is.
pub(super) const NUMBERS: usize = 5;

impl GainCandidate {
    /// What a law has.
    pub fn from_law(law: &Law<f64>) -> Self {
        let (gains, capture_radius) = match law {
            Law::Hybrid(HybridLaw { gains, capture_radius, .. })
            | Law::Tran2012(Tran2012Law { gains, capture_radius, .. }) => (*gains, *capture_radius),
        };
        Self { gains, capture_radius }
    }

    /// `law` with these instead of its own.
    #[must_use]
    pub fn with(&self, law: &Law<f64>) -> Law<f64> {
        let Self { gains, capture_radius } = *self;
        match *law {
            Law::Hybrid(law) => Law::Hybrid(HybridLaw { gains, capture_radius, ..law }),
            Law::Tran2012(law) => Law::Tran2012(Tran2012Law { gains, capture_radius, ..law }),
        }
    }

    /// The logarithms, in which the search steps.
    pub(super) fn logarithms(&self) -> [f64; NUMBERS] {
        let Gains { k_v, k_alpha, h, k_theta } = self.gains;
        [k_v, k_alpha, h, k_theta, self.capture_radius].map(libm::log)
    }

    /// The candidate of these logarithms, rounded to four digits: nobody needs more, and files show them.
    pub(super) fn from_logarithms(logarithms: [f64; NUMBERS]) -> Self {
        let [k_v, k_alpha, h, k_theta, capture_radius] = logarithms.map(|l| four_digits(libm::exp(l)));
        Self { gains: Gains { k_v, k_alpha, h, k_theta }, capture_radius }
    }
}

fn four_digits(value: f64) -> f64 {
    // What is written is what is meant, to the last bit: so the decimal is rounded, not its binary neighbour.
    format!("{value:.3e}").parse().unwrap_or(value)
}

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
