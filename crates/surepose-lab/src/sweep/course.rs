//! One trial under way: the true pose, what the law remembers, and what it is judged by, over any scalar.

use surepose::{Body, Goal, Integration, Map, Mask, Memory, Navigation, Pose, Scalar, Wheels};

use super::bench::{Bench, Disturbance};

/// The goal: the map's own origin.
const POSITION_TOLERANCE: f64 = 0.01;
const HEADING_TOLERANCE: f64 = core::f64::consts::PI / 180.0;
/// How long the pose must be held \[s].
const HOLD: f64 = 1.0;
/// A reversal counts once the robot has travelled so far in its new direction \[m]: half the position tolerance, so that a
/// cusp of the path counts, and trembling on the spot does not.
const CUSP: f64 = 0.005;

/// What a trial has come to so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Score<S> {
    /// Time since the start \[s].
    pub(super) time: S,
    /// Way of the robot's middle \[m].
    pub(super) path: S,
    /// Reversals of its travel.
    pub(super) cusps: S,
}

impl<S: Scalar> Score<S> {
    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        Self {
            time: S::select(mask, yes.time, no.time),
            path: S::select(mask, yes.path, no.path),
            cusps: S::select(mask, yes.cusps, no.cusps),
        }
    }
}

/// One trial under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<S: Scalar> {
    /// The true pose.
    pub(super) pose: Pose<Map, Body, S>,
    memory: Memory<S>,
    now: Score<S>,
    /// When the robot came inside the tolerance, in which it has been since.
    pub(super) entered: Score<S>,
    inside: S::Mask,
    travel: Travel<S>,
}

/// Where the robot is along its own path, forward positive, and where it last turned back.
#[derive(Clone, Copy, Debug)]
struct Travel<S> {
    at: S,
    /// The farthest point in the present direction.
    farthest: S,
    /// The present direction: ±1, or 0 before there is one.
    direction: S,
}

impl<S: Scalar> Course<S> {
    pub(super) fn new(pose: Pose<Map, Body, S>) -> Self {
        let zero = S::of(0.0);
        let nothing = Score { time: zero, path: zero, cusps: zero };
        let course = Self {
            pose,
            memory: Memory::fresh(),
            now: nothing,
            entered: nothing,
            inside: S::Mask::splat(false),
            travel: Travel { at: zero, farthest: zero, direction: zero },
        };
        course.judged()
    }

    /// Notes whether the pose is inside the tolerance, and since when.
    fn judged(mut self) -> Self {
        let squared = self.pose.x.squared() + self.pose.y.squared();
        let close = !S::of(POSITION_TOLERANCE * POSITION_TOLERANCE).lt(squared);
        let turned = !S::of(HEADING_TOLERANCE).lt(self.pose.heading.radians().abs());
        let inside = close.and(turned);
        self.entered = Score::select(inside.and(self.inside), self.entered, self.now);
        self.inside = inside;
        self
    }

    /// Where the pose has been held for long enough.
    pub(super) fn is_done(&self, period: S) -> S::Mask {
        // Half a period covers the rounding of the sum of periods.
        let held = self.now.time - self.entered.time + period * S::of(0.5);
        self.inside.and(!held.lt(S::of(HOLD)))
    }

    /// The course one period later.
    pub(super) fn after(mut self, bench: &Bench<S>, off: &Disturbance<S>) -> Self {
        let seen = Pose::new(self.pose.x + off.x, self.pose.y + off.y, self.pose.heading.turned(off.heading));
        let goal: Pose<Map, Goal, S> = Pose::identity();
        let decision = bench.law.decide(&Navigation::of(seen, goal), self.memory);
        self.memory = decision.memory;

        let granted = bench.limits.within_speed(&bench.drive, decision.twist);
        let rims = bench.drive.rims_from_twist(granted);
        let turning = Wheels::new(rims.right * off.wheels.right, rims.left * off.wheels.left);
        let motion = bench.drive.twist_from_rims(turning).over(bench.period);
        self.pose = self.pose.moved(motion, Integration::Arc);

        let (travel, reversed) = self.travel.by(motion.length);
        self.travel = travel;
        self.now = Score {
            time: self.now.time + bench.period,
            path: self.now.path + motion.length.abs(),
            cusps: self.now.cusps + S::select(reversed, S::of(1.0), S::of(0.0)),
        };
        self.judged()
    }
}

impl<S: Scalar> Travel<S> {
    /// The travel after `length` \[m] more, and whether that makes a cusp.
    fn by(self, length: S) -> (Self, S::Mask) {
        let at = self.at + length;
        let ahead = (at - self.farthest) * self.direction;
        let first = self.direction.abs().lt(S::of(0.5)).and(S::of(CUSP).lt(at.abs()));
        let reversed = ahead.lt(S::of(-CUSP));
        let turned = first.or(reversed);
        let direction = S::select(turned, (at - self.farthest).sign(), self.direction);
        let farthest = S::select(turned.or(ahead.gt(S::of(0.0))), at, self.farthest);
        (Self { at, farthest, direction }, reversed)
    }
}

#[cfg(test)]
mod tests {
    use super::Travel;

    fn cusps(lengths: &[f64]) -> usize {
        let mut travel = Travel { at: 0.0, farthest: 0.0, direction: 0.0 };
        let mut count = 0;
        for length in lengths {
            let (next, reversed) = travel.by(*length);
            travel = next;
            count += usize::from(reversed);
        }
        count
    }

    #[test]
    fn a_cusp_is_a_reversal_that_is_driven() {
        assert_eq!(cusps(&[0.1; 20]), 0);
        assert_eq!(cusps(&[0.1, 0.1, -0.1, -0.1]), 1);
        assert_eq!(cusps(&[0.1, -0.1, 0.1, -0.1]), 3);
        // Trembling is none, however long; neither is the start's.
        assert_eq!(cusps(&[0.002, -0.002].repeat(100)), 0);
        assert_eq!(cusps(&[-0.1, 0.003, -0.003, -0.1]), 0);
        // Small steps add up.
        let (there, back) = ([0.001; 50], [-0.001; 50]);
        assert_eq!(cusps(&[there, back].concat()), 1);
    }
}
