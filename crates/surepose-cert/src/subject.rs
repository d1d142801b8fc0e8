//! What the certificate judges: one control step, evaluated with any scalar.

use surepose::{
    Actuation, Decision, Drive, Gains, HybridLaw, Law, Limits, Memory, Navigation, PaperLaw, Scalar, Twist,
};

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
    /// The wheels' limits.
    pub limits: Limits<f64>,
}

impl Subject for Shipped {
    #[inline]
    fn decide<S: Scalar>(&self, seen: &Navigation<S>, before: Memory<S>) -> Decision<S> {
        law_over::<S>(&self.law).decide(seen, before)
    }
    #[inline]
    fn grant<S: Scalar>(&self, wanted: Twist<S>) -> Twist<S> {
        limits_over(&self.limits).within_speed(&drive_over(&self.drive), wanted)
    }
}

/// The drive with its constants as another scalar.
#[inline]
pub(crate) fn drive_over<S: Scalar>(drive: &Drive<f64>) -> Drive<S> {
    drive.cast()
}

#[inline]
fn limits_over<S: Scalar>(limits: &Limits<f64>) -> Limits<S> {
    Limits { wheel_speed: S::of(limits.wheel_speed), wheel_acceleration: S::of(limits.wheel_acceleration) }
}

#[inline]
fn gains_over<S: Scalar>(gains: &Gains<f64>) -> Gains<S> {
    Gains {
        k_v: S::of(gains.k_v),
        k_alpha: S::of(gains.k_alpha),
        h: S::of(gains.h),
        k_theta: S::of(gains.k_theta),
    }
}

#[inline]
fn law_over<S: Scalar>(law: &Law<f64>) -> Law<S> {
    match law {
        Law::Hybrid(law) => Law::Hybrid(HybridLaw {
            gains: gains_over(&law.gains),
            capture_radius: S::of(law.capture_radius),
            direction: law.direction,
            actuation: Actuation {
                speed: S::of(law.actuation.speed),
                turn_rate: S::of(law.actuation.turn_rate),
                quiet_alpha: S::of(law.actuation.quiet_alpha),
                quiet_theta: S::of(law.actuation.quiet_theta),
            },
        }),
        Law::Paper(law) => Law::Paper(PaperLaw {
            gains: gains_over(&law.gains),
            capture_radius: S::of(law.capture_radius),
            capture_heading: S::of(law.capture_heading),
        }),
    }
}
