//! The node: it hears messages, lets the pilot think, and says what comes of it.
//!
//! Everything happens on one thread, one message after the other, so that nothing is decided twice.

mod action;
mod diagnosis;
mod ears;
mod parameters;
mod voice;

use std::time::{Duration, Instant};

use futures::future::LocalBoxFuture;
use futures::stream::{FuturesUnordered, StreamExt};
use futures::{FutureExt, select};
use ros2_client::RmwRequestId;
use surepose::{Goal, Map, Pose, Stamp, Stamped, Twist};
use surepose_lab::optimal::fastest;

use crate::convert::{Refused, belief_of, pose_of, stamp_of};
use crate::message::{Imu, LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped};
use crate::mounting::LaserMount;
use crate::names::Names;
use crate::network::Network;
use crate::pilot::{Ended, Pilot, Report, START_STD, Settings};
use crate::sense;
use crate::wire::{self, NodeError, spinning};

use action::{Action, Delivery};
use diagnosis::Diagnosis;
use ears::{Ears, Event};
use voice::Voice;

/// Everything that a node is told at its start.
#[derive(Clone, Debug)]
pub struct NodeSettings {
    /// What the pilot flies by.
    pub pilot: Settings,
    /// What its topics are called.
    pub names: Names,
    /// The frame of the map.
    pub map_frame: String,
    /// Whether `cmd_vel` is a `TwistStamped`, as since Jazzy, or a `Twist`.
    pub stamped: bool,
    /// The network.
    pub network: Network,
    /// What is to be said of the configuration in diagnostics: that it is not certified, for example.
    pub warnings: Vec<String>,
}

/// How often the node looks at the clock on the wall.
const BEAT: Duration = Duration::from_millis(100);

/// A diagnosis with every so many beats.
const DIAGNOSIS: u32 = 10;

/// Runs the node until `stops` says so, which is asked with every beat; `say` is told what happens, in a line each.
///
/// The last command is to rest, if the wheels were told anything.
///
/// # Errors
/// [`NodeError`], before anything is driven.
pub fn run(settings: NodeSettings, stops: impl Fn() -> bool, say: impl FnMut(&str)) -> Result<(), NodeError> {
    let context = settings.network.join()?;
    let options = parameters::declared(&settings.pilot.config);
    let mut node = wire::node(&context, &settings.names, "surepose", options)?;
    let voice = Voice::new(&mut node, &settings)?;
    let ears = Ears::new(&mut node, &settings)?;
    let action = Action::new(&mut node, &settings.names)?;
    let spinning = spinning(&mut node)?;
    let mut run = Run {
        pilot: Pilot::new(settings.pilot.clone()),
        mount: LaserMount::new(&settings.pilot.config),
        voice,
        action,
        deliveries: FuturesUnordered::new(),
        diagnosis: Diagnosis::new(settings.warnings.clone()),
        last_rolled: None,
        beats: 0,
        settings,
        say,
    };
    smol::block_on(run.listen(&ears, stops));
    drop((ears, node, spinning));
    Ok(())
}

/// A node at work.
struct Run<Say> {
    pilot: Pilot,
    mount: LaserMount,
    voice: Voice,
    action: Action,
    deliveries: FuturesUnordered<LocalBoxFuture<'static, ()>>,
    diagnosis: Diagnosis,
    /// When odometry last came, by the clock on the wall.
    last_rolled: Option<Instant>,
    beats: u32,
    settings: NodeSettings,
    say: Say,
}

impl<Say: FnMut(&str)> Run<Say> {
    async fn listen(&mut self, ears: &Ears, stops: impl Fn() -> bool) {
        let server = self.action.server();
        let mut events = ears.events(&server, BEAT).fuse();
        self.voice.walls(&self.settings);
        while !stops() {
            select! {
                event = events.select_next_some() => self.on(event, ears).await,
                () = self.deliveries.select_next_some() => {}
            }
        }
        if self.pilot.has_wheels() {
            self.stand();
        }
        let ended = self.pilot.cancel();
        self.finish(ended);
        // Whoever waits for the result hears of it.
        let mut patience = FutureExt::fuse(smol::Timer::after(5 * BEAT));
        while !self.deliveries.is_empty() {
            select! {
                () = self.deliveries.select_next_some() => {}
                _ = patience => break,
            }
        }
    }

