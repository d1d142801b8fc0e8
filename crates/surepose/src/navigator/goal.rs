//! The active goal: what the controller remembers of it, what holds the robot up, and how it ends.

use crate::control::{ControlStep, ControllerState, GoalStatus};
use crate::estimation::DisagreeingSensor;
use crate::geometry::{Goal, Map, Pose};
use crate::kinematics::Twist;
use crate::safety::{BlockReason, FaultReason, LyapunovValue, MotionFault, ProgressMonitor, SafetyAction};
use crate::scalar::Float;

use super::{AbortReason, GoalResult, NavigatorConfig, StepReport};

/// Rate at which unimpeded time makes up for impeded time.
const RECOVERY_RATE: f64 = 0.5;
/// Longest time that a step counts \[s].
const MAX_ELAPSED: f64 = 1.0;

/// The goal that the robot drives to, or holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ActiveGoal<S: Float> {
    pub(super) map_from_goal: Pose<Map, Goal, S>,
    pub(super) state: ControllerState<S>,
    /// Reason for which the robot stands, and for how long \[s]. Two reasons that alternate share one time.
    impediment: Option<AbortReason>,
    impeded_for: S,
    progress: ProgressMonitor<S>,
    /// Sensor that disagreed with the others on the way, and the time since \[s]. The pose at which the robot arrives is then
    /// not known to the tolerance.
    disputed_by: Option<DisagreeingSensor>,
    disputed_for: S,
    /// A wall stopped the robot: it brakes, and the goal is over.
    is_stopped_by_wall: bool,
    has_arrived: bool,
}

impl<S: Float> ActiveGoal<S> {
    pub(super) fn new(map_from_goal: Pose<Map, Goal, S>) -> Self {
        Self {
            map_from_goal,
            state: ControllerState::new(),
            impediment: None,
            impeded_for: S::from_f64(0.0),
            progress: ProgressMonitor::new(),
            disputed_by: None,
            disputed_for: S::from_f64(0.0),
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

    /// Takes in the outcome of a step: what stops the robot, or how far it is.
    pub(super) fn note(
        &mut self,
        config: &NavigatorConfig<S>,
        report: &StepReport<S>,
        step: &ControlStep<S>,
        blocked: Option<BlockReason>,
        elapsed: S,
    ) {
        // A jump of the clock is no time in which something happened.
        let elapsed = elapsed.min(S::from_f64(MAX_ELAPSED));
        let impediment = match report.action {
            SafetyAction::Stop(reason) => Some(AbortReason::Fault(reason)),
            _ => blocked.map(AbortReason::Blocked),
        };
        if self.disputed_by.is_some() {
            self.disputed_for = self.disputed_for + elapsed;
        }
        self.disputed_by = self.disputed_by.or(report.disagreement);
        self.is_stopped_by_wall |= blocked == Some(BlockReason::Wall);
        if impediment.is_some() {
            self.impeded_for = self.impeded_for + elapsed;
            self.impediment = impediment;
        } else {
            let recovered = elapsed * S::from_f64(RECOVERY_RATE);
            self.impeded_for = (self.impeded_for - recovered).max(S::from_f64(0.0));
            self.note_progress(config, report, step, elapsed);
        }
        if report.action == SafetyAction::Stop(FaultReason::Lost) {
            self.progress.restart_from_new_pose();
        }
    }

    /// The result, once the goal is over: after `limited` was commanded, with the `motion` fault of the base.
    pub(super) fn result(
        &mut self,
        config: &NavigatorConfig<S>,
        limited: Twist<S>,
        motion: Option<MotionFault>,
    ) -> Option<GoalResult> {
        let rests = limited == Twist::zero();
        let status = self.state.goal_checker.status(&config.controller.tolerance);
        let is_there = status == GoalStatus::Reached && rests && self.disputed_by.is_none();
        let arrives = is_there && !self.has_arrived;
        self.has_arrived |= is_there;
        // A base that stalls within the tolerance has arrived.
        let motion = motion.filter(|_| status == GoalStatus::Approaching);
        let aborted = self.abort_reason(config, rests, motion).map(GoalResult::Aborted);
        aborted.or_else(|| arrives.then_some(GoalResult::Reached))
    }

    /// Measures progress; slower where the supervisor slows the robot down.
    fn note_progress(
        &mut self,
        config: &NavigatorConfig<S>,
        report: &StepReport<S>,
        step: &ControlStep<S>,
        elapsed: S,
    ) {
        let (controller, hybrid) = (&config.controller, &step.state.hybrid);
        let value = controller.law.lyapunov_by_mode(&step.navigation, hybrid);
        let value = LyapunovValue { value, is_local: hybrid.local_mode };
        let status = step.state.goal_checker.status(&controller.tolerance);
        self.progress.update(status, value, elapsed * report.action.speed_scale());
    }

    fn abort_reason(
        &self,
        config: &NavigatorConfig<S>,
        rests: bool,
        motion: Option<MotionFault>,
    ) -> Option<AbortReason> {
        if self.is_stopped_by_wall && rests {
            return Some(AbortReason::Blocked(BlockReason::Wall));
        }
        let timeout = S::from_f64(config.goal_timeout);
        if let Some(sensor) = self.disputed_by.filter(|_| self.disputed_for >= timeout) {
            return Some(AbortReason::Disagreement(sensor));
        }
        if self.impeded_for >= timeout {
            return self.impediment;
        }
        if let Some(fault) = motion {
            return Some(AbortReason::Motion(fault));
        }
        (self.progress.stagnant_for() >= config.progress_timeout).then_some(AbortReason::NoProgress)
    }
}
