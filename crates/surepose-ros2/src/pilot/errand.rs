//! One goal on its way: the closed loop, what the supervisor leaves of it, and how it ends.

use surepose::closed_loop::Controller;
use surepose::closed_loop::{Progress, Sensed, Tick, tick};
use surepose::{Goal, Map, Navigation, Phase, Pose, Twist, Wall};
use surepose_lab::drive::Guard;
use surepose_lab::rig::{Localisation, Watch};
use surepose_sim::Arena;

pub(super) use surepose_lab::drive::PATIENCE;

/// How an errand ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The robot rests at the goal, as far as it knows.
    Reached,
    /// Somebody gave it up.
    Cancelled,
    /// Another goal took its place.
    Preempted,
    /// The robot was stopped, for this reason.
    Stopped(&'static str),
}

/// A goal, and how far the robot is with it.
#[derive(Clone, Debug)]
pub(super) struct Errand {
    goal: Pose<Map, Goal, f64>,
    progress: Progress<f64>,
    guard: Guard,
    has_arrived: bool,
}

/// What one tick of an errand says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Driven {
    pub(super) command: Twist<f64>,
    /// The goal as it was seen.
    pub(super) navigation: Navigation<f64>,
    /// Said once.
    pub(super) ended: Option<Ended>,
}

impl Errand {
    /// To `goal`, from rest.
    pub(super) fn to(goal: Pose<Map, Goal, f64>) -> Self {
        Self { goal, progress: Progress::fresh(), guard: Guard::default(), has_arrived: false }
    }

    /// The goal.
    pub(super) fn goal(&self) -> Pose<Map, Goal, f64> {
        self.goal
    }

    /// Whether it was at the goal already.
    pub(super) fn has_arrived(&self) -> bool {
        self.has_arrived
    }

    /// The pose was set anew: what is remembered of how the goal was seen is worth nothing.
    pub(super) fn forget(&mut self) {
        self.progress = Progress { granted: self.progress.granted, ..Progress::fresh() };
        self.guard = Guard::default();
    }

    /// One tick of the closed loop.
    pub(super) fn tick(
        &mut self,
        controller: &Controller<f64>,
        localiser: &mut Localisation,
        walls: &[Wall<f64>],
        arena: Option<&Arena>,
        sensed: &Sensed<'_, f64>,
        watch: &mut Watch,
    ) -> Driven {
        let last = self.progress.granted;
        let Tick { belief, step, .. } =
            tick(controller, localiser, walls, self.progress, sensed, self.goal, watch);
        let now = sensed.stamp.seconds();
        let verdict = watch.verdict(sensed.stamp, &belief);
        let mut step = self.guard.allow(verdict, controller, step, last, now, arena.is_some());
        if let Some(arena) = arena {
            step = self.guard.keep_off_walls(arena, belief.pose, controller, step, last);
        }
        self.progress = step.progress;
        Driven { command: step.granted, navigation: step.navigation, ended: self.ended(controller, now) }
    }

    fn ended(&mut self, controller: &Controller<f64>, now: f64) -> Option<Ended> {
        if let Some(reason) = self.guard.gave_up(now) {
            return Some(Ended::Stopped(reason.name()));
        }
        let rests = self.progress.granted == Twist::rest();
        if self.guard.is_walled() && rests {
            return Some(Ended::Stopped("wall"));
        }
        let is_there = self.progress.arrival.phase(&controller.tolerance) == Phase::Reached && rests;
        let arrives = is_there && !self.has_arrived;
        self.has_arrived |= is_there;
        arrives.then_some(Ended::Reached)
    }
}
