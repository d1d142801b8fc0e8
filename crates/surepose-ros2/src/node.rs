//! The node: subscribes to messages, steps the driver and publishes its results.
//!
//! One thread handles all messages in sequence.

mod action;
mod diagnostics;
mod parameters;
mod publishers;
mod settings;
mod subscriptions;

use std::time::{Duration, Instant};

use action::{NavigateAction, ResultDelivery};
use diagnostics::Diagnostics;
use futures::future::LocalBoxFuture;
use futures::stream::{FuturesUnordered, StreamExt};
use futures::{FutureExt, select};
use publishers::Publishers;
use ros2_client::RmwRequestId;
use subscriptions::{NodeEvent, Subscriptions};
use surepose::control::{Controller, NavigationVariables};
use surepose::geometry::{Goal, Map, Pose};
use surepose::kinematics::Twist;
use surepose::navigator::GoalResult;
use surepose::time::{Stamp, Stamped};
use surepose_config::describe_abort;

use crate::convert::{MessageError, belief_of, pose_of, stamp_of};
use crate::dds::{self, NodeError, spinning};
use crate::driver::{DriverReport, NodeDriver, START_STD};
use crate::extrinsics::ExtrinsicsResolver;
use crate::message::{Imu, LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped};
use crate::sense;

pub use settings::NodeSettings;

/// Period of the timer that checks the wall clock.
const TIMER_PERIOD: Duration = Duration::from_millis(100);

/// Time after which an unknown mounting of a sensor causes a warning.
const MOUNTING_TIMEOUT: Duration = Duration::from_secs(10);

/// Timer periods per diagnostics message.
const DIAGNOSTICS_EVERY: u32 = 10;

/// Runs the node until `stops` returns true. Each timer period calls `stops`; `say` receives one line per event.
///
/// If the node has commanded the wheels, its last command is rest.
///
/// # Errors
/// [`NodeError`], before the first command.
pub fn run(settings: NodeSettings, stops: impl Fn() -> bool, say: impl FnMut(&str)) -> Result<(), NodeError> {
    let context = settings.network.join()?;
    let options = parameters::declared(&settings.driver.config);
    let mut node = dds::node(&context, &settings.names, settings.names.node(), options)?;
    let publishers = Publishers::new(&mut node, &settings)?;
    let subscriptions = Subscriptions::new(&mut node, &settings)?;
    let action = NavigateAction::new(&mut node, &settings.names)?;
    let spinning = spinning(&mut node)?;
    let driver = NodeDriver::new(settings.driver.clone());
    let mut run = Run {
        driver: match settings.recorder.clone() {
            Some(recorder) => driver.recorded_by(recorder),
            None => driver,
        },
        extrinsics: ExtrinsicsResolver::new(&settings.driver.config),
        publishers,
        action,
        deliveries: FuturesUnordered::new(),
        diagnostics: Diagnostics::new(settings.warnings.clone()),
        last_rolled: None,
        waiting_since: None,
        timer_ticks: 0,
        settings,
        say,
    };
    smol::block_on(run.listen(&subscriptions, stops));
    drop((subscriptions, node, spinning));
    Ok(())
}

/// Running node.
struct Run<Say> {
    driver: NodeDriver,
    extrinsics: ExtrinsicsResolver,
    publishers: Publishers,
    action: NavigateAction,
    deliveries: FuturesUnordered<LocalBoxFuture<'static, ()>>,
    diagnostics: Diagnostics,
    /// Wall-clock time of the last odometry.
    last_rolled: Option<Instant>,
    /// Since when the mounting of a sensor is unknown by the wall clock, and whether a warning was printed; `None` if all are known.
    waiting_since: Option<(Instant, bool)>,
    timer_ticks: u32,
    settings: NodeSettings,
    say: Say,
}

impl<Say: FnMut(&str)> Run<Say> {
    async fn listen(&mut self, subscriptions: &Subscriptions, stops: impl Fn() -> bool) {
        let server = self.action.server();
        let mut events = subscriptions.events(&server, TIMER_PERIOD).fuse();
        self.publishers.walls(&self.settings);
        while !stops() {
            select! {
                event = events.select_next_some() => self.on(event, subscriptions).await,
                () = self.deliveries.select_next_some() => {}
            }
        }
        if self.driver.is_commanding() {
            self.stop_wheels();
        }
        let ended = self.driver.cancel();
        self.finish(ended);
        // Clients that wait for the result receive it.
        let mut patience = FutureExt::fuse(smol::Timer::after(5 * TIMER_PERIOD));
        while !self.deliveries.is_empty() {
            select! {
                () = self.deliveries.select_next_some() => {}
                _ = patience => break,
            }
        }
    }

