//! The benchmark: robot, limits and noise, fixed so that laws can be compared.

use std::f64::consts::PI;

use surepose::control::{Deadband, Direction, HybridLaw, Law, Limits};
use surepose::geometry::Angle;
use surepose::kinematics::DiffDrive;
use surepose_simd::uniform;

/// Start pose, relative to the goal.
pub type Start = surepose::geometry::Pose<surepose::geometry::Goal, surepose::geometry::Body, f64>;

/// Wheel geometry of the robot.
pub const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);

/// Maximum rim speed of a wheel \[m/s].
const WHEEL_SPEED: f64 = 0.3;

/// Half the side of the square of random starts \[m].
const REACH: f64 = 3.0;
/// Fraction of that square that is near the goal.
pub(super) const NEAR: f64 = 1.0 / 15.0;

/// Noise of the law's input and of the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepNoise {
    /// Standard deviation of the estimated x and y \[m]; white.
    pub position: f64,
    /// Standard deviation of the estimated heading \[rad]; white.
    pub heading: f64,
    /// Relative standard deviation of a wheel's speed; white.
    pub wheels: f64,
}

impl SweepNoise {
    /// No noise.
    pub const NONE: Self = Self { position: 0.0, heading: 0.0, wheels: 0.0 };
    /// Noise of the benchmark.
    pub const BENCH: Self = Self { position: 0.005, heading: 0.3 * PI / 180.0, wheels: 0.05 };

    /// Returns all noise multiplied by `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            position: self.position * factor,
            heading: self.heading * factor,
            wheels: self.wheels * factor,
        }
    }
}

/// Returns the limits of the benchmark's wheels: no acceleration limit.
pub fn limits() -> Limits<f64> {
    Limits::symmetric(WHEEL_SPEED, f64::INFINITY)
}

/// Returns the default law for the benchmark's robot with the given noise.
pub fn fitted_law(period: f64, direction: Direction, noise: SweepNoise) -> Law<f64> {
    let law = HybridLaw::fitted(&DRIVE, &limits(), period, direction);
    let deadband = (noise.position > 0.0).then(|| Deadband::from_noise(noise.position, period));
    Law::Hybrid(HybridLaw { deadband, ..law })
}

/// Position tolerance at the goal \[m].
pub const POSITION_TOLERANCE: f64 = 0.01;
/// Heading tolerance at the goal \[rad].
pub const HEADING_TOLERANCE: f64 = PI / 180.0;
/// Time for which the goal must be held \[s].
const HOLD: f64 = 1.0;
/// Timeout of a trial \[s].
const TIMEOUT: f64 = 120.0;

/// Termination of a trial, in periods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Termination {
    /// Consecutive instants inside the tolerance for success.
    pub(super) held: f64,
    /// Number of periods until the timeout.
    pub(super) most: u64,
}

impl Termination {
    /// Returns the termination of the benchmark.
    pub(super) fn for_benchmark(period: f64) -> Self {
        Self { held: (HOLD / period - 1e-9).ceil() + 1.0, most: (TIMEOUT / period).round() as u64 }
    }
}

/// Returns whether a start is within the goal tolerance.
pub(super) fn is_inside(start: &Start) -> bool {
    let distance_squared = start.x * start.x + start.y * start.y;
    distance_squared <= POSITION_TOLERANCE * POSITION_TOLERANCE
        && start.heading.radians().abs() <= HEADING_TOLERANCE
}

/// Returns the start pose of random trial `number`.
pub(super) fn random_start(seed: u64, number: usize) -> Start {
    let draw = |which: u64, reach: f64| (2.0 * uniform(seed, 3 * number as u64 + which) - 1.0) * reach;
    Start::new(draw(0, REACH), draw(1, REACH), Angle::from_radians(draw(2, PI)))
}
