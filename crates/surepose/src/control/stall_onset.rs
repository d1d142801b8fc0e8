//! Speeds that a base must execute so that the law, as it is, brings it to rest at the goal.

use crate::scalar::Scalar;

use super::controller::Controller;
use super::law::Law;
use super::tuning::ENTER_RADIUS;

/// Rim speeds \[m/s] above which a base that ignores slower commands stalls before the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StallOnset<S> {
    /// On the way: the command where the local law takes over, 0.23·ε_P·k_v with the braking part.
    pub drive: S,
    /// While the heading is trimmed: the command at the heading tolerance, tol_θ·(L/2)·min(k_θ, 0.12/T).
    pub turn: S,
}

impl<S: Scalar> Controller<S> {
    /// Onset of a stall; `None` for a law without the hybrid law's modes.
    ///
    /// A base with minimum speeds above it needs the pulses of [`ActuatorModel`](super::ActuatorModel).
    pub fn stall_onset(&self) -> Option<StallOnset<S>> {
        let Law::Hybrid(law) = &self.law else { return None };
        let entry = law.capture_radius * S::from_f64(ENTER_RADIUS);
        let braking = self
            .braking
            .as_ref()
            .map_or(S::from_f64(1.0), |braking| braking.linear_gain_factor(law.gains.k_v, entry));
        let trimming = law.gains.k_theta.min(law.actuator_limits.small_error_gain_theta);
        let half_separation = self.drive.wheel_separation * S::from_f64(0.5);
        Some(StallOnset {
            drive: entry * law.gains.k_v * braking,
            turn: self.tolerance.heading * half_separation * trimming,
        })
    }
}
