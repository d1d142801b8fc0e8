//! What to sweep: the starts, the law, the noise, the numbers' precision.

use surepose::control::Law;

use super::bench::{self, Start, SweepNoise};
use super::filter::PoseSource;

/// Where the trials start.
#[derive(Clone, Debug, PartialEq)]
pub enum Starts {
    /// This many, uniform in [−3, 3]² × [−180°, 180°].
    Random(usize),
    /// These.
    Given(Vec<Start>),
}

impl Starts {
    /// This many within 20 cm of the goal in x and y, at any heading: where laws hand over, and where a random start is
    /// once in 225 times.
    pub fn near_goal(count: usize, seed: u64) -> Self {
        let near = |number| {
            let far = bench::random_start(seed, number);
            Start::new(far.x * bench::NEAR, far.y * bench::NEAR, far.heading)
        };
        Self::Given((0..count).map(near).collect())
    }

    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Self::Random(count) => *count,
            Self::Given(starts) => starts.len(),
        }
    }

    /// The start of trial `number`, if there is one.
    pub(super) fn nth(&self, seed: u64, number: usize) -> Option<Start> {
        match self {
            Self::Random(count) => (number < *count).then(|| bench::random_start(seed, number)),
            Self::Given(starts) => starts.get(number).copied(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The numbers that the loop is computed with, in SIMD lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Four bytes: the microcontroller's.
    F32,
    /// Eight bytes: the robot's.
    #[default]
    F64,
}

/// What to sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Where the trials start.
    pub starts: Starts,
    /// The law, its gains included.
    pub law: Law<f64>,
    /// Time between ticks \[s], positive.
    pub period: f64,
    /// What is wrong with the estimate and the wheels.
    pub noise: SweepNoise,
    /// Where the pose comes from that the law sees.
    pub estimate: PoseSource,
    /// What the loop is computed with.
    pub precision: Precision,
    /// How many threads, at least 1.
    pub threads: usize,
    /// What all randomness comes from.
    pub seed: u64,
}
