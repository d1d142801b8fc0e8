//! The node without ROS: odometry, headings, scans and goals in, beliefs and velocity commands out.
//!
//! [`NodeDriver`] feeds the core's [`Navigator`](surepose::navigator::Navigator) from messages. Its time is that of the
//! odometry stamps; it steps once per control period. The result does not depend on the speed at which a bag is played.

mod anchor;
mod logged_navigator;
mod measurement_queue;
mod odometry_accumulator;
mod settings;

use anchor::Anchor;
use logged_navigator::LoggedNavigator;
use measurement_queue::MeasurementQueue;
use surepose::control::{Controller, NavigationVariables};
use surepose::estimation::{Belief, Measurement, MeasurementStats};
use surepose::geometry::{Body, Goal, Map, Pose};
use surepose::kinematics::{Twist, WheelPair};
use surepose::localization::{Odometry, SensorInput};
use surepose::map::Wall;
use surepose::navigator::{AbortReason, GoalResult, StepReport};
use surepose::param;
use surepose::safety::{BlockReason, FaultReason, Health, SafetyAction};
use surepose::time::{Stamp, Stamped};
use surepose_io::owned_map::{GoalProblem, OwnedMap};
use surepose_recorder::RecorderHandle;

use crate::convert::MessageError;

pub(crate) use odometry_accumulator::OdometryAccumulator;

pub use measurement_queue::{LaserScan, SensorMessage};
pub use odometry_accumulator::Odom;
pub use settings::{NodeDriverSettings, START_STD};

/// Time before the end of a gap in odometry from which on measurements are used \[s].
const GAP_END: f64 = 0.05;

/// Outcome of one step.
#[derive(Clone, Copy, Debug)]
pub struct DriverReport {
    /// Time of the step.
    pub stamp: Stamp,
    /// Estimate; meaningless while the robot is lost.
    pub belief: Belief<f64>,
    /// Pose of the odometry frame on the map.
    pub map_from_odom: Pose<Map, Odom, f64>,
    /// Health of the estimate.
    pub health: Health,
    /// Action of the supervisor.
    pub action: SafetyAction,
    /// Commanded twist; `None` if the node publishes no command.
    pub command: Option<Twist<f64>>,
    /// Goal relative to the robot; `None` without a goal.
    pub navigation: Option<NavigationVariables<f64>>,
    /// Reason of a stop for an obstacle; `None` if the path is free.
    pub blocked_by: Option<BlockReason>,
    /// Result of the goal, in the step in which it ended.
    pub result: Option<GoalResult>,
}

/// Drives the navigator from messages.
#[derive(Clone, Debug)]
pub struct NodeDriver {
    settings: NodeDriverSettings,
    navigator: LoggedNavigator,
    map: OwnedMap,
    queue: MeasurementQueue,
    /// `None` before the first odometry.
    odometry: Option<OdometryAccumulator>,
    /// The last given pose, moved along by odometry; `None` if no pose was given.
    anchor: Option<Anchor>,
    /// Whether the goal was set while the pose of the robot was unknown.
    is_goal_unchecked: bool,
}

impl NodeDriver {
    /// Creates a driver that has received no message.
    pub fn new(settings: NodeDriverSettings) -> Self {
        let map =
            settings.map.as_ref().map_or_else(|| OwnedMap::from_walls(Vec::new()), OwnedMap::from_wall_map);
        let belief = settings.belief();
        let navigator = settings.config.navigator(&settings.navigator_setup(), Stamp::default(), belief);
        Self {
            navigator: LoggedNavigator::new(navigator),
            map,
            queue: MeasurementQueue::default(),
            odometry: None,
            anchor: None,
            is_goal_unchecked: false,
            settings,
        }
    }

    /// Logs every call of the navigator with `recorder`, whose session is [`NodeDriverSettings::session`].
    #[must_use]
    pub fn recorded_by(mut self, recorder: RecorderHandle) -> Self {
        self.navigator.record(recorder);
        self
    }

