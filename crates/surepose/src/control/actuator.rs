//! Actuator stage between a command and the motion of the base.
//!
//! Before control it predicts the pose at which the next command takes effect. After the limits it turns speeds that the base
//! would ignore into pulses that it executes.

mod pending_commands;
mod speed_modulator;

use crate::geometry::{Body, Map, Pose};
use crate::kinematics::{DiffDrive, Integration, Twist};
use crate::scalar::Float;

use super::limits::Limits;

pub use pending_commands::MAX_PENDING;
pub use speed_modulator::{MinSpeeds, PulseTicks};

use pending_commands::PendingCommands;
use speed_modulator::SpeedModulator;

/// Minimum speeds, dead time and lag of a base.
///
/// # Departure
/// [Tran2012] has wheels that execute every speed at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorModel<S> {
    /// Minimum speeds that the base executes.
    pub min_speeds: MinSpeeds<S>,
    /// Dead time between a command and its effect \[s].
    pub delay: S,
    /// Time constant τ of the response \[s]: `u′ = (command − u)/τ`. 0 for a base that follows at once.
    pub time_constant: S,
}

impl<S: Float> ActuatorModel<S> {
    /// A base that executes every command at once.
    pub fn ideal() -> Self {
        let zero = S::from_f64(0.0);
        Self { min_speeds: MinSpeeds::none(), delay: zero, time_constant: zero }
    }
}

/// State of the actuator stage: commands that have not taken effect, the speed of the base, and the motion still owed.
///
/// ```
/// use surepose::control::{ActuatorModel, ActuatorState, Limits, MinSpeeds};
/// use surepose::kinematics::{DiffDrive, Twist};
///
/// // A base that ignores |v| < 2 cm/s is asked for 0.5 cm/s: about every fourth period it gets 2 cm/s.
/// let min_speeds = MinSpeeds { v: 0.02, ..MinSpeeds::none() };
/// let model = ActuatorModel { min_speeds, ..ActuatorModel::ideal() };
/// let (drive, limits, period) = (DiffDrive::new(0.05, 0.4), Limits::symmetric(0.5, 1.0), 0.1);
/// let mut state = ActuatorState::new();
/// let asked = Twist::new(0.005, 0.0);
/// let distance: f64 = (0..40).map(|_| state.execute(&model, &drive, &limits, asked, period).v * period).sum();
/// assert!((distance - 0.02).abs() <= 1.02 * 0.02 * period / 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorState<S> {
    pending: PendingCommands<S>,
    modulator: SpeedModulator<S>,
}

impl<S: Float> ActuatorState<S> {
    /// Base at rest, nothing pending.
    pub fn new() -> Self {
        Self { pending: PendingCommands::new(), modulator: SpeedModulator::new() }
    }

    /// The pose at which a command that is sent now takes effect, as far as the commands that are under way determine it.
    ///
    /// A base with lag coasts by `u·τ` after its last command. That distance is part of the prediction, so that the predicted
    /// pose moves with the delayed command itself: for x′ = u and u′ = (c − u)/τ, the sum y = x + τ·u has y′ = c.
    pub fn predict(&self, model: &ActuatorModel<S>, map_from_body: Pose<Map, Body, S>) -> Pose<Map, Body, S> {
        let coasting = self.pending.speed().integrate_for(model.time_constant);
        let coasted = if coasting.length == S::from_f64(0.0) && coasting.turn == S::from_f64(0.0) {
            map_from_body
        } else {
            map_from_body.integrate(coasting, Integration::Arc)
        };
        self.pending.apply(model.delay, coasted)
    }

    /// The command for the next `period` \[s] whose motion over time is that of `limited`; zero for zero.
    pub fn execute(
        &mut self,
        model: &ActuatorModel<S>,
        drive: &DiffDrive<S>,
        limits: &Limits<S>,
        limited: Twist<S>,
        period: S,
    ) -> Twist<S> {
        let command = self.modulator.modulate(&model.min_speeds, drive, limits, limited, period);
        if model.delay > S::from_f64(0.0) || model.time_constant > S::from_f64(0.0) {
            self.pending.push(model.delay, model.time_constant, command, period);
        }
        command
    }

    /// The twist that the base is expected to have now, after dead time and lag, for the newest `command`.
    pub fn expected_speed(&self, model: &ActuatorModel<S>, command: Twist<S>) -> Twist<S> {
        let is_immediate = model.delay <= S::from_f64(0.0) && model.time_constant <= S::from_f64(0.0);
        if is_immediate { command } else { self.pending.speed() }
    }

    /// Forgets what is pending and owed, for wheels that belonged to another controller.
    pub fn reset(&mut self) {
        *self = Self::new();
    }
}

impl<S: Float> Default for ActuatorState<S> {
    fn default() -> Self {
        Self::new()
    }
}
