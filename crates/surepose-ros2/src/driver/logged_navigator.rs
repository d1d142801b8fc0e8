//! The navigator, whose calls are logged with their inputs.

use std::ops::Deref;

use surepose::estimation::Belief;
use surepose::geometry::{Goal, Map, Pose};
use surepose::localization::SensorInput;
use surepose::map::MapView;
use surepose::navigator::{AbortReason, GoalResult, NoRoomAtGoal, StepReport};
use surepose::time::{Stamp, Stamped};
use surepose_config::RobotNavigator;
use surepose_recorder::{EventInput, RecorderHandle};

/// Navigator with an optional recorder. Every call that changes the navigator goes through a method of this type; the others are
/// those of the navigator.
#[derive(Clone, Debug)]
pub(super) struct LoggedNavigator {
    navigator: Box<RobotNavigator>,
    recorder: Option<RecorderHandle>,
}

impl LoggedNavigator {
    pub(super) fn new(navigator: Box<RobotNavigator>) -> Self {
        Self { navigator, recorder: None }
    }

    pub(super) fn record(&mut self, recorder: RecorderHandle) {
        self.recorder = Some(recorder);
    }

    pub(super) fn step(&mut self, map: &MapView<'_, f64>, input: &SensorInput<'_, f64>) -> StepReport<f64> {
        let report = self.navigator.step(map, input);
        if let Some(recorder) = &self.recorder {
            recorder.log_step(input, &report);
        }
        report
    }

    pub(super) fn start(&mut self, stamp: Stamp, belief: Option<Belief<f64>>) {
        self.log(stamp, EventInput::Start(belief));
        self.navigator.start(stamp, belief);
    }

    pub(super) fn set_belief(&mut self, belief: Stamped<Belief<f64>>) {
        self.log(belief.stamp, EventInput::SetBelief(belief.value));
        self.navigator.set_belief(belief);
    }

    pub(super) fn mark_lost(&mut self) {
        self.log_now(EventInput::MarkLost);
        self.navigator.mark_lost();
    }

    pub(super) fn set_goal(
        &mut self,
        map: &MapView<'_, f64>,
        goal: Pose<Map, Goal, f64>,
    ) -> Result<Option<GoalResult>, NoRoomAtGoal<f64>> {
        self.log_now(EventInput::SetGoal(goal));
        self.navigator.set_goal(map, goal)
    }

    pub(super) fn cancel_goal(&mut self) -> Option<GoalResult> {
        self.log_now(EventInput::CancelGoal);
        self.navigator.cancel_goal()
    }

    pub(super) fn abort_goal(&mut self, reason: AbortReason) -> Option<GoalResult> {
        self.log_now(EventInput::AbortGoal);
        self.navigator.abort_goal(reason)
    }

    pub(super) fn on_odometry_timeout(&mut self) -> bool {
        self.log_now(EventInput::OdometryTimeout);
        self.navigator.on_odometry_timeout()
    }

    fn log_now(&self, input: EventInput) {
        self.log(self.navigator.localizer().stamp(), input);
    }

    fn log(&self, stamp: Stamp, input: EventInput) {
        if let Some(recorder) = &self.recorder {
            recorder.log(stamp, input);
        }
    }
}

impl Deref for LoggedNavigator {
    type Target = RobotNavigator;

    fn deref(&self) -> &RobotNavigator {
        &self.navigator
    }
}
