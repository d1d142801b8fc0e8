//! What the certificate judges: one control step, evaluated with any scalar.

use surepose::{Braking, Decision, Drive, Law, Limits, Memory, Navigation, Scalar, Twist};

/// A control step: from the goal as seen to the twist that the wheels are told to drive.
///
/// The certificate knows the law only through this, so that a wrong law can be given to it as well as the right one.
pub trait Subject {
    /// What the law wants, and the memory for the next tick.
    fn decide<S: Scalar>(&self, seen: &Navigation<S>, before: Memory<S>) -> Decision<S>;
    /// What of it the limits grant.
    fn grant<S: Scalar>(&self, wanted: Twist<S>) -> Twist<S>;
}

/// The law and the limits that run on the robot.
///
/// # Assumption
/// The wheels follow at once: the acceleration limit is not part of what is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shipped {
    /// The control law.
    pub law: Law<f64>,
    /// The wheels' geometry.
    pub drive: Drive<f64>,
    /// How it slows down in time.
    pub braking: Option<Braking<f64>>,
    /// The wheels' limits.
    pub limits: Limits<f64>,
}

impl Subject for Shipped {
    #[inline]
    fn decide<S: Scalar>(&self, seen: &Navigation<S>, before: Memory<S>) -> Decision<S> {
        let braking = self.braking.map(|braking| braking.cast());
        self.law.cast::<S>().decide_in_time(braking.as_ref(), seen, before)
    }
    #[inline]
    fn grant<S: Scalar>(&self, wanted: Twist<S>) -> Twist<S> {
        self.limits.cast().within_speed(&self.drive.cast(), wanted)
    }
}
