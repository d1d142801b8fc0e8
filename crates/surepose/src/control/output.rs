//! Intermediate and final results of a control law: [`ActiveMode`] and [`ControlOutput`].

use crate::kinematics::Twist;
use crate::scalar::Scalar;

use super::hysteresis::HybridState;

/// Desired twist of a law and its state for the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlOutput<S: Scalar> {
    /// Desired twist, before limits.
    pub twist: Twist<S>,
    /// State to pass to the next tick.
    pub state: HybridState<S>,
}

/// Active law of one tick and the angle error that it controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveMode<S: Scalar> {
    /// Remaining rotation \[rad]: α in the global law, −θ_e in the local law. The hybrid law unwraps it beyond ±π.
    pub error: S,
    /// Updated state, for example `local_mode` and `trim_ticks`. Only `drive_direction` is still that of the last tick.
    pub state: HybridState<S>,
}
