//! The active goal: what the controller remembers of it, what holds the robot up, and how it ends.

use crate::control::{ControllerState, GoalStatus};
use crate::geometry::{Goal, Map, Pose};
use crate::kinematics::Twist;
use crate::safety::{BlockReason, FaultReason, SafetyAction};
use crate::scalar::Float;
use crate::time::Stamp;

use super::NavigatorConfig;

/// How a goal ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GoalResult {
    /// The robot rests within the tolerance of the goal, according to its estimate.
    Reached,
    /// The goal was canceled.
    Canceled,
    /// Another goal replaced it.
    Preempted,
    /// The robot could not go on.
    Aborted(AbortReason),
}

/// Why a goal was aborted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AbortReason {
    /// The supervisor stopped the robot for the goal time-out.
    Fault(FaultReason),
    /// A wall, an obstacle or a missing laser blocked the robot.
    Blocked(BlockReason),
    /// The stamps of odometry went back by more than a second.
    ClockSetBack,
}

impl AbortReason {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fault(reason) => reason.name(),
            Self::Blocked(reason) => reason.name(),
            Self::ClockSetBack => "clock_set_back",
        }
    }
}

/// A goal that was not accepted: the footprint at the goal is closer to a wall than the required clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoRoomAtGoal<S> {
    /// Distance from the footprint to the nearest wall \[m]; 0 in contact.
    pub clearance: S,
    /// Required distance \[m].
    pub required: S,
}

/// The goal that the robot drives to, or holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ActiveGoal<S: Float> {
    pub(super) map_from_goal: Pose<Map, Goal, S>,
    pub(super) state: ControllerState<S>,
    /// What stops the robot, and since when.
    fault: Option<(FaultReason, Stamp)>,
    blocked: Option<(BlockReason, Stamp)>,
    /// A wall stopped the robot: it brakes, and the goal is over.
    is_stopped_by_wall: bool,
    has_arrived: bool,
}

impl<S: Float> ActiveGoal<S> {
    pub(super) fn new(map_from_goal: Pose<Map, Goal, S>) -> Self {
        Self {
            map_from_goal,
            state: ControllerState::new(),
            fault: None,
            blocked: None,
            is_stopped_by_wall: false,
            has_arrived: false,
        }
    }

    /// Forgets what the controller remembers, for an estimate that was replaced.
    pub(super) fn reset_controller(&mut self) {
        *self = Self { has_arrived: self.has_arrived, ..Self::new(self.map_from_goal) };
    }

    /// Whether the robot was at the goal before.
    pub(super) fn has_arrived(&self) -> bool {
        self.has_arrived
    }

    /// Whether a wall stopped the robot for good.
    pub(super) fn is_stopped_by_wall(&self) -> bool {
        self.is_stopped_by_wall
    }

    /// Takes in what stops the robot at `now`.
    pub(super) fn note(&mut self, now: Stamp, action: SafetyAction, blocked: Option<BlockReason>) {
        let fault = match action {
            SafetyAction::Stop(reason) => Some(reason),
            _ => None,
        };
        self.fault = fault.map(|reason| (reason, self.fault.map_or(now, |(_, since)| since)));
        self.blocked = blocked.map(|reason| (reason, self.blocked.map_or(now, |(_, since)| since)));
        self.is_stopped_by_wall |= blocked == Some(BlockReason::Wall);
    }

    /// The result, once the goal is over: after `limited` was commanded at `now`.
    pub(super) fn result(
        &mut self,
        config: &NavigatorConfig<S>,
        limited: Twist<S>,
        now: Stamp,
    ) -> Option<GoalResult> {
        let is_over = |since: Stamp| now.since(since) >= config.goal_timeout;
        if let Some((reason, _)) = self.fault.filter(|(_, since)| is_over(*since)) {
            return Some(GoalResult::Aborted(AbortReason::Fault(reason)));
        }
        if let Some((reason, _)) = self.blocked.filter(|(_, since)| is_over(*since)) {
            return Some(GoalResult::Aborted(AbortReason::Blocked(reason)));
        }
        let rests = limited == Twist::zero();
        if self.is_stopped_by_wall && rests {
            return Some(GoalResult::Aborted(AbortReason::Blocked(BlockReason::Wall)));
        }
        let status = self.state.goal_checker.status(&config.controller.tolerance);
        let is_there = status == GoalStatus::Reached && rests;
        let arrives = is_there && !self.has_arrived;
        self.has_arrived |= is_there;
        arrives.then_some(GoalResult::Reached)
    }
}
