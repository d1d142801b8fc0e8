//! Fig. 4 and Fig. 5 of the paper: estimation errors with odometry, compass and laser.

use std::ops::Range;

use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose_sim::{CancelToken, Seed};

use super::extraction::{Extraction, judged};
use super::loop_world::{LoopTick, LoopWorld};
use super::seeds::for_each;

/// Start of the evaluation \[s], after the initial error has decayed.
const SETTLED: f64 = 10.0;

/// Set of sensors of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Configuration {
    /// Encoders only.
    Odometry,
    /// Encoders and compass.
    Compass,
    /// Encoders and laser.
    Laser,
    /// All three.
    Both,
}

impl Configuration {
    /// All sets, in the order of the paper's figure.
    pub const ALL: [Self; 4] = [Self::Odometry, Self::Compass, Self::Laser, Self::Both];

    /// Returns the key in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Odometry => "odometry",
            Self::Compass => "odometry+compass",
            Self::Laser => "odometry+laser",
            Self::Both => "odometry+laser+compass",
        }
    }

    const fn has_compass(self) -> bool {
        matches!(self, Self::Compass | Self::Both)
    }

    const fn has_laser(self) -> bool {
        matches!(self, Self::Laser | Self::Both)
    }
}

/// Figures of many runs, over t > 10 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Number of runs.
    pub runs: usize,
    /// Root mean square of the position error \[m].
    pub position_rmse: f64,
    /// Root mean square of the heading error \[rad].
    pub heading_rmse: f64,
    /// Standard error of `position_rmse` \[m]; `None` for a single run.
    pub position_rmse_std_error: Option<f64>,
    /// Standard error of `heading_rmse` \[rad]; `None` for a single run.
    pub heading_rmse_std_error: Option<f64>,
    /// Mean of the normalized estimation error squared (NEES); 3 for a consistent filter.
    pub nees_mean: f64,
    /// Maximum error in x \[m].
    pub max_deviation_x: f64,
    /// Maximum error in y \[m].
    pub max_deviation_y: f64,
}

/// True pose and belief at one time of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviationSample {
    /// Time since the start \[s].
    pub time: f64,
    /// True pose.
    pub truth: Pose<Map, Body, f64>,
    /// Belief of the filter.
    pub belief: Belief<f64>,
}

/// Runs the localization in the loop world for each of `seeds` until canceled; `None` without a completed
/// run.
pub fn localization(
    world: &LoopWorld,
    configuration: Configuration,
    seeds: Range<u64>,
    cancel: &CancelToken,
) -> Option<Accuracy> {
    Accuracy::of(&for_each(seeds, cancel, |seed| Sum::of(world, configuration, seed)))
}

/// Comparison of all sets of sensors with the same seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Figures of each set.
    pub accuracies: Vec<(Configuration, Accuracy)>,
    /// Line extraction of the filter with all sensors.
    pub extraction: Extraction,
}

/// Compares the sets of sensors for each of `seeds` until `cancel` is canceled, which counts the seeds;
/// `None` without one.
pub fn comparison(world: &LoopWorld, seeds: Range<u64>, cancel: &CancelToken) -> Option<Comparison> {
    let runs = for_each(seeds, cancel, |seed| {
        (Configuration::ALL.map(|configuration| Sum::of(world, configuration, seed)), judged(world, seed))
    });
    let extraction = runs.iter().map(|(_, seen)| *seen).reduce(Extraction::and)?;
    let of_set = |(set, configuration): (usize, Configuration)| {
        let sums: Vec<Sum> = runs.iter().map(|(sums, _)| sums[set]).collect();
        Some((configuration, Accuracy::of(&sums)?))
    };
    let accuracies = Configuration::ALL.into_iter().enumerate().map(of_set).collect::<Option<_>>()?;
    Some(Comparison { accuracies, extraction })
}

/// Returns one run, sample by sample: the deviations over time of the paper's Fig. 5.
pub fn deviations(world: &LoopWorld, configuration: Configuration, seed: Seed) -> Vec<DeviationSample> {
    let mut moments = Vec::new();
    drive(world, configuration, seed, |moment| moments.push(moment));
    moments
}

/// Drives the course and passes every sample to `show`.
fn drive(world: &LoopWorld, configuration: Configuration, seed: Seed, mut show: impl FnMut(DeviationSample)) {
    let mut run = world.run(seed);
    let mut robot = run.robot();
    while let Some(LoopTick { truth, mut sensed }) = run.next() {
        if !configuration.has_compass() {
            sensed.headings.clear();
        }
        if !configuration.has_laser() {
            sensed.scans.clear();
        }
        let belief = run.sense(&mut robot, &sensed, &mut ());
        show(DeviationSample { time: sensed.stamp.seconds(), truth, belief });
    }
}

#[derive(Clone, Copy, Default)]
struct Sum {
    count: f64,
    position_squared: f64,
    heading_squared: f64,
    nees: f64,
    largest: [f64; 2],
}

impl Sum {
    fn of(world: &LoopWorld, configuration: Configuration, seed: Seed) -> Self {
        let mut sum = Self::default();
        drive(world, configuration, seed, |moment| sum.add(&moment));
        sum
    }

    fn add(&mut self, moment: &DeviationSample) {
        if moment.time <= SETTLED {
            return;
        }
        let [x, y, heading] = moment.belief.error(moment.truth);
        self.count += 1.0;
        self.position_squared += x * x + y * y;
        self.heading_squared += heading * heading;
        self.nees += moment.belief.nees(moment.truth);
        self.largest = [self.largest[0].max(x.abs()), self.largest[1].max(y.abs())];
    }

    fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            position_squared: self.position_squared + other.position_squared,
            heading_squared: self.heading_squared + other.heading_squared,
            nees: self.nees + other.nees,
            largest: [self.largest[0].max(other.largest[0]), self.largest[1].max(other.largest[1])],
        }
    }
}

impl Accuracy {
    fn of(runs: &[Sum]) -> Option<Self> {
        let all = runs.iter().copied().reduce(Sum::and).filter(|all| all.count > 0.0)?;
        let position = |run: &Sum| run.position_squared / run.count;
        let heading = |run: &Sum| run.heading_squared / run.count;
        let (position_rmse, heading_rmse) = (libm::sqrt(position(&all)), libm::sqrt(heading(&all)));
        Some(Self {
            runs: runs.len(),
            position_rmse,
            heading_rmse,
            position_rmse_std_error: std_error(position_rmse, runs.iter().map(position)),
            heading_rmse_std_error: std_error(heading_rmse, runs.iter().map(heading)),
            nees_mean: all.nees / all.count,
            max_deviation_x: all.largest[0],
            max_deviation_y: all.largest[1],
        })
    }
}

/// Returns the standard error of `rmse`, the root of the mean of the runs' `mean_squares`. It is that of the
/// mean over 2·`rmse`, the derivative of the square. Runs are independent; errors within a run are not.
fn std_error(rmse: f64, mean_squares: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = mean_squares.len() as f64;
    let squares: f64 = mean_squares.map(|mean_square| (mean_square - rmse * rmse).powi(2)).sum();
    (count > 1.0 && rmse > 0.0).then(|| libm::sqrt(squares / (count * (count - 1.0))) / (2.0 * rmse))
}

#[cfg(test)]
mod tests;
