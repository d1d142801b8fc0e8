//! Parameters of a sweep on a base that is not ideal.

use surepose::control::{ActuatorModel, Controller};
use surepose::kinematics::DiffDrive;
use surepose_sim::{PlantModel, Traction};

use super::bench::SweepNoise;
use super::spec::Starts;

/// Parameters of a sweep on a base with dead bands, delay, lag, limits and slip of its own.
///
/// A trial is that of the benchmark: success is 1 s within 1 cm and 1° of the goal in truth, within 120 s. It fails at
/// once where the navigator would abort the goal.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantSweep {
    /// Start poses.
    pub starts: Starts,
    /// Controller of the robot.
    pub controller: Controller<f64>,
    /// Base as the controller assumes it.
    pub actuator: ActuatorModel<f64>,
    /// Time without motion, though motion is commanded, after which the goal is aborted \[s].
    pub stall_timeout: f64,
    /// Time without progress after which the goal is aborted \[s].
    pub progress_timeout: f64,
    /// True wheel geometry.
    pub drive: DiffDrive<f64>,
    /// True base.
    pub plant: PlantModel,
    /// True grip of the wheels.
    pub traction: Traction,
    /// Noise of the estimate and of the wheels.
    pub noise: SweepNoise,
    /// Number of threads, at least 1.
    pub threads: usize,
    /// Seed of all randomness.
    pub seed: u64,
}