    async fn on(&mut self, event: NodeEvent, subscriptions: &Subscriptions) {
        let handled = match event {
            NodeEvent::Odometry(odometry) => self.rolled(&odometry).await,
            NodeEvent::Scan(scan) => self.seen(scan),
            NodeEvent::StaticTransforms(told) => {
                self.extrinsics.learn(&told).map_err(|why| ("tf_static", why))
            }
            NodeEvent::Imu(imu) => self.turned(&imu),
            NodeEvent::Goal(goal) => self.on_goal_pose(&goal),
            NodeEvent::InitialPose(told) => self.told(&told),
            NodeEvent::GlobalLocalization(request) => {
                self.lost(request, subscriptions);
                Ok(())
            }
            NodeEvent::ActionGoal(handle) => {
                self.asked(handle).await;
                Ok(())
            }
            NodeEvent::Cancel(request) => {
                if self.action.cancels(&request).await {
                    let ended = self.driver.cancel();
                    self.finish(ended);
                }
                Ok(())
            }
            NodeEvent::Timer => {
                self.timer();
                Ok(())
            }
            NodeEvent::Unreadable(topic) => {
                self.diagnostics.unreadable(topic);
                Ok(())
            }
        };
        if let Err((topic, refused)) = handled {
            let is_first = self.diagnostics.refuse(topic, &refused);
            // Each goal has an answer; other messages come many times a second.
            if is_first || matches!(refused, MessageError::Goal(_)) {
                self.say(&format!("{topic}: message rejected: {refused}"));
            }
        }
    }

    async fn rolled(&mut self, odometry: &Odometry) -> Result<(), (&'static str, MessageError)> {
        let refused = |why| ("odom", why);
        let at = sense::odometry(odometry).map_err(refused)?;
        self.extrinsics.set_base_frame(&odometry.child_frame_id);
        let report = self.driver.on_odometry(at).map_err(refused)?;
        self.diagnostics.rolled(at.stamp);
        self.last_rolled = Some(Instant::now());
        if let Some(report) = report {
            self.publishers.report(&report, odometry);
            self.feed_back(&report).await;
            if let Some(change) = self.diagnostics.keep(&report) {
                self.say(&change);
            }
            if let (Some(GoalResult::Reached), Some(seen)) = (report.result, report.navigation) {
                let (position, heading) = (1e3 * seen.rho, seen.heading_error().degrees().abs());
                self.say(&format!("rests {position:.1} mm and {heading:.2}° from the goal (estimated)"));
            }
            self.finish(report.result);
        }
        Ok(())
    }

    fn seen(&mut self, scan: LaserScan) -> Result<(), (&'static str, MessageError)> {
        let refused = |why| ("scan", why);
        let Some(laser_extrinsics) = self.extrinsics.laser(&scan.header.frame_id).map_err(refused)? else {
            self.diagnostics.drop_unplaced();
            return Ok(());
        };
        self.restart_if_moved();
        if let Some(source) = self.extrinsics.take_source_message() {
            self.say(&source);
        }
        self.driver.add_measurement(sense::scan(scan, laser_extrinsics));
        Ok(())
    }

    fn turned(&mut self, imu: &Imu) -> Result<(), (&'static str, MessageError)> {
        let Some(mounting) = self.extrinsics.compass(&imu.header.frame_id) else {
            self.diagnostics.drop_unplaced();
            return Ok(());
        };
        self.restart_if_moved();
        let refused = |why| ("imu", why);
        if self.settings.driver.gyroscope {
            self.driver.add_measurement(sense::yaw_rate(imu, &mounting).map_err(refused)?);
        }
        if self.settings.driver.compass {
            let compass = self.settings.driver.config.compass();
            self.driver.add_measurement(sense::heading(imu, &mounting, &compass).map_err(refused)?);
        }
        Ok(())
    }

    /// Restarts the estimate if a sensor's mounting differs from that of its previous measurements.
    fn restart_if_moved(&mut self) {
        if self.extrinsics.take_change() {
            self.driver.on_mounting_changed();
            self.say("/tf_static: the mounting of a sensor has changed; the estimate restarts");
        }
    }

    /// Handles a goal by topic: RViz's "2D Goal Pose".
    fn on_goal_pose(&mut self, goal: &PoseStamped) -> Result<(), (&'static str, MessageError)> {
        self.set_goal(goal).map_err(|why| ("goal_pose", why))
    }

    /// Handles a goal by action.
    async fn asked(&mut self, handle: action::NewGoal) {
        let Some(goal) = self.action.goal_of(&handle) else { return };
        match self.set_goal(&goal.pose) {
            Ok(()) => self.action.accept(handle, self.driver.belief_stamp()).await,
            Err(refused) => {
                self.say(&format!("navigate_to_pose: goal rejected: {refused}"));
                self.diagnostics.refuse("navigate_to_pose", &refused);
                if matches!(refused, MessageError::Goal(_)) {
                    // A rejected goal has no message, an aborted one has.
                    let refusal = self.action.refuse(handle, refused.to_string()).await;
                    self.deliveries.extend(refusal.map(ResultDelivery::made));
                } else {
                    self.action.reject(handle).await;
                }
            }
        }
    }

