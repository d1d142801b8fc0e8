//! Scans to remember: a few, from different headings, so that what was seen before a turn still counts after it.

use crate::covariance::Covariance;
use crate::drive::Integration;
use crate::estimate::{Belief, Ekf, PoseFix, Travel};
use crate::frame::{Body, Map};
use crate::laser::{Agreement, Glance, Pull, Wall};
use crate::pose::{Point, Pose};
use crate::scalar::Float;

/// Beams of a scan that are looked at: enough that a plate 15° wide counts five.
pub(super) const BEAMS: usize = 64;

/// A scan is worth remembering where the robot turned \[rad] or moved \[m] by this much since the last one.
const TURN: f64 = 0.25;
const STEP: f64 = 0.4;

/// How far the pose of now may be off, on top of what odometry may have drifted since: x, y \[m] and heading \[rad].
const OFF: [f64; 3] = [0.02, 0.02, 0.006];

/// Odometry that drifted by more than this \[m], \[rad] is put right on the way back, scan by scan.
const DRIFTED: (f64, f64) = (0.03, 0.012);

/// Odometry that drifted by more than this \[m], \[rad] lays scans on each other no longer.
const BLURRED: (f64, f64) = (0.15, 0.06);

/// The last scans that differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory<S, const FRAMES: usize> {
    /// A ring: the next scan goes to `next`.
    frames: [Option<Frame<S>>; FRAMES],
    next: usize,
    /// How far the robot turned meanwhile, there and back counting twice \[rad].
    turned: S,
}

#[derive(Clone, Copy, Debug)]
struct Frame<S> {
    glance: Glance<S, BEAMS>,
    /// Where the robot was then, seen from where it is now.
    now_from_then: Pose<Body, Body, S>,
    /// What odometry may have drifted since then, and until the next one of these scans.
    drift: Drift<S>,
    link: Drift<S>,
}

/// Variances of the place, along each axis \[m²], and of the heading \[rad²].
#[derive(Clone, Copy, Debug)]
struct Drift<S> {
    place: S,
    heading: S,
}

impl<S: Float> Drift<S> {
    fn none() -> Self {
        Self { place: S::of(0.0), heading: S::of(0.0) }
    }

    fn plus(self, other: Self) -> Self {
        Self { place: self.place + other.place, heading: self.heading + other.heading }
    }

    /// More of it, on the way from a scan so far away: what the heading is off by swings the place.
    fn grown(self, step: Self, away: S) -> Self {
        self.plus(Self { place: step.place + step.heading * away.squared(), heading: step.heading })
    }

    fn exceeds(&self, (place, heading): (f64, f64)) -> bool {
        self.place > S::of(place).squared() || self.heading > S::of(heading).squared()
    }

    /// With what the pose itself may be off by.
    fn covariance(&self) -> Covariance<S, 3> {
        let [x, y, heading] = OFF.map(|off| S::of(off).squared());
        Covariance::from_variances([x + self.place, y + self.place, heading + self.heading])
    }
}

impl<S: Float, const FRAMES: usize> Memory<S, FRAMES> {
    pub(super) fn empty() -> Self {
        Self { frames: [None; FRAMES], next: 0, turned: S::of(0.0) }
    }

    /// The robot moved on.
    pub(super) fn roll(&mut self, ekf: &Ekf<S>, travel: &Travel<S>) {
        let motion = ekf.drive.motion_from_travel(travel.rims);
        let step = ekf.predict(Belief::new(Pose::identity(), [S::of(0.0); 3]), *travel).covariance;
        let step = Drift { place: step.entry(0, 0).max(step.entry(1, 1)), heading: step.entry(2, 2) };
        self.turned = self.turned + motion.turn.abs();
        let then_from_now = Pose::identity().moved(motion, Integration::Arc);
        let now_from_then = then_from_now.inverse();
        let newest = self.place_of(0);
        for (place, slot) in self.frames.iter_mut().enumerate() {
            let Some(frame) = slot else { continue };
            frame.now_from_then = now_from_then * frame.now_from_then;
            let away = frame.now_from_then.origin().distance(Pose::<Body, Body, S>::identity().origin());
            frame.drift = frame.drift.grown(step, away);
            if place == newest {
                frame.link = frame.link.grown(step, away);
            }
        }
    }

