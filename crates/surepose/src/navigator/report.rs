//! Report of a step.

use crate::control::ControlStep;
use crate::estimation::{Belief, DisagreeingSensor};
use crate::kinematics::{Twist, WheelPair};
use crate::safety::{BlockReason, Health, SafetyAction};
use crate::scalar::Float;
use crate::time::Stamp;

use super::GoalResult;

/// Command for the period until the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<S> {
    /// Speed and turn rate.
    pub twist: Twist<S>,
    /// The wheels' turn rates \[rad/s] that give this twist.
    pub wheels: WheelPair<S>,
}

/// Outcome of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport<S: Float> {
    /// Time of the step.
    pub stamp: Stamp,
    /// The estimate; meaningless while `health` is [`Health::Lost`].
    pub belief: Belief<S>,
    /// Quality of the estimate.
    pub health: Health,
    /// Action of the supervisor.
    pub action: SafetyAction,
    /// Sensor that disagrees with the others beyond noise and considered errors; `None` where all agree.
    pub disagreement: Option<DisagreeingSensor>,
    /// Command; `None` where no goal is active and the wheels are free for another controller.
    pub command: Option<Command<S>>,
    /// The controller's view; `None` without a goal.
    pub control: Option<ControlStep<S>>,
    /// Reason of a stop for a wall, an obstacle or the laser; `None` if the path is free.
    pub blocked_by: Option<BlockReason>,
    /// Result of the goal, in the step in which it ended; `None` in all others.
    pub result: Option<GoalResult>,
}

impl<S: Float> StepReport<S> {
    /// Report of an estimate without a goal.
    pub(super) fn new(stamp: Stamp, belief: Belief<S>, health: Health, action: SafetyAction) -> Self {
        Self {
            stamp,
            belief,
            health,
            action,
            disagreement: None,
            command: None,
            control: None,
            blocked_by: None,
            result: None,
        }
    }
}
