//! Beliefs of the trials of a batch, in lanes, and their evaluation.

use surepose::estimation::{Belief, Gate};
use surepose_simd::{Element, LaneArray, Streams};

use super::bench::Start;
use super::filter::{Filter, START_STD};
use super::trial_batch::{BatchArray, Deviates};

/// One belief per trial, with factored covariance.
#[derive(Clone, Debug)]
pub(super) struct BeliefBatch<T: Element> {
    pub(super) filter: Filter,
    pub(super) gate: Gate<f64>,
    /// Estimated pose.
    pub(super) x: BatchArray<T>,
    pub(super) y: BatchArray<T>,
    pub(super) heading: BatchArray<T>,
    /// U₀₁, U₀₂, U₁₂ and D of the covariance.
    pub(super) upper: [BatchArray<T>; 3],
    pub(super) diagonal: [BatchArray<T>; 3],
    /// Evaluation of the trial's beliefs so far.
    pub(super) score: BeliefAccumulator<T>,
    /// Noise of this period: sensors first, wheels last.
    pub(super) deviates: [Deviates; 7],
}

/// Sums over the periods of a trial.
#[derive(Clone, Debug, Default)]
pub(super) struct BeliefAccumulator<T: Element> {
    /// Normalized estimation error squared (NEES).
    pub(super) nees: BatchArray<T>,
    /// Squared error of the position \[m²].
    pub(super) position: BatchArray<T>,
    /// Squared error of the heading \[rad²].
    pub(super) heading: BatchArray<T>,
    /// Measurements rejected by the gate.
    pub(super) refused: BatchArray<T>,
}

/// Index of the compass deviate.
pub(super) const OF_COMPASS: usize = 0;
/// Indices of the distance and direction deviates of each wall.
pub(super) const OF_WALLS: [[usize; 2]; 2] = [[1, 2], [3, 4]];

/// Number of measurements per period.
pub(super) const MEASUREMENTS: u64 = 3;

/// Evaluation of a trial's beliefs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Consistency {
    pub(super) nees_mean: f64,
    pub(super) position_rmse: f64,
    pub(super) heading_rmse: f64,
    pub(super) refused: f64,
}

impl<T: Element> BeliefBatch<T> {
    pub(super) fn new(filter: Filter) -> Self {
        Self {
            filter,
            gate: filter.gate(),
            x: BatchArray::default(),
            y: BatchArray::default(),
            heading: BatchArray::default(),
            upper: Default::default(),
            diagonal: Default::default(),
            score: BeliefAccumulator::default(),
            deviates: Default::default(),
        }
    }

    /// Starts trial `number` in lane `lane` at `start`, with its initial belief.
    pub(super) fn begin(&mut self, lane: usize, start: &Start, seed: u64, number: u64) {
        let [x, y, turn] = start_error(seed, number);
        let pose = surepose::geometry::Pose::new(start.x + x, start.y + y, start.heading.rotated_by(turn));
        let (upper, diagonal) = Belief::new(pose, START_STD).covariance.factors();
        self.x.0[lane] = T::from_f64(pose.x);
        self.y.0[lane] = T::from_f64(pose.y);
        self.heading.0[lane] = T::from_f64(pose.heading.radians());
        for (numbers, value) in self.upper.iter_mut().zip([upper[0][1], upper[0][2], upper[1][2]]) {
            numbers.0[lane] = T::from_f64(value);
        }
        for (numbers, value) in self.diagonal.iter_mut().zip(diagonal) {
            numbers.0[lane] = T::from_f64(value);
        }
        let score = &mut self.score;
        for sum in [&mut score.nees, &mut score.position, &mut score.heading, &mut score.refused] {
            sum.0[lane] = T::default();
        }
    }

    /// Returns the evaluation of lane `lane` over the `steps` of its trial.
    pub(super) fn consistency(&self, lane: usize, steps: u64) -> Consistency {
        let mean = |sum: &BatchArray<T>| sum.0[lane].to_f64() / steps.max(1) as f64;
        Consistency {
            nees_mean: mean(&self.score.nees),
            position_rmse: mean(&self.score.position).sqrt(),
            heading_rmse: mean(&self.score.heading).sqrt(),
            refused: mean(&self.score.refused) / MEASUREMENTS as f64,
        }
    }
}

/// Draws the initial belief error of trial `number` from a separate stream, so that the trial's stream is
/// unchanged.
fn start_error(seed: u64, number: u64) -> [f64; 3] {
    let mut streams = Streams::<1>::default();
    streams.start(0, seed ^ 0x0BE1_1EF5, number);
    let mut deviates = [LaneArray([0.0_f32]); 3];
    streams.normals(&mut deviates);
    core::array::from_fn(|k| f64::from(deviates[k].0[0]) * START_STD[k])
}