    async fn on(&mut self, event: Event, ears: &Ears) {
        let heard = match event {
            Event::Odometry(odometry) => self.rolled(&odometry).await,
            Event::Scan(scan) => self.seen(scan),
            Event::Joints(told) => self.mount.learn(&told).map_err(|why| ("tf_static", why)),
            Event::Imu(imu) => self.turned(&imu),
            Event::Goal(goal) => self.sent(&goal),
            Event::Told(told) => self.told(&told),
            Event::Lose(request) => {
                self.lost(request, ears);
                Ok(())
            }
            Event::NewGoal(handle) => {
                self.asked(handle).await;
                Ok(())
            }
            Event::Cancel(request) => {
                if self.action.cancels(&request).await {
                    let ended = self.pilot.cancel();
                    self.finish(ended);
                }
                Ok(())
            }
            Event::Beat => {
                self.beat();
                Ok(())
            }
            Event::Unreadable(topic) => {
                self.diagnosis.unreadable(topic);
                Ok(())
            }
        };
        if let Err((topic, refused)) = heard
            && self.diagnosis.refuse(topic, &refused)
        {
            self.say(&format!("{topic}: a message is not used: {refused}"));
        }
    }

    async fn rolled(&mut self, odometry: &Odometry) -> Result<(), (&'static str, Refused)> {
        let refused = |why| ("odom", why);
        let at = sense::odometry(odometry).map_err(refused)?;
        self.mount.sits_on(&odometry.child_frame_id);
        let report = self.pilot.roll(at).map_err(refused)?;
        self.diagnosis.rolled(at.stamp);
        self.last_rolled = Some(Instant::now());
        if let Some(report) = report {
            self.voice.report(&report, odometry);
            self.feed_back(&report).await;
            if let Some(change) = self.diagnosis.keep(&report) {
                self.say(&change);
            }
            if let (Some(Ended::Reached), Some(seen)) = (report.ended, report.navigation) {
                let (position, heading) = (1e3 * seen.rho, seen.heading_error().degrees().abs());
                self.say(&format!(
                    "rests {position:.1} mm and {heading:.2}° from the goal, as far as it knows"
                ));
            }
            self.finish(report.ended);
        }
        Ok(())
    }

    fn seen(&mut self, scan: LaserScan) -> Result<(), (&'static str, Refused)> {
        let refused = |why| ("scan", why);
        let mounting = self.mount.of(&scan.header.frame_id).map_err(refused)?;
        if let Some(source) = self.mount.news() {
            self.say(&source);
        }
        self.pilot.hear(sense::scan(scan, mounting).map_err(refused)?);
        Ok(())
    }

    fn turned(&mut self, imu: &Imu) -> Result<(), (&'static str, Refused)> {
        let compass = self.settings.pilot.config.compass();
        self.pilot.hear(sense::heading(imu, &compass).map_err(|why| ("imu", why))?);
        Ok(())
    }

    /// A goal by topic: RViz's "2D Goal Pose".
    fn sent(&mut self, goal: &PoseStamped) -> Result<(), (&'static str, Refused)> {
        self.go(goal).map_err(|why| ("goal_pose", why))
    }

    /// A goal by action.
    async fn asked(&mut self, handle: action::NewGoal) {
        let Some(goal) = self.action.goal_of(&handle) else { return };
        match self.go(&goal.pose) {
            Ok(()) => self.action.accept(handle, self.pilot.belief_stamp()).await,
            Err(refused) => {
                self.say(&format!("navigate_to_pose: a goal is rejected: {refused}"));
                self.diagnosis.refuse("navigate_to_pose", &refused);
                self.action.reject(handle).await;
            }
        }
    }

