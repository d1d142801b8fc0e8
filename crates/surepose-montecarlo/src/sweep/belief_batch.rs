//! What the trials of a batch believe, side by side, and how that is judged.

use surepose::estimation::{Belief, Gate};
use surepose_simd::{Element, LaneArray, Streams};

use super::bench::Start;
use super::filter::{Filter, START_STD};
use super::trial_batch::{BatchArray, Deviates};

/// One belief for each trial, as the factors of its covariance.
#[derive(Clone, Debug)]
pub(super) struct BeliefBatch<T: Element> {
    pub(super) filter: Filter,
    pub(super) gate: Gate<f64>,
    /// The estimated pose.
    pub(super) x: BatchArray<T>,
    pub(super) y: BatchArray<T>,
    pub(super) heading: BatchArray<T>,
    /// U₀₁, U₀₂, U₁₂ and D of the covariance.
    pub(super) upper: [BatchArray<T>; 3],
    pub(super) diagonal: [BatchArray<T>; 3],
    /// How good the beliefs of the trial were so far.
    pub(super) score: BeliefAccumulator<T>,
    /// The noise of this period: of the sensors, and last of the wheels.
    pub(super) deviates: [Deviates; 7],
}

/// Sums over the periods of a trial.
#[derive(Clone, Debug, Default)]
pub(super) struct BeliefAccumulator<T: Element> {
    /// Of the normalised estimation error squared.
    pub(super) nees: BatchArray<T>,
    /// Of the squared error of the position \[m²].
    pub(super) position: BatchArray<T>,
    /// Of the squared error of the heading \[rad²].
    pub(super) heading: BatchArray<T>,
    /// Of measurements that the gate kept out.
    pub(super) refused: BatchArray<T>,
}

/// Which deviate is the compass's.
pub(super) const OF_COMPASS: usize = 0;
/// Which are the distance's and the direction's of each wall.
pub(super) const OF_WALLS: [[usize; 2]; 2] = [[1, 2], [3, 4]];

/// Measurements in a period.
pub(super) const MEASUREMENTS: u64 = 3;

/// What came of a trial's beliefs.
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

    /// Lane `lane` begins trial `number` at `start`, which it believes as well as it knows.
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

    /// How good the beliefs of lane `lane` were, in the `steps` of its trial.
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

/// How far the first belief of trial `number` is off: from a stream of its own, so that the trial's is not moved.
fn start_error(seed: u64, number: u64) -> [f64; 3] {
    let mut streams = Streams::<1>::default();
    streams.start(0, seed ^ 0x0BE1_1EF5, number);
    let mut deviates = [LaneArray([0.0_f32]); 3];
    streams.normals(&mut deviates);
    core::array::from_fn(|k| f64::from(deviates[k].0[0]) * START_STD[k])
}