    fn set_goal(&mut self, message: &PoseStamped) -> Result<(), MessageError> {
        self.in_map(&message.header.frame_id)?;
        let goal: Pose<Map, Goal, f64> = pose_of(&message.pose)?;
        let wall = self.driver.wall_on_straight_path(goal).copied();
        let before = self.driver.set_goal(goal)?;
        self.finish(before);
        self.say(&format!("new goal: ({:.3}, {:.3}) facing {:.1}°", goal.x, goal.y, goal.heading.degrees()));
        if let Some(wall) = wall {
            let [a, b] = wall.ends();
            self.say(&format!(
                "warning: the wall from ({:.2}, {:.2}) to ({:.2}, {:.2}) stands between robot and goal: the law does not go round \
                 obstacles, and the robot will stop before it",
                a.x, a.y, b.x, b.y
            ));
        }
        Ok(())
    }

    /// Handles an initial pose: RViz's "2D Pose Estimate".
    fn told(&mut self, told: &PoseWithCovarianceStamped) -> Result<(), (&'static str, MessageError)> {
        let refused = |why| ("initialpose", why);
        self.in_map(&told.header.frame_id).map_err(refused)?;
        let belief = belief_of(&told.pose, START_STD).map_err(refused)?;
        self.driver.set_pose(Stamped::new(stamp_of(told.header.stamp), belief));
        let (pose, heading) = (belief.pose, belief.pose.heading.degrees());
        self.say(&format!("initial pose: ({:.3}, {:.3}) facing {heading:.1}°", pose.x, pose.y));
        Ok(())
    }

    fn lost(&mut self, request: RmwRequestId, subscriptions: &Subscriptions) {
        self.driver.start_global_localization();
        subscriptions.answer(request);
        self.say("global localization requested");
    }

    fn in_map(&self, frame: &str) -> Result<(), MessageError> {
        let expected = &self.settings.map_frame;
        let known = frame.is_empty() || frame.trim_start_matches('/') == expected;
        let wrong =
            || MessageError::WrongFrame { expected: expected.clone(), got: frame.escape_debug().to_string() };
        if known { Ok(()) } else { Err(wrong()) }
    }

    async fn feed_back(&mut self, report: &DriverReport) {
        let Some(navigation) = report.navigation else { return };
        let controller = self.driver.controller();
        let remaining = turn_drive_turn_time(&navigation, controller);
        self.action.feed_back(report, navigation.rho, remaining, &self.settings.map_frame).await;
    }

    /// Handles the end of a goal.
    fn finish(&mut self, ended: Option<GoalResult>) {
        let Some(ended) = ended else { return };
        match ended {
            GoalResult::Canceled => self.say("goal canceled"),
            GoalResult::Preempted => self.say("goal preempted by another goal"),
            GoalResult::Aborted(reason) => self.say(&format!("goal aborted: {}", describe_abort(reason))),
            // A reached goal has a line of its own.
            _ => {}
        }
        if let Some(delivery) = self.action.ended(ended) {
            self.deliveries.push(ResultDelivery::made(delivery));
        }
    }

    fn timer(&mut self) {
        self.timer_ticks = self.timer_ticks.wrapping_add(1);
        let age = self.age();
        let (must_rest, ended) = self.driver.on_odometry_timeout(age);
        if must_rest {
            self.stop_wheels();
        }
        self.finish(ended);
        let waiting = self.waiting();
        if self.timer_ticks.is_multiple_of(DIAGNOSTICS_EVERY) {
            let array = self.diagnostics.array(&self.driver, age, waiting.as_deref());
            self.publishers.diagnose(array);
        }
    }

    /// Line about a sensor whose mounting is unknown, with the remedy after a while; `None` if all are known.
    fn waiting(&mut self) -> Option<String> {
        let Some(waiting) = self.extrinsics.waiting() else {
            self.waiting_since = None;
            return None;
        };
        let (since, has_warned) = self.waiting_since.unwrap_or((Instant::now(), false));
        let is_late = since.elapsed() > MOUNTING_TIMEOUT;
        self.waiting_since = Some((since, is_late));
        if !is_late {
            return Some(waiting);
        }
        let line = format!("{waiting}; {}", self.extrinsics.remedy());
        if !has_warned {
            self.say(&format!("warning: {line}"));
        }
        Some(line)
    }

    /// Age of the last odometry by the wall clock \[s]; before the first one, the time since the start.
    fn age(&mut self) -> f64 {
        self.last_rolled.get_or_insert_with(Instant::now).elapsed().as_secs_f64()
    }

    /// Commands rest, stamped with the odometry time extrapolated by the wall clock, because bases reject old commands.
    ///
    /// Before the first odometry the stamp is zero, which bases take as the current time.
    fn stop_wheels(&mut self) {
        let (last, age) = (self.driver.belief_stamp(), self.age());
        let now = if last == Stamp::default() { last } else { last.after(age) };
        self.publishers.command(now, Twist::zero());
    }

    fn say(&mut self, what: &str) {
        (self.say)(what);
    }
}

/// Time to turn towards the goal, drive to it and turn to its heading, each at the wheels' limit \[s].
fn turn_drive_turn_time(navigation: &NavigationVariables<f64>, controller: &Controller<f64>) -> f64 {
    let NavigationVariables { rho, alpha, phi } = navigation;
    let turns = alpha.radians().abs() + phi.radians().abs();
    (rho + 0.5 * controller.drive.wheel_separation * turns) / controller.limits.wheel_speed
}
