//! The interface between the certificate and a controller.

use surepose::control::{BrakingProfile, ControlOutput, HybridState, Law, Limits, NavigationVariables};
use surepose::kinematics::{DiffDrive, Twist};
use surepose::scalar::Scalar;

/// A sampled controller: maps the estimated navigation variables to a wheel command.
///
/// The certificate accesses the control law only through this trait, so the tests can substitute faulty laws.
pub trait SampledController {
    /// Computes the desired twist and the hybrid state for the next tick.
    fn compute<S: Scalar>(&self, seen: &NavigationVariables<S>, before: HybridState<S>) -> ControlOutput<S>;
    /// Applies the limits to the desired twist.
    fn limit<S: Scalar>(&self, desired: Twist<S>) -> Twist<S>;
}

/// The control law and the limits that run on the robot.
///
/// # Assumption
/// The wheels follow immediately: the acceleration limit is not part of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeployedController {
    /// Control law.
    pub law: Law<f64>,
    /// Wheel separation and wheel radii.
    pub drive: DiffDrive<f64>,
    /// Speed profile for braking ahead of the goal. `None`: no such profile.
    pub braking: Option<BrakingProfile<f64>>,
    /// Wheel limits.
    pub limits: Limits<f64>,
}

impl SampledController for DeployedController {
    #[inline]
    fn compute<S: Scalar>(&self, seen: &NavigationVariables<S>, before: HybridState<S>) -> ControlOutput<S> {
        let braking = self.braking.map(|braking| braking.cast());
        self.law.cast::<S>().compute_with_braking(braking.as_ref(), seen, before)
    }
    #[inline]
    fn limit<S: Scalar>(&self, desired: Twist<S>) -> Twist<S> {
        self.limits.cast().limit_speed(&self.drive.cast(), desired)
    }
}
