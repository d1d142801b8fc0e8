//! Where the pose comes from that the law sees, and the bench's sensors.

use std::f64::consts::PI;

use surepose::estimation::{Ekf, Gate};
use surepose::geometry::{Angle, Line, Map};
use surepose::kinematics::Integration;
use surepose::scalar::Scalar;

use super::bench::DRIVE;

/// Where the pose comes from that the law sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PoseSource {
    /// The true pose, with white noise: the bench trial.
    #[default]
    Given,
    /// The filter's belief, from odometry, a compass and a laser: the full loop.
    Filtered(Filter),
}

/// What the filter takes the wheels and the sensors to be; what they are is [`Filter::BENCH`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Variance of a wheel's speed over the speed squared: δ of [Tran2012] Eq. (15).
    pub delta: f64,
    /// Probability that a measurement the model explains passes the gate.
    pub gate_probability: f64,
    /// Standard deviation of the compass \[rad].
    pub compass_std: f64,
    /// Standard deviation of a wall's distance, as a line fitted to a scan gives it \[m].
    pub wall_distance_std: f64,
    /// The same of its direction \[rad].
    pub wall_direction_std: f64,
}

impl Filter {
    /// The bench's: wheels that are off by 5 %, a compass of 0.1°, and walls as a line through 60 beams of 30 mm at a few
    /// metres finds them: within 5 mm and 0.25°, independently.
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

/// How far the belief of a trial is off when it begins, and knows itself to be (1 σ): x, y \[m] and heading \[rad].
pub(super) const START_STD: [f64; 3] = [0.01, 0.01, 0.5 * PI / 180.0];

/// The two walls that the laser sees wherever the robot is: ahead of the goal and to its left, beyond all starts.
pub(super) fn walls<S: Scalar>() -> [Line<Map, S>; 2] {
    [0.0, 0.5 * PI].map(|direction| Line::new(S::from_f64(5.0), Angle::from_radians(S::from_f64(direction))))
}
