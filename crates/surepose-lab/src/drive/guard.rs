//! What the supervisor, and walls ahead, leave of what the controller wants.

use surepose::closed_loop::{Controller, Progress, Step};
use surepose::{Body, Map, Pose, Reason, Twist, Verdict};
use surepose_sim::Arena;

use super::lookout::is_blocked;
use crate::rig::SEARCH_RATE;

/// A drive that the supervisor has stopped for so long \[s] is over.
pub const PATIENCE: f64 = 10.0;

/// How long the supervisor has held the robot, and why.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guard {
    held: Option<(Reason, f64)>,
    /// A wall stood in the way: the drive brakes and is over.
    walled: bool,
}

impl Guard {
    /// `step`, as far as `verdict` allows it at time `now` \[s], after the wheels were told `last`.
    ///
    /// Wheels slow down and stop as hard as they can, and no harder. A robot that is lost turns in place if it `can_look`: what it sees may tell it where it is.
    pub fn allow(
        &mut self,
        verdict: Verdict,
        controller: &Controller<f64>,
        step: Step<f64>,
        last: Twist<f64>,
        now: f64,
        can_look: bool,
    ) -> Step<f64> {
        self.held = match (verdict, self.held) {
            (Verdict::Stop(reason), Some((_, since))) => Some((reason, since)),
            (Verdict::Stop(reason), None) => Some((reason, now)),
            _ => None,
        };
        let allowed = match verdict {
            Verdict::Go => return step,
            Verdict::Stop(Reason::Lost) if can_look => Twist::new(0.0, SEARCH_RATE),
            _ => step.granted.scaled(verdict.pace()),
        };
        // What the law remembers of a goal seen from a wrong place is worth nothing.
        let remembered = if self.held.is_some() { Progress::fresh() } else { step.progress };
        told(allowed, controller, Step { progress: remembered, ..step }, last)
    }

    /// `step`, unless a robot at `pose` would come too near to a wall: then it brakes, for good.
    pub fn keep_off_walls(
        &mut self,
        arena: &Arena,
        pose: Pose<Map, Body, f64>,
        controller: &Controller<f64>,
        step: Step<f64>,
        last: Twist<f64>,
    ) -> Step<f64> {
        self.walled |= is_blocked(arena, pose, step.granted, controller);
        if self.walled { told(Twist::rest(), controller, step, last) } else { step }
    }

    /// Whether the robot brakes, or has braked, before a wall.
    pub fn is_walled(&self) -> bool {
        self.walled
    }

    /// Why the drive is over, where it is.
    pub fn gave_up(&self, now: f64) -> Option<Reason> {
        self.held.filter(|(_, since)| now - since >= PATIENCE).map(|(reason, _)| reason)
    }
}

/// `step` with what the wheels can do of `wanted`, having done `last`.
pub fn told(
    wanted: Twist<f64>,
    controller: &Controller<f64>,
    step: Step<f64>,
    last: Twist<f64>,
) -> Step<f64> {
    let granted = controller.limits.grant(&controller.drive, wanted, last, controller.period);
    let wheels = controller.drive.rates_from_twist(granted);
    Step { granted, wheels, progress: Progress { granted, ..step.progress }, ..step }
}