    /// Adds an odometry pose, and steps at the end of a control period.
    ///
    /// # Errors
    /// [`MessageError::OutOfOrder`] for a stamp that is not later than the last one. A stamp that is over 1 s earlier means
    /// that the clock was set back: the loop restarts from the estimate.
    pub fn on_odometry(
        &mut self,
        at: Stamped<Pose<Odom, Body, f64>>,
    ) -> Result<Option<DriverReport>, MessageError> {
        let controller = self.navigator.config().controller;
        let travel = match &mut self.odometry {
            None => {
                self.odometry = Some(OdometryAccumulator::new(at));
                let belief = self.initial_belief();
                self.navigator.start(at.stamp, belief);
                self.anchor = belief.map(|belief| Anchor::new(belief, at.value));
                return Ok(None);
            }
            Some(odometry) if odometry.is_set_back(at.stamp) => {
                // The navigator ends the goal and resets its time; the travel over the jump is unknown.
                *odometry = OdometryAccumulator::new(at);
                self.queue = MeasurementQueue::default();
                Some(WheelPair::zero())
            }
            Some(odometry) => match odometry.take_gap(&controller, at) {
                Some(motions) => return Ok(self.step_over_gap(at, motions)),
                None => odometry.add(&controller, at)?,
            },
        };
        if let Some(anchor) = &mut self.anchor {
            anchor.move_to(at.value);
        }
        Ok(travel.map(|travel| self.step(at, Odometry::WheelTravel(travel))))
    }

    /// Queues a measurement, at the time that the configured latencies and the timing of the laser give. Without a map, scans
    /// are dropped.
    pub fn add_measurement(&mut self, message: Stamped<SensorMessage>) {
        let Stamped { stamp, mut value } = message;
        let stamp = match &mut value {
            SensorMessage::Scan(_) if !self.has_map() => return,
            SensorMessage::Scan(scan) => {
                let laser = self.settings.config.laser();
                scan.resolve(stamp.after(-laser.latency), &laser.timing)
            }
            SensorMessage::Measurement(Measurement::Heading(_)) => {
                stamp.after(-self.settings.config.compass().latency)
            }
            SensorMessage::Measurement(_) | SensorMessage::YawRate(_) => stamp,
        };
        self.queue.put(Stamped::new(stamp, value));
    }

    /// Sets the pose at a stamp within the filter's history, or else the current pose.
    pub fn set_pose(&mut self, belief: Stamped<Belief<f64>>) {
        self.settings.start = Some(belief.value);
        if let Some(odometry) = &self.odometry {
            self.anchor = Some(Anchor::new(belief.value, odometry.pose()));
            self.navigator.set_belief(belief);
            self.queue = MeasurementQueue::default();
        }
    }

    /// Starts global localization. Without a map the estimate stays.
    pub fn start_global_localization(&mut self) {
        if self.has_map() {
            self.settings.start = None;
            self.anchor = None;
            if self.odometry.is_some() {
                self.navigator.mark_lost();
            }
        }
    }

    /// Restarts the estimate after a change of the mounting of a sensor: estimates with the previous mounting are invalid.
    ///
    /// The estimate restarts from the last given pose, moved along by odometry, or else from global localization.
    pub fn on_mounting_changed(&mut self) {
        self.queue = MeasurementQueue::default();
        if let Some(odometry) = &self.odometry {
            self.navigator.start(odometry.stamp(), self.anchor.as_ref().map(Anchor::belief));
        }
    }

    /// Sets a new goal, and returns the result of the previous one.
    ///
    /// # Errors
    /// [`MessageError::Goal`] if the walls of the map rule the goal out; the previous goal stays active. If the robot is lost,
    /// whether walls separate it from the goal is checked once it is localized.
    pub fn set_goal(&mut self, goal: Pose<Map, Goal, f64>) -> Result<Option<GoalResult>, MessageError> {
        let is_lost = self.navigator.localizer().health() == Health::Lost || self.odometry.is_none();
        self.check_goal(goal, !is_lost).map_err(MessageError::Goal)?;
        self.is_goal_unchecked = is_lost;
        // The navigator repeats the check of the clearance, which has passed.
        Ok(self.navigator.set_goal(&self.map.view(), goal).unwrap_or(None))
    }

    fn check_goal(&self, goal: Pose<Map, Goal, f64>, is_localized: bool) -> Result<(), GoalProblem> {
        let here = is_localized.then(|| self.belief().pose.origin());
        self.map.check_goal(&self.navigator.config().collision, here, goal)
    }

    /// Cancels the goal and brakes.
    pub fn cancel(&mut self) -> Option<GoalResult> {
        self.navigator.cancel_goal()
    }

    /// Handles odometry that is `age` \[s] old by the wall clock.
    ///
    /// Returns whether the node must command rest, and the result of a goal that ended.
    pub fn on_odometry_timeout(&mut self, age: f64) -> (bool, Option<GoalResult>) {
        if !self.is_odometry_timed_out(age) {
            return (false, None);
        }
        let must_rest = self.navigator.on_odometry_timeout();
        let gives_up = must_rest && age > self.navigator.config().goal_timeout;
        let reason = AbortReason::Fault(FaultReason::OdometryTimeout);
        let ended = if gives_up { self.navigator.abort_goal(reason) } else { None };
        if gives_up {
            // Rest was commanded: the braking is complete.
            self.navigator.on_odometry_timeout();
        }
        (must_rest, ended)
    }

