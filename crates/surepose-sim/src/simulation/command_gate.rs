//! What the supervisor, and walls ahead, leave of what the controller wants.

use crate::Arena;
use surepose::closed_loop::{ControlStep, Controller, ControllerState};
use surepose::{Body, FaultReason, Map, Pose, SafetyAction, Twist};

use super::collision::is_blocked;
use crate::robot::SEARCH_RATE;

/// A drive that the supervisor has stopped for so long \[s] is over.
pub const GOAL_TIMEOUT: f64 = 10.0;

/// How long the supervisor has held the robot, and why.
#[derive(Clone, Copy, Debug, Default)]
pub struct CommandGate {
    held: Option<(FaultReason, f64)>,
    /// A wall stood in the way: the drive brakes and is over.
    stopped_for_wall: bool,
}

impl CommandGate {
    /// `step`, as far as `action` allows it at time `now` \[s], after the wheels were told `last`.
    ///
    /// Wheels slow down and stop as hard as they can, and no harder. A robot that is lost turns in place if it `can_search`: what it sees may tell it where it is.
    pub fn apply(
        &mut self,
        action: SafetyAction,
        controller: &Controller<f64>,
        step: ControlStep<f64>,
        last: Twist<f64>,
        now: f64,
        can_search: bool,
    ) -> ControlStep<f64> {
        self.held = match (action, self.held) {
            (SafetyAction::Stop(reason), Some((_, since))) => Some((reason, since)),
            (SafetyAction::Stop(reason), None) => Some((reason, now)),
            _ => None,
        };
        let allowed = match action {
            SafetyAction::Proceed => return step,
            SafetyAction::Stop(FaultReason::Lost) if can_search => Twist::new(0.0, SEARCH_RATE),
            _ => step.limited.scaled(action.speed_scale()),
        };
        // What the law remembers of a goal seen from a wrong place is worth nothing.
        let remembered = if self.held.is_some() { ControllerState::new() } else { step.state };
        limit_command(allowed, controller, ControlStep { state: remembered, ..step }, last)
    }

    /// `step`, unless a robot at `pose` would come too near to a wall: then it brakes, for good.
    pub fn stop_for_walls(
        &mut self,
        arena: &Arena,
        pose: Pose<Map, Body, f64>,
        controller: &Controller<f64>,
        step: ControlStep<f64>,
        last: Twist<f64>,
    ) -> ControlStep<f64> {
        self.stopped_for_wall |= is_blocked(arena, pose, step.limited, controller);
        if self.stopped_for_wall { limit_command(Twist::zero(), controller, step, last) } else { step }
    }

    /// Whether the robot brakes, or has braked, before a wall.
    pub fn is_stopped_for_wall(&self) -> bool {
        self.stopped_for_wall
    }

    /// Why the drive is over, where it is.
    pub fn timed_out(&self, now: f64) -> Option<FaultReason> {
        self.held.filter(|(_, since)| now - since >= GOAL_TIMEOUT).map(|(reason, _)| reason)
    }
}

/// `step` with what the wheels can do of `desired`, having done `last`.
pub fn limit_command(
    desired: Twist<f64>,
    controller: &Controller<f64>,
    step: ControlStep<f64>,
    last: Twist<f64>,
) -> ControlStep<f64> {
    let limited = controller.limits.limit(&controller.drive, desired, last, controller.period);
    let wheels = controller.drive.wheel_rates_from_twist(limited);
    ControlStep { limited, wheels, state: ControllerState { limited, ..step.state }, ..step }
}
