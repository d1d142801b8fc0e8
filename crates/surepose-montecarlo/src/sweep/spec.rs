//! Parameters of a sweep: start poses, law, noise, number format.

use surepose::control::Law;

use super::bench::{self, Start, SweepNoise};
use super::filter::PoseSource;

/// Start poses of the trials.
#[derive(Clone, Debug, PartialEq)]
pub enum Starts {
    /// A number of poses, uniform in [−3, 3]² × [−180°, 180°].
    Random(usize),
    /// Trials `first` to `first + count − 1` of a longer sweep with random starts, each with the same start and noise as there.
    RandomFrom {
        /// Number of the first trial.
        first: usize,
        /// Number of trials.
        count: usize,
    },
    /// Given poses.
    Given(Vec<Start>),
}

impl Starts {
    /// Draws `count` starts within 20 cm of the goal in x and y, at any heading. There the laws switch; one
    /// of 225 random starts lies in this area.
    pub fn near_goal(count: usize, seed: u64) -> Self {
        let near = |number| {
            let far = bench::random_start(seed, number);
            Start::new(far.x * bench::NEAR, far.y * bench::NEAR, far.heading)
        };
        Self::Given((0..count).map(near).collect())
    }

    /// Returns the number of starts.
    pub fn len(&self) -> usize {
        match self {
            Self::Random(count) | Self::RandomFrom { count, .. } => *count,
            Self::Given(starts) => starts.len(),
        }
    }

    /// Returns the start of the trial with this index; `None` if there is none.
    pub(super) fn nth(&self, seed: u64, index: usize) -> Option<Start> {
        match self {
            Self::Random(count) | Self::RandomFrom { count, .. } => {
                (index < *count).then(|| bench::random_start(seed, self.number(index)))
            }
            Self::Given(starts) => starts.get(index).copied(),
        }
    }

    /// Returns the number of the trial with this index, from which it draws its start and its noise.
    pub(super) fn number(&self, index: usize) -> usize {
        match self {
            Self::RandomFrom { first, .. } => first.saturating_add(index),
            Self::Random(_) | Self::Given(_) => index,
        }
    }

    /// Returns whether there are no starts.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Number format of the loop, in SIMD lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Four bytes: microcontrollers.
    F32,
    /// Eight bytes: robots with an application processor.
    #[default]
    F64,
}

/// Parameters of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Start poses.
    pub starts: Starts,
    /// Control law with its gains.
    pub law: Law<f64>,
    /// Control period \[s], positive.
    pub period: f64,
    /// Noise of the estimate and of the wheels.
    pub noise: SweepNoise,
    /// Source of the pose that the law receives.
    pub estimate: PoseSource,
    /// Number format.
    pub precision: Precision,
    /// Number of threads, at least 1.
    pub threads: usize,
    /// Seed of all randomness.
    pub seed: u64,
}
