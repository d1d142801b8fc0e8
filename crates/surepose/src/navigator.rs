//! The navigator: from sensor input to wheel commands, in one step.
//!
//! [`Navigator::step`] is the whole pipeline: estimate → supervise → control → collision check → limits → command. The
//! simulator, the ROS 2 node, a replayed recording and the firmware call this one function.
//!
//! A step reads no clock, allocates nothing and cannot fail. Its work is bounded: one filter step for odometry, at most
//! `HISTORY` + 2 for each measurement and each wall in a scan, one pass over each scan, one step of the global search for
//! each scan while the robot is lost, and one collision check while it has a goal.

mod config;
mod goal;
mod laser;
mod observers;
mod odometry;
mod report;
mod result;
mod sent_commands;

use goal::ActiveGoal;
use observers::Observers;
use sent_commands::SentCommands;

use crate::control::ControllerState;
use crate::estimation::Belief;
use crate::geometry::{Body, Goal, Map, Pose};
use crate::kinematics::Twist;
use crate::localization::{Localizer, LoopObserver, SensorInput};
use crate::map::MapView;
use crate::safety::{FaultReason, Health, Intent, ObstacleMonitor, SafetyAction, SpeedCap};
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

pub use config::NavigatorConfig;
pub use report::{Command, StepReport};
pub use result::{AbortReason, GoalResult, NoRoomAtGoal};

/// A stamp that is earlier than the previous one by more than this \[s] comes from a clock that was set back.
pub const CLOCK_SET_BACK_THRESHOLD: f64 = 1.0;

/// Duration of the zero command after the wheels have stopped \[s].
const REST_TIME: f64 = 0.5;

/// Navigation of one robot: estimate, supervisor, controller, collision check and limits.
///
/// | capacity | meaning |
/// |---|---|
/// | `HISTORY` | events that the filter can rewind over |
/// | `BEAMS` | beams of a scan; 0 for a robot without a laser |
/// | `HYPOTHESES`, `KEYFRAMES` | poses and scans that the global search keeps |
#[derive(Clone, Debug)]
///
/// The documentation of the [crate] starts with a program that parks a robot by it.
pub struct Navigator<
    S: Float,
    const HISTORY: usize,
    const BEAMS: usize,
    const HYPOTHESES: usize = 24,
    const KEYFRAMES: usize = 24,
> {
    config: NavigatorConfig<S>,
    localizer: Localizer<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES>,
    obstacles: ObstacleMonitor<S, BEAMS>,
    goal: Option<ActiveGoal<S>>,
    /// Result of a goal that ended outside a step, until the next report.
    result: Option<GoalResult>,
    commands: SentCommands<S>,
    /// Until when rest is commanded after a goal; `None` where the wheels are free.
    rest_until: Option<Stamp>,
}

