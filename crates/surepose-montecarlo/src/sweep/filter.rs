//! Sources of the pose that the law receives, and the benchmark's sensors.

use std::f64::consts::PI;

use surepose::estimation::{Ekf, Gate};
use surepose::geometry::{Angle, Line, Map};
use surepose::kinematics::Integration;
use surepose::scalar::Scalar;

use super::bench::DRIVE;

/// Source of the pose that the law receives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PoseSource {
    /// True pose with white noise: the benchmark trial.
    #[default]
    Given,
    /// Belief of the filter, from odometry, compass and laser: the full loop.
    Filtered(Filter),
}

/// Noise parameters of the filter; the true noise is [`Filter::BENCH`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Relative variance of a wheel's speed: δ of [Tran2012] Eq. (15).
    pub delta: f64,
    /// Probability with which a consistent measurement passes the gate.
    pub gate_probability: f64,
    /// Standard deviation of the compass \[rad].
    pub compass_std: f64,
    /// Standard deviation of a wall's distance from a line fitted to a scan \[m].
    pub wall_distance_std: f64,
    /// Standard deviation of a wall's direction from a line fitted to a scan \[rad].
    pub wall_direction_std: f64,
}

impl Filter {
    /// Noise of the benchmark: wheels with 5 %, a compass with 0.1°, and walls with 5 mm and 0.25°,
    /// independently. The wall noise is that of a line through 60 beams of 30 mm at a few meters.
    pub const BENCH: Self = Self {
        delta: 0.0025,
        gate_probability: 0.999,
        compass_std: 0.1 * PI / 180.0,
        wall_distance_std: 0.005,
        wall_direction_std: 0.25 * PI / 180.0,
    };

    pub(super) fn ekf<S: Scalar>(&self) -> Ekf<S> {
        Ekf { drive: DRIVE.cast(), delta: S::from_f64(self.delta), integration: Integration::Arc }
    }

    pub(super) fn gate(&self) -> Gate<f64> {
        Gate::new(self.gate_probability)
    }
}

/// Standard deviations of the initial belief: x, y \[m] and heading \[rad].
pub(super) const START_STD: [f64; 3] = [0.01, 0.01, 0.5 * PI / 180.0];

/// Returns the two walls, visible from every start: ahead of the goal and to its left.
pub(super) fn walls<S: Scalar>() -> [Line<Map, S>; 2] {
    [0.0, 0.5 * PI].map(|direction| Line::new(S::from_f64(5.0), Angle::from_radians(S::from_f64(direction))))
}