    /// Where in the ring the scan is that was kept so many scans ago.
    fn place_of(&self, ago: usize) -> usize {
        (self.next + 2 * FRAMES - 1 - ago) % FRAMES
    }

    /// How far the robot turned since the first scan \[rad].
    pub(super) fn turned(&self) -> S {
        self.turned
    }

    /// Keeps the scan of now, if it shows something else than the last one that was kept; whether it did.
    pub(super) fn keep(&mut self, glance: &Glance<S, BEAMS>) -> bool {
        let last = self.frames[self.place_of(0)];
        let is_new = last.is_none_or(|last| {
            let way = last.now_from_then;
            way.heading.radians().abs() > S::of(TURN)
                || way.origin().distance(Pose::<Body, Body, S>::identity().origin()) > S::of(STEP)
        });
        if is_new {
            self.frames[self.next] = Some(Frame {
                glance: *glance,
                now_from_then: Pose::identity(),
                drift: Drift::none(),
                link: Drift::none(),
            });
            self.next = (self.next + 1) % FRAMES;
        }
        is_new
    }

    /// The scans that odometry still lays on each other.
    fn sharp(&self) -> impl Iterator<Item = &Frame<S>> {
        self.frames.iter().flatten().filter(|frame| !frame.drift.exceeds(BLURRED))
    }

    /// Where their beams ended, seen from where the robot is now.
    pub(super) fn ends(&self) -> impl Iterator<Item = Point<Body, S>> + '_ {
        self.sharp().flat_map(|frame| frame.glance.ends().map(|end| frame.now_from_then * end))
    }

    /// What they say of a robot near `pose`, added to `pull`.
    pub(super) fn pull(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
        pull: &mut Pull<S>,
    ) {
        for frame in self.sharp() {
            let then = pose * frame.now_from_then;
            let _judged_elsewhere = frame.glance.pulled_from(then, covariance, walls, pose.origin(), pull);
        }
    }

    /// The pose of now that each asks for, the robot being near what is believed: blurred by what odometry may have drifted
    /// since.
    pub(super) fn fixes<'a>(
        &'a self,
        near: &'a Belief<S>,
        walls: &'a [Wall<S>],
    ) -> impl Iterator<Item = PoseFix<S>> + 'a {
        self.sharp().filter_map(|frame| {
            let (then, center) = (near.pose * frame.now_from_then, near.pose.origin());
            let mut pull = Pull::none();
            let _judged_elsewhere =
                frame.glance.pulled_from(then, &near.covariance, walls, center, &mut pull);
            let Drift { place, heading } = frame.drift;
            Some(pull.fix(near.pose).ok()?.blurred([place, place, heading]))
        })
    }

    /// How the remembered scans agree with the map if the robot is at `pose` now.
    ///
    /// The way is walked back from scan to scan. Where odometry has drifted since the last one that was put right, the
    /// scan itself says where on the map it was taken, as far as odometry lets it, and what odometry was off by counts
    /// as misfit: so the way may be long, and a place where nothing fits that way is none.
    pub(super) fn agreement(
        &self,
        ekf: &Ekf<S>,
        pose: Pose<Map, Body, S>,
        walls: &[Wall<S>],
    ) -> Agreement<S> {
        let mut sum = Agreement::default();
        let (mut at, mut drift) = (pose, Drift::none());
        let mut now_from_at = Pose::identity();
        for frame in (0..FRAMES).filter_map(|ago| self.frames[self.place_of(ago)].as_ref()) {
            at = at * (now_from_at.inverse() * frame.now_from_then);
            now_from_at = frame.now_from_then;
            drift = drift.plus(frame.link);
            let mut belief = Belief { pose: at, covariance: drift.covariance() };
            if drift.exceeds(DRIFTED) {
                let (_before, fix) = frame.glance.fix(&belief, walls);
                if let Ok(fix) = fix {
                    let there = ekf.correct(belief, &fix.innovation(&belief), S::of(f64::MAX)).belief;
                    sum.misfit = sum.misfit + belief.covariance.mahalanobis_squared(belief.error(there.pose));
                    (at, drift) = (there.pose, Drift::none());
                    belief = Belief { pose: at, covariance: drift.covariance() };
                }
            }
            sum = sum.plus(&frame.glance.from(belief.pose, &belief.covariance, walls));
        }
        sum
    }
}
