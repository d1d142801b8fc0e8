//! One goal on its way: the closed loop, what the supervisor leaves of it, and how it ends.

use surepose::closed_loop::Controller;
use surepose::closed_loop::{ControllerState, SensorInput, Tick, tick};
use surepose::{Goal, GoalStatus, Map, NavigationVariables, Pose, Stamp, Twist, Wall};
use surepose_sim::robot::{LocalizationMonitor, SimLocalizer};
use surepose_sim::simulation::{CommandGate, limit_command};

use super::environment::Environment;

pub(super) use surepose_sim::simulation::GOAL_TIMEOUT;

/// How a goal ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalResult {
    /// The robot rests at the goal, as far as it knows.
    Reached,
    /// Somebody gave it up.
    Cancelled,
    /// Another goal took its place.
    Preempted,
    /// The robot was stopped, for this reason.
    Stopped(&'static str),
}

/// Why a robot waits that knows where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockReason {
    /// Something that is on no map stands in its way.
    Obstacle,
    /// It is to look out for what stands in its way, and its laser says nothing.
    LaserSilent,
}

impl BlockReason {
    /// The name used in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Obstacle => "obstacle",
            Self::LaserSilent => "laser_silent",
        }
    }
}

/// A goal, and how far the robot is with it.
#[derive(Clone, Debug)]
pub(super) struct ActiveGoal {
    goal: Pose<Map, Goal, f64>,
    state: ControllerState<f64>,
    command_gate: CommandGate,
    /// Since when it may not go on \[s], and why.
    blocked: Option<(f64, BlockReason)>,
    has_arrived: bool,
}

/// What one tick of a goal says.
#[derive(Clone, Copy, Debug)]
pub(super) struct GoalStep {
    pub(super) command: Twist<f64>,
    /// The goal as it was seen.
    pub(super) navigation: NavigationVariables<f64>,
    /// Said once.
    pub(super) ended: Option<GoalResult>,
}

impl ActiveGoal {
    /// To `goal`, with wheels that were told `last`.
    pub(super) fn new(goal: Pose<Map, Goal, f64>, last: Twist<f64>) -> Self {
        let state = ControllerState { limited: last, ..ControllerState::new() };
        Self { goal, state, command_gate: CommandGate::default(), blocked: None, has_arrived: false }
    }

    /// What the wheels were told last.
    pub(super) fn limited(&self) -> Twist<f64> {
        self.state.limited
    }

    /// The goal.
    pub(super) fn goal(&self) -> Pose<Map, Goal, f64> {
        self.goal
    }

    /// What it waits for, if it does.
    pub(super) fn block_reason(&self) -> Option<BlockReason> {
        self.blocked.map(|(_, block_reason)| block_reason)
    }

    /// Whether it was at the goal already.
    pub(super) fn has_arrived(&self) -> bool {
        self.has_arrived
    }

    /// The pose was set anew: what is remembered of how the goal was seen is worth nothing.
    pub(super) fn reset(&mut self) {
        *self = Self { has_arrived: self.has_arrived, ..Self::new(self.goal, self.limited()) };
    }

    /// The wheels were told to rest meanwhile.
    pub(super) fn stop(&mut self) {
        *self = Self { has_arrived: self.has_arrived, ..Self::new(self.goal, Twist::zero()) };
    }

    /// One tick of the closed loop: where the robot is, and what the law and the limits would do.
    pub(super) fn tick(
        &self,
        controller: &Controller<f64>,
        localizer: &mut SimLocalizer,
        walls: &[Wall<f64>],
        sensed: &SensorInput<'_, f64>,
        monitor: &mut LocalizationMonitor,
    ) -> Tick<f64> {
        tick(controller, localizer, walls, self.state, sensed, self.goal, monitor)
    }

    /// What is done of that at `stamp`: what the supervisor lets pass, and what stands around.
    pub(super) fn command(
        &mut self,
        ticked: &Tick<f64>,
        stamp: Stamp,
        controller: &Controller<f64>,
        environment: &Environment,
        monitor: &LocalizationMonitor,
    ) -> GoalStep {
        let Environment { arena, obstacle_monitor, .. } = environment;
        let Tick { belief, step, .. } = *ticked;
        let (last, now) = (self.state.limited, stamp.seconds());
        let action = monitor.action(stamp, &belief);
        let mut step = self.command_gate.apply(action, controller, step, last, now, arena.is_some());
        if let Some(arena) = arena {
            step = self.command_gate.stop_for_walls(arena, belief.pose, controller, step, last);
        }
        let block_reason = if arena.is_some() && obstacle_monitor.is_blind(stamp) {
            Some(BlockReason::LaserSilent)
        } else {
            let is_blocked = obstacle_monitor.is_blocked(belief.pose, step.limited, controller);
            is_blocked.then_some(BlockReason::Obstacle)
        };
        if block_reason.is_some() {
            step = limit_command(Twist::zero(), controller, step, last);
        }
        let since = self.blocked.map_or(now, |(since, _)| since);
        self.blocked = block_reason.map(|block_reason| (since, block_reason));
        self.state = step.state;
        GoalStep { command: step.limited, navigation: step.navigation, ended: self.ended(controller, now) }
    }

    fn ended(&mut self, controller: &Controller<f64>, now: f64) -> Option<GoalResult> {
        if let Some(reason) = self.command_gate.timed_out(now) {
            return Some(GoalResult::Stopped(reason.name()));
        }
        if let Some((since, block_reason)) = self.blocked
            && now - since >= GOAL_TIMEOUT
        {
            return Some(GoalResult::Stopped(block_reason.name()));
        }
        let rests = self.state.limited == Twist::zero();
        if self.command_gate.is_stopped_for_wall() && rests {
            return Some(GoalResult::Stopped("wall"));
        }
        let is_there = self.state.goal_checker.status(&controller.tolerance) == GoalStatus::Reached && rests;
        let arrives = is_there && !self.has_arrived;
        self.has_arrived |= is_there;
        arrives.then_some(GoalResult::Reached)
    }
}
