//! The bench: the robot, its limits and its noise. All of them are given, so that laws can be compared.

use std::f64::consts::PI;

use surepose::control::{Deadband, Direction, HybridLaw, Law, Limits};
use surepose::geometry::Angle;
use surepose::kinematics::DiffDrive;
use surepose_simd::uniform;

/// A start pose, seen from the goal.
pub type Start = surepose::geometry::Pose<surepose::geometry::Goal, surepose::geometry::Body, f64>;

/// The robot's geometry.
pub const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);

/// Largest speed of a wheel's rim \[m/s].
const WHEEL_SPEED: f64 = 0.3;

/// Half the side of the square of random starts \[m].
const REACH: f64 = 3.0;
/// The part of it that is near the goal.
pub(super) const NEAR: f64 = 1.0 / 15.0;

/// What is wrong with what the law sees and with what the wheels do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepNoise {
    /// Standard deviation of the estimated x and y \[m], white.
    pub position: f64,
    /// Standard deviation of the estimated heading \[rad], white.
    pub heading: f64,
    /// Standard deviation of a wheel's speed over that speed, white.
    pub wheels: f64,
}

impl SweepNoise {
    /// None at all.
    pub const NONE: Self = Self { position: 0.0, heading: 0.0, wheels: 0.0 };
    /// The bench's.
    pub const BENCH: Self = Self { position: 0.005, heading: 0.3 * PI / 180.0, wheels: 0.05 };

    /// All of it, `factor` times as large.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            position: self.position * factor,
            heading: self.heading * factor,
            wheels: self.wheels * factor,
        }
    }
}

/// What the bench's wheels can do: no acceleration limit.
pub fn limits() -> Limits<f64> {
    Limits { wheel_speed: WHEEL_SPEED, wheel_acceleration: f64::INFINITY }
}

/// The default law for the bench's robot, told how far off its estimate is.
pub fn fitted_law(period: f64, direction: Direction, noise: SweepNoise) -> Law<f64> {
    let law = HybridLaw::fitted(&DRIVE, &limits(), period, direction);
    let deadband = (noise.position > 0.0).then(|| Deadband::from_noise(noise.position, period));
    Law::Hybrid(HybridLaw { deadband, ..law })
}

/// How far from the goal counts as there \[m].
pub const POSITION_TOLERANCE: f64 = 0.01;
/// How far turned counts as there \[rad].
pub const HEADING_TOLERANCE: f64 = PI / 180.0;
/// How long the pose must be held \[s].
const HOLD: f64 = 1.0;
/// When a trial is given up \[s].
const TIMEOUT: f64 = 120.0;

/// When a trial ends, in periods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Termination {
    /// Instants in a row inside the tolerance that are success.
    pub(super) held: f64,
    /// Periods after which the trial is given up.
    pub(super) most: u64,
}

impl Termination {
    /// The bench's.
    pub(super) fn for_benchmark(period: f64) -> Self {
        Self { held: (HOLD / period - 1e-9).ceil() + 1.0, most: (TIMEOUT / period).round() as u64 }
    }
}

/// Whether a trial that begins so begins on the goal.
pub(super) fn is_inside(start: &Start) -> bool {
    let distance_squared = start.x * start.x + start.y * start.y;
    distance_squared <= POSITION_TOLERANCE * POSITION_TOLERANCE
        && start.heading.radians().abs() <= HEADING_TOLERANCE
}

/// The start pose of random trial `number`.
pub(super) fn random_start(seed: u64, number: usize) -> Start {
    let draw = |which: u64, reach: f64| (2.0 * uniform(seed, 3 * number as u64 + which) - 1.0) * reach;
    Start::new(draw(0, REACH), draw(1, REACH), Angle::from_radians(draw(2, PI)))
}
