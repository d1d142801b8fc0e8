//! What the certificate judges: one control step, evaluated with any scalar.

use surepose::control::{BrakingProfile, ControlOutput, HybridState, Law, Limits, NavigationVariables};
use surepose::kinematics::{DiffDrive, Twist};
use surepose::scalar::Scalar;

/// A control step: from the goal as seen to the twist that the wheels are told to drive.
///
/// The certificate knows the law only through this, so that a wrong law can be given to it as well as the right one.
pub trait SampledController {
    /// What the law wants, and the memory for the next tick.
    fn compute<S: Scalar>(&self, seen: &NavigationVariables<S>, before: HybridState<S>) -> ControlOutput<S>;
    /// What of it the limits grant.
    fn limit<S: Scalar>(&self, desired: Twist<S>) -> Twist<S>;
}

/// The law and the limits that run on the robot.
///
/// # Assumption
/// The wheels follow at once: the acceleration limit is not part of what is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeployedController {
    /// The control law.
    pub law: Law<f64>,
    /// The wheels' geometry.
    pub drive: DiffDrive<f64>,
    /// How it slows down in time.
    pub braking: Option<BrakingProfile<f64>>,
    /// The wheels' limits.
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