    fn go(&mut self, message: &PoseStamped) -> Result<(), Refused> {
        self.in_map(&message.header.frame_id)?;
        let goal: Pose<Map, Goal, f64> = pose_of(&message.pose)?;
        let wall = self.pilot.wall_before(goal).copied();
        let before = self.pilot.go(goal)?;
        self.finish(before);
        self.say(&format!("to ({:.3}, {:.3}) facing {:.1}°", goal.x, goal.y, goal.heading.degrees()));
        if let Some(wall) = wall {
            let (a, b) = (wall.start, wall.end);
            self.say(&format!(
                "warning: the wall from ({}, {}) to ({}, {}) stands between robot and goal: the law does not go round \
                 obstacles, and the robot will stop before it",
                a.x, a.y, b.x, b.y
            ));
        }
        Ok(())
    }

    /// Somebody says where the robot is: RViz's "2D Pose Estimate".
    fn told(&mut self, told: &PoseWithCovarianceStamped) -> Result<(), (&'static str, Refused)> {
        let refused = |why| ("initialpose", why);
        self.in_map(&told.header.frame_id).map_err(refused)?;
        let belief = belief_of(&told.pose, START_STD).map_err(refused)?;
        self.pilot.place(Stamped::new(stamp_of(told.header.stamp), belief));
        let (pose, heading) = (belief.pose, belief.pose.heading.degrees());
        self.say(&format!("told to be at ({:.3}, {:.3}) facing {heading:.1}°", pose.x, pose.y));
        Ok(())
    }

    fn lost(&mut self, request: RmwRequestId, ears: &Ears) {
        self.pilot.lose();
        ears.answer(request);
        self.say("told to find out where it is");
    }

    fn in_map(&self, frame: &str) -> Result<(), Refused> {
        let wanted = &self.settings.map_frame;
        let known = frame.is_empty() || frame.trim_start_matches('/') == wanted;
        let wrong = || Refused::WrongFrame { wanted: wanted.clone(), got: frame.escape_debug().to_string() };
        if known { Ok(()) } else { Err(wrong()) }
    }

    async fn feed_back(&mut self, report: &Report) {
        let (Some(navigation), Some(goal)) = (report.navigation, self.pilot.goal()) else { return };
        let controller = self.pilot.controller();
        let goal_from_body = goal.inverse() * report.belief.pose;
        let least = fastest(goal_from_body, &controller.drive, controller.limits.wheel_speed).time;
        self.action.feed_back(report, navigation.rho, least, &self.settings.map_frame).await;
    }

    /// A goal is over.
    fn finish(&mut self, ended: Option<Ended>) {
        let Some(ended) = ended else { return };
        match ended {
            Ended::Reached => {}
            Ended::Cancelled => self.say("the goal is given up"),
            Ended::Preempted => self.say("another goal takes its place"),
            Ended::Stopped(reason) => self.say(&format!("the goal is given up: {reason}")),
        }
        if let Some(delivery) = self.action.ended(ended) {
            self.deliveries.push(Delivery::made(delivery));
        }
    }

    fn beat(&mut self) {
        self.beats = self.beats.wrapping_add(1);
        let age = self.age();
        let (must_rest, ended) = self.pilot.miss(age);
        if must_rest {
            self.stand();
        }
        self.finish(ended);
        if self.beats.is_multiple_of(DIAGNOSIS) {
            let array = self.diagnosis.array(&self.pilot, age);
            self.voice.diagnose(array);
        }
    }

    /// How long ago odometry last came, by the clock on the wall \[s]. A robot whose odometry never came is as silent as one
    /// whose odometry stopped.
    fn age(&mut self) -> f64 {
        self.last_rolled.get_or_insert_with(Instant::now).elapsed().as_secs_f64()
    }

    /// Tells the wheels to rest, as of what the clock that stamps odometry shows, if that goes as fast as the one on the wall:
    /// a base takes no command of long ago. Before the first odometry the stamp is zero, which bases take for now.
    fn stand(&mut self) {
        let (last, age) = (self.pilot.belief_stamp(), self.age());
        let now = if last == Stamp::default() { last } else { last.after(age) };
        self.voice.command(now, Twist::rest());
    }

    fn say(&mut self, what: &str) {
        (self.say)(what);
    }
}
