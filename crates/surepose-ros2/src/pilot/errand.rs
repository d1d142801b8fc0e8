//! One goal on its way: the closed loop, what the supervisor leaves of it, and how it ends.

use surepose::closed_loop::Controller;
use surepose::closed_loop::{Progress, Sensed, Tick, tick};
use surepose::{Goal, Map, Navigation, Phase, Pose, Stamp, Twist, Wall};
use surepose_lab::drive::{Guard, told};
use surepose_lab::rig::{Localisation, Watch};

use super::surroundings::Surroundings;

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

/// Why a robot waits that knows where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// Something that is on no map stands in its way.
    Obstacle,
    /// It is to look out for what stands in its way, and its laser says nothing.
    LaserSilent,
}

impl Hindrance {
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
pub(super) struct Errand {
    goal: Pose<Map, Goal, f64>,
    progress: Progress<f64>,
    guard: Guard,
    /// Since when it may not go on \[s], and why.
    blocked: Option<(f64, Hindrance)>,
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
    /// To `goal`, with wheels that were told `last`.
    pub(super) fn to(goal: Pose<Map, Goal, f64>, last: Twist<f64>) -> Self {
        let progress = Progress { granted: last, ..Progress::fresh() };
        Self { goal, progress, guard: Guard::default(), blocked: None, has_arrived: false }
    }

    /// What the wheels were told last.
    pub(super) fn granted(&self) -> Twist<f64> {
        self.progress.granted
    }

    /// The goal.
    pub(super) fn goal(&self) -> Pose<Map, Goal, f64> {
        self.goal
    }

    /// What it waits for, if it does.
    pub(super) fn hindrance(&self) -> Option<Hindrance> {
        self.blocked.map(|(_, hindrance)| hindrance)
    }

    /// Whether it was at the goal already.
    pub(super) fn has_arrived(&self) -> bool {
        self.has_arrived
    }

    /// The pose was set anew: what is remembered of how the goal was seen is worth nothing.
    pub(super) fn forget(&mut self) {
        *self = Self { has_arrived: self.has_arrived, ..Self::to(self.goal, self.granted()) };
    }

    /// The wheels were told to rest meanwhile.
    pub(super) fn stand(&mut self) {
        *self = Self { has_arrived: self.has_arrived, ..Self::to(self.goal, Twist::rest()) };
    }

    /// One tick of the closed loop: where the robot is, and what the law and the limits would do.
    pub(super) fn think(
        &self,
        controller: &Controller<f64>,
        localiser: &mut Localisation,
        walls: &[Wall<f64>],
        sensed: &Sensed<'_, f64>,
        watch: &mut Watch,
    ) -> Tick<f64> {
        tick(controller, localiser, walls, self.progress, sensed, self.goal, watch)
    }

    /// What is done of that at `stamp`: what the supervisor lets pass, and what stands around.
    pub(super) fn drive(
        &mut self,
        ticked: &Tick<f64>,
        stamp: Stamp,
        controller: &Controller<f64>,
        surroundings: &Surroundings,
        watch: &Watch,
    ) -> Driven {
        let Surroundings { arena, lookout, .. } = surroundings;
        let Tick { belief, step, .. } = *ticked;
        let (last, now) = (self.progress.granted, stamp.seconds());
        let verdict = watch.verdict(stamp, &belief);
        let mut step = self.guard.allow(verdict, controller, step, last, now, arena.is_some());
        if let Some(arena) = arena {
            step = self.guard.keep_off_walls(arena, belief.pose, controller, step, last);
        }
        let hindrance = if arena.is_some() && lookout.is_blind(stamp) {
            Some(Hindrance::LaserSilent)
        } else {
            let is_blocked = lookout.is_blocked(belief.pose, step.granted, controller);
            is_blocked.then_some(Hindrance::Obstacle)
        };
        if hindrance.is_some() {
            step = told(Twist::rest(), controller, step, last);
        }
        let since = self.blocked.map_or(now, |(since, _)| since);
        self.blocked = hindrance.map(|hindrance| (since, hindrance));
        self.progress = step.progress;
        Driven { command: step.granted, navigation: step.navigation, ended: self.ended(controller, now) }
    }

    fn ended(&mut self, controller: &Controller<f64>, now: f64) -> Option<Ended> {
        if let Some(reason) = self.guard.gave_up(now) {
            return Some(Ended::Stopped(reason.name()));
        }
        if let Some((since, hindrance)) = self.blocked
            && now - since >= PATIENCE
        {
            return Some(Ended::Stopped(hindrance.name()));
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
