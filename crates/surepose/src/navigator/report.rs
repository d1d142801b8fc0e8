//! What a step reports.

use crate::control::ControlStep;
use crate::estimation::Belief;
use crate::kinematics::{Twist, WheelPair};
use crate::safety::{BlockReason, Health, SafetyAction};
use crate::scalar::Float;
use crate::time::Stamp;

use super::GoalResult;

/// How the robot is to move until the next step.
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
    /// When.
    pub stamp: Stamp,
    /// The estimate; meaningless while `health` is [`Health::Lost`].
    pub belief: Belief<S>,
    /// How far the estimate can be trusted.
    pub health: Health,
    /// What the supervisor lets the wheels do.
    pub action: SafetyAction,
    /// How the robot is to move; `None` where no goal is active and the wheels are free for another controller.
    pub command: Option<Command<S>>,
    /// The controller's view; `None` without a goal.
    pub control: Option<ControlStep<S>>,
    /// What blocks the way; `None` where nothing does.
    pub blocked_by: Option<BlockReason>,
    /// How the goal ended, in the step in which it did.
    pub result: Option<GoalResult>,
}

impl<S: Float> StepReport<S> {
    /// Report of an estimate without a goal.
    pub(super) fn new(stamp: Stamp, belief: Belief<S>, health: Health, action: SafetyAction) -> Self {
        Self { stamp, belief, health, action, command: None, control: None, blocked_by: None, result: None }
    }
}
