//! Tuned parameters: all are positive and are varied by ratio.

use surepose::control::{Gains, HybridLaw, Law, Tran2012Law};
use surepose_simd::{LaneArray, Streams};

/// Gains and capture radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainCandidate {
    /// Gains of both laws.
    pub gains: Gains<f64>,
    /// ε_P \[m].
    pub capture_radius: f64,
}

/// Number of parameters.
pub(super) const NUMBERS: usize = 5;

impl GainCandidate {
    /// Returns the parameters of a law.
    pub fn from_law(law: &Law<f64>) -> Self {
        let (gains, capture_radius) = match law {
            Law::Hybrid(HybridLaw { gains, capture_radius, .. })
            | Law::Tran2012(Tran2012Law { gains, capture_radius, .. }) => (*gains, *capture_radius),
        };
        Self { gains, capture_radius }
    }

    /// Returns `law` with these parameters.
    #[must_use]
    pub fn with(&self, law: &Law<f64>) -> Law<f64> {
        let Self { gains, capture_radius } = *self;
        match *law {
            Law::Hybrid(law) => Law::Hybrid(HybridLaw { gains, capture_radius, ..law }),
            Law::Tran2012(law) => Law::Tran2012(Tran2012Law { gains, capture_radius, ..law }),
        }
    }

    /// Returns the logarithms, in which the search takes its steps.
    pub(super) fn logarithms(&self) -> [f64; NUMBERS] {
        let Gains { k_v, k_alpha, h, k_theta } = self.gains;
        [k_v, k_alpha, h, k_theta, self.capture_radius].map(libm::log)
    }

    /// Returns the candidate of these logarithms, rounded to four digits for readable files.
    pub(super) fn from_logarithms(logarithms: [f64; NUMBERS]) -> Self {
        let [k_v, k_alpha, h, k_theta, capture_radius] = logarithms.map(|l| four_digits(libm::exp(l)));
        Self { gains: Gains { k_v, k_alpha, h, k_theta }, capture_radius }
    }
}

fn four_digits(value: f64) -> f64 {
    // The decimal value is rounded, not its binary approximation, so that written and used values are
    // identical.
    format!("{value:.3e}").parse().unwrap_or(value)
}

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