    /// Whether the navigator commands the wheels: for an active goal, or to brake after one.
    pub fn is_commanding(&self) -> bool {
        self.navigator.commands_wheels()
    }

    /// Whether odometry that is `age` \[s] old has timed out.
    pub fn is_odometry_timed_out(&self, age: f64) -> bool {
        age > self.settings.config.number(&param::ODOMETRY_TIMEOUT)
    }

    /// Whether a goal is active.
    pub fn is_driving(&self) -> bool {
        self.navigator.goal().is_some()
    }

    /// First wall on the straight line to `goal`, which the control law does not avoid.
    pub fn wall_on_straight_path(&self, goal: Pose<Map, Goal, f64>) -> Option<&Wall<f64>> {
        let here = self.belief().pose.origin();
        self.map.walls().iter().find(|wall| wall.crosses([here, goal.origin()]))
    }

    /// The estimate.
    pub fn belief(&self) -> Belief<f64> {
        self.navigator.localizer().belief()
    }

    /// Counts of accepted and rejected measurements.
    pub fn measurement_stats(&self) -> &MeasurementStats {
        self.navigator.localizer().measurement_stats()
    }

    /// Number of messages dropped because odometry did not reach their stamps.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }

    /// Time of the estimate.
    pub fn belief_stamp(&self) -> Stamp {
        self.navigator.localizer().stamp()
    }

    /// The active goal.
    pub fn goal(&self) -> Option<Pose<Map, Goal, f64>> {
        self.navigator.goal()
    }

    /// The controller.
    pub fn controller(&self) -> &Controller<f64> {
        &self.navigator.config().controller
    }

    fn has_map(&self) -> bool {
        !self.map.walls().is_empty()
    }

    /// Initial belief; `None` starts global localization. Without a map, the robot's pose is the map's origin.
    fn initial_belief(&self) -> Option<Belief<f64>> {
        let origin = Belief::new(Pose::identity(), [0.0; 3]);
        self.settings.start.or_else(|| (!self.has_map()).then_some(origin))
    }

    /// Steps over a gap in odometry, whose increment is kept. Measurements from within the gap are dropped and counted: the way
    /// between its ends is unknown.
    fn step_over_gap(
        &mut self,
        at: Stamped<Pose<Odom, Body, f64>>,
        motions: [(Stamp, WheelPair<f64>); 3],
    ) -> Option<DriverReport> {
        if let Some(anchor) = &mut self.anchor {
            anchor.move_to(at.value);
        }
        let begin = self.belief_stamp();
        self.queue.drop_between(begin, at.stamp.after(-GAP_END));
        let mut last = None;
        for (stamp, travel) in motions {
            last = Some(self.step(Stamped::new(stamp, at.value), Odometry::WheelTravel(travel)));
        }
        last
    }

    fn step(&mut self, at: Stamped<Pose<Odom, Body, f64>>, odometry: Odometry<f64>) -> DriverReport {
        let due = self.queue.until(at.stamp);
        let readings: Vec<_> = due.iter().map(SensorMessage::reading).collect();
        let input = SensorInput { stamp: at.stamp, odometry, readings: &readings };
        let mut report = self.navigator.step(&self.map.view(), &input);
        if self.is_goal_unchecked && report.health != Health::Lost {
            self.is_goal_unchecked = false;
            if self.navigator.goal().is_some_and(|goal| self.check_goal(goal, true).is_err()) {
                let blocked = AbortReason::Blocked(BlockReason::Wall);
                report.result = report.result.or(self.navigator.abort_goal(blocked));
            }
        }
        DriverReport::new(&report, report.belief.pose * at.value.inverse())
    }
}

impl DriverReport {
    fn new(report: &StepReport<f64>, map_from_odom: Pose<Map, Odom, f64>) -> Self {
        Self {
            stamp: report.stamp,
            belief: report.belief,
            map_from_odom,
            health: report.health,
            action: report.action,
            command: report.command.map(|command| command.twist),
            navigation: report.control.map(|control| control.navigation),
            blocked_by: report.blocked_by,
            result: report.result,
        }
    }
}

#[cfg(all(test, feature = "simulate"))]
mod tests;