impl<S: Float, const HISTORY: usize, const BEAMS: usize, const HYPOTHESES: usize, const KEYFRAMES: usize>
    Navigator<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES>
{
    /// Navigator without a goal, whose localizer holds the initial belief.
    pub fn new(
        config: NavigatorConfig<S>,
        localizer: Localizer<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES>,
    ) -> Self {
        Self {
            config,
            localizer,
            obstacles: ObstacleMonitor::new(config.obstacles),
            goal: None,
            result: None,
            commands: SentCommands::new(),
            rest_until: None,
        }
    }

    /// Advances the estimate to `input.stamp` and computes the command for the next period.
    pub fn step(&mut self, map: &MapView<'_, S>, input: &SensorInput<'_, S>) -> StepReport<S> {
        self.step_observed(map, input, &mut ())
    }

    /// Runs [`Navigator::step`] with an observer that receives every input and its outcome.
    pub fn step_observed(
        &mut self,
        map: &MapView<'_, S>,
        input: &SensorInput<'_, S>,
        observer: &mut impl LoopObserver<S>,
    ) -> StepReport<S> {
        let elapsed = self.advance_clock(input.stamp);

        // Estimate: odometry predicts; gated measurements and scans correct.
        let belief = self.estimate(map, input, elapsed, observer);

        // Supervise: assess the estimate.
        let (health, action) = self.localizer.judge();
        let mut report = StepReport::new(input.stamp, belief, health, action);
        report.disagreement = self.localizer.disagreement();

        // How should it move, and how fast may it?
        let ended = if let Some(goal) = self.goal {
            self.drive(goal, map, elapsed, &mut report)
        } else {
            report.command = self.brake(input.stamp);
            None
        };
        report.result = self.result.take().or(ended);
        report
    }

    /// Sets a goal, and returns the result of the previous goal; `None` if there was none.
    ///
    /// # Errors
    /// [`NoRoomAtGoal`], where the footprint at the goal is too close to a wall; the goal before stays.
    pub fn set_goal(
        &mut self,
        map: &MapView<'_, S>,
        map_from_goal: Pose<Map, Goal, S>,
    ) -> Result<Option<GoalResult>, NoRoomAtGoal<S>> {
        let at_goal = Pose::new(map_from_goal.x, map_from_goal.y, map_from_goal.heading);
        let required = self.config.collision.wall_clearance;
        let clearance = self.config.collision.distance_to_walls(at_goal, map.walls);
        if let Some(clearance) = clearance.filter(|clearance| *clearance < required) {
            return Err(NoRoomAtGoal { clearance, required });
        }
        let ended = self.end_goal(GoalResult::Preempted);
        self.rest_until = None;
        self.commands.restart_monitor();
        self.goal = Some(ActiveGoal::new(map_from_goal));
        Ok(ended)
    }

    /// Cancels the goal and brakes. `None` where there was no goal, or one whose end was reported.
    pub fn cancel_goal(&mut self) -> Option<GoalResult> {
        self.end_goal(GoalResult::Canceled)
    }

    /// Starts anew at `stamp`. `None` declares the pose unknown, and the robot looks for it; without a localization monitor or a
    /// map it starts at the origin.
    pub fn start(&mut self, stamp: Stamp, belief: Option<Belief<S>>) {
        let origin = Belief::new(Pose::identity(), [S::from_f64(0.0); 3]);
        self.localizer.reset(stamp, belief.unwrap_or(origin));
        self.obstacles = ObstacleMonitor::new(self.config.obstacles);
        if belief.is_none() {
            self.localizer.mark_lost();
        }
    }

    /// Sets the belief of a moment in the history, or of now where the history does not reach to it.
    pub fn set_belief(&mut self, belief: Stamped<Belief<S>>) {
        self.localizer.reset_at(belief.stamp, belief.value);
        self.reset_controller();
    }

    /// Declares the pose unknown, so that the robot looks for it.
    pub fn mark_lost(&mut self) {
        self.localizer.mark_lost();
    }

    /// Handles odometry that is missing for longer than the supervisor allows: the wheels start from rest once it is back.
    ///
    /// Returns whether rest must be commanded now.
    pub fn on_odometry_timeout(&mut self) -> bool {
        let was_resting = self.rest_until.take().is_some();
        self.reset_controller();
        self.commands.forget();
        self.goal.is_some() || was_resting
    }

    /// Ends the goal for a reason outside the step, such as odometry that stays away.
    pub fn abort_goal(&mut self, reason: AbortReason) -> Option<GoalResult> {
        self.end_goal(GoalResult::Aborted(reason))
    }

    /// The estimate and its supervision.
    pub fn localizer(&self) -> &Localizer<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES> {
        &self.localizer
    }

    /// The constants.
    pub fn config(&self) -> &NavigatorConfig<S> {
        &self.config
    }

    /// Returns the obstacles detected by the laser.
    pub fn obstacles(&self) -> &ObstacleMonitor<S, BEAMS> {
        &self.obstacles
    }

    /// The active goal.
    pub fn goal(&self) -> Option<Pose<Map, Goal, S>> {
        self.goal.map(|goal| goal.map_from_goal)
    }

    /// Whether a command is due: a goal is active, or the robot comes to rest after one.
    pub fn commands_wheels(&self) -> bool {
        self.goal.is_some() || self.rest_until.is_some_and(|until| self.localizer.stamp() <= until)
    }

    /// The estimating half of a step.
    fn estimate(
        &mut self,
        map: &MapView<'_, S>,
        input: &SensorInput<'_, S>,
        elapsed: S,
        observer: &mut impl LoopObserver<S>,
    ) -> Belief<S> {
        let input = SensorInput { odometry: self.plausible(input.odometry, elapsed), ..*input };
        let commanded = self.commanded_odometry(&input, elapsed);
        if self.goal.is_some() {
            self.commands.compare(&self.config, input.odometry, elapsed);
        }
        self.watch_laser(map, &input);
        let mut observers = Observers { obstacles: &mut self.obstacles, observer };
        let belief = self.localizer.update(&input, commanded, map, &mut observers);
        self.obstacles.expire(input.stamp);
        belief
    }

    /// The driving half of a step: control, collision check and limits.
    fn drive(
        &mut self,
        mut goal: ActiveGoal<S>,
        map: &MapView<'_, S>,
        elapsed: S,
        report: &mut StepReport<S>,
    ) -> Option<GoalResult> {
        let controller = &self.config.controller;
        // Where the robot will be when this command takes effect.
        let predicted = self.commands.predict(&self.config, report.belief.pose);
        let decision = controller.decide(goal.state, predicted, goal.map_from_goal);
        let desired = match report.action {
            // A lost robot turns in place, so that scans from other headings can localize it.
            SafetyAction::Stop(FaultReason::Lost) if map.is_known() => {
                Twist::new(S::from_f64(0.0), self.config.search_turn_rate)
            }
            SafetyAction::Stop(_) => Twist::zero(),
            _ if goal.is_stopped_by_wall() => Twist::zero(),
            _ => decision.desired,
        };

        // The supervisor and the collision check cap the speed of the rims.
        let cap = self.speed_cap(predicted, desired, map, report);
        let desired = if cap.rim_speed > S::from_f64(0.0) { desired } else { Twist::zero() };

        // Limits come once, and last.
        let limits = if cap.rim_speed > S::from_f64(0.0) {
            controller.limits.with_speed_cap(cap.rim_speed)
        } else {
            controller.limits
        };
        let limited = limits.limit(&controller.drive, desired, self.commands.limited(), controller.period);
        let step = controller.finish(decision, limited);

        // A stop invalidates the pose, and with it the controller state.
        let is_stopped = matches!(report.action, SafetyAction::Stop(_));
        goal.state = if is_stopped { ControllerState::new() } else { step.state };
        goal.note(&self.config, report, &step, cap.blocked_by, elapsed);
        let ended = goal.result(&self.config, step.limited, self.commands.motion_fault(&self.config));

        self.goal = Some(goal);
        report.command = Some(self.commands.send(&self.config, step.limited));
        report.control = Some(step);
        report.blocked_by = cap.blocked_by;
        let is_held = ended == Some(GoalResult::Reached) && self.config.hold_goal;
        if ended.is_some() && !is_held {
            self.release_goal(report.stamp);
        }
        ended
    }

    /// The largest rim speed that supervisor and collision check allow.
    fn speed_cap(
        &self,
        predicted: Pose<Map, Body, S>,
        desired: Twist<S>,
        map: &MapView<'_, S>,
        report: &StepReport<S>,
    ) -> SpeedCap<S> {
        let controller = &self.config.controller;
        if let SafetyAction::Stop(_) = report.action {
            // The pose is invalid, and the robot at most turns in place.
            return SpeedCap::unlimited();
        }
        if let Some(reason) = self.laser_fault(map, report.stamp) {
            return SpeedCap::stop(reason);
        }
        let intent = Intent {
            drive: &controller.drive,
            limits: &controller.limits,
            period: controller.period,
            map_from_body: predicted,
            desired,
            previous: self.commands.limited(),
        };
        let cap = self.config.collision.speed_cap(&intent, map.walls, self.obstacles.points());
        let supervised = match report.action {
            SafetyAction::Slowdown(_) => controller.limits.wheel_speed * report.action.speed_scale(),
            _ => cap.rim_speed,
        };
        SpeedCap { rim_speed: cap.rim_speed.min(supervised), ..cap }
    }

    /// Brakes after a goal, then commands rest for a while; `None` where the wheels are free.
    fn brake(&mut self, now: Stamp) -> Option<Command<S>> {
        let until = self.rest_until.filter(|until| now <= *until);
        let Some(until) = until else {
            self.rest_until = None;
            self.commands.forget();
            return None;
        };
        let controller = &self.config.controller;
        let twist = controller.limits.limit(
            &controller.drive,
            Twist::zero(),
            self.commands.limited(),
            controller.period,
        );
        let is_at_rest = twist == Twist::zero();
        self.rest_until = Some(if is_at_rest { until } else { now.after(REST_TIME) });
        Some(self.commands.send(&self.config, twist))
    }

    /// Ends the goal; returns `result` unless its end was reported before.
    fn end_goal(&mut self, result: GoalResult) -> Option<GoalResult> {
        let goal = self.goal?;
        self.release_goal(self.localizer.stamp());
        (!goal.has_arrived()).then_some(result)
    }

    fn release_goal(&mut self, now: Stamp) {
        self.goal = None;
        self.rest_until = Some(now.after(REST_TIME));
    }

    fn reset_controller(&mut self) {
        if let Some(goal) = &mut self.goal {
            goal.reset_controller();
        }
    }

    /// Time since the previous step \[s]. Stamps that went back end the goal and start time anew; the belief stays.
    fn advance_clock(&mut self, now: Stamp) -> S {
        let elapsed = now.since(self.localizer.stamp());
        if elapsed >= -CLOCK_SET_BACK_THRESHOLD {
            return S::from_f64(elapsed.max(0.0));
        }
        self.result = self.end_goal(GoalResult::Aborted(AbortReason::ClockSetBack));
        self.rest_until = self.rest_until.map(|_| now.after(REST_TIME));
        let is_lost = self.localizer.health() == Health::Lost;
        self.start(now, (!is_lost).then_some(self.localizer.belief()));
        S::from_f64(0.0)
    }
}
