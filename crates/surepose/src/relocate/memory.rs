//! Scans to remember: a few, from different headings, so that what was seen before a turn still counts after it.

use crate::covariance::Covariance;
use crate::drive::Integration;
use crate::estimate::{Belief, Ekf, Travel};
use crate::frame::{Body, Map};
use crate::laser::{Agreement, Glance, Pull, Wall};
use crate::pose::{Point, Pose};
use crate::scalar::Float;

/// Beams of a scan that are looked at: enough that a plate 15° wide counts five.
pub(super) const BEAMS: usize = 64;

/// How many scans are remembered.
const MOST_FRAMES: usize = 12;

/// A scan is worth remembering where the robot turned \[rad] or moved \[m] by this much since the last one.
const TURN: f64 = 0.25;
const STEP: f64 = 0.3;

/// How far the pose of now may be off, on top of what odometry may have drifted since: x, y \[m] and heading \[rad].
const OFF: [f64; 3] = [0.02, 0.02, 0.006];

/// The last scans that differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory<S> {
    /// A ring: the next scan goes to `next`.
    frames: [Option<Frame<S>>; MOST_FRAMES],
    next: usize,
    /// How far the robot turned meanwhile, there and back counting twice \[rad].
    turned: S,
}

#[derive(Clone, Copy, Debug)]
struct Frame<S> {
    glance: Glance<S, BEAMS>,
    /// Where the robot was then, seen from where it is now.
    now_from_then: Pose<Body, Body, S>,
    /// The variances of what odometry says since then: x, y \[m²] and heading \[rad²].
    drift: [S; 3],
}

impl<S: Float> Memory<S> {
    pub(super) fn empty() -> Self {
        Self { frames: [None; MOST_FRAMES], next: 0, turned: S::of(0.0) }
    }

    /// The robot moved on.
    pub(super) fn roll(&mut self, ekf: &Ekf<S>, travel: &Travel<S>) {
        let motion = ekf.drive.motion_from_travel(travel.rims);
        let step = ekf.predict(Belief::new(Pose::identity(), [S::of(0.0); 3]), *travel).covariance;
        let (place, turn) = (step.entry(0, 0).max(step.entry(1, 1)), step.entry(2, 2));
        self.turned = self.turned + motion.turn.abs();
        let then_from_now = Pose::identity().moved(motion, Integration::Arc);
        let now_from_then = then_from_now.inverse();
        for frame in self.frames.iter_mut().flatten() {
            frame.now_from_then = now_from_then * frame.now_from_then;
            let swing =
                turn * frame.now_from_then.origin().distance(Point::new(S::of(0.0), S::of(0.0))).squared();
            let [x, y, heading] = frame.drift;
            frame.drift = [x + place + swing, y + place + swing, heading + turn];
        }
    }

    /// How far the robot turned since the first scan \[rad].
    pub(super) fn turned(&self) -> S {
        self.turned
    }

    /// Keeps the scan of now, if it shows something else than the last one that was kept; whether it did.
    pub(super) fn keep(&mut self, glance: &Glance<S, BEAMS>) -> bool {
        let last = self.frames[(self.next + MOST_FRAMES - 1) % MOST_FRAMES];
        let is_new = last.is_none_or(|last| {
            let way = last.now_from_then;
            way.heading.radians().abs() > S::of(TURN)
                || way.origin().distance(Pose::<Body, Body, S>::identity().origin()) > S::of(STEP)
        });
        if is_new {
            self.frames[self.next] = Some(Frame {
                glance: *glance,
                now_from_then: Pose::identity(),
                drift: OFF.map(|off| S::of(off).squared()),
            });
            self.next = (self.next + 1) % MOST_FRAMES;
        }
        is_new
    }

    /// Where all remembered beams ended, seen from where the robot is now.
    pub(super) fn ends(&self) -> impl Iterator<Item = Point<Body, S>> + '_ {
        let frames = self.frames.iter().flatten();
        frames.flat_map(|frame| frame.glance.ends().map(|end| frame.now_from_then * end))
    }

    /// What the remembered scans say of a robot near `pose`, added to `pull`.
    pub(super) fn pull(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
        pull: &mut Pull<S>,
    ) {
        for frame in self.frames.iter().flatten() {
            let then = pose * frame.now_from_then;
            let _judged_elsewhere = frame.glance.pulled_from(then, covariance, walls, pose.origin(), pull);
        }
    }

    /// How the remembered scans agree with the map if the robot is at `pose` now.
    pub(super) fn agreement(&self, pose: Pose<Map, Body, S>, walls: &[Wall<S>]) -> Agreement<S> {
        self.frames.iter().flatten().fold(Agreement::default(), |sum, frame| {
            let drift = Covariance::from_variances(frame.drift);
            sum.plus(&frame.glance.from(pose * frame.now_from_then, &drift, walls))
        })
    }
}
