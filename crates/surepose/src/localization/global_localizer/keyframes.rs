//! Scans to remember: a few, from different headings, so that what was seen before a turn still counts after it.

use crate::estimation::{Belief, Ekf, PoseMeasurement, WheelOdometry};
use crate::geometry::{Body, Map, Point, Pose};
use crate::kinematics::Integration;
use crate::lidar::{BeamStats, BeamSubset, PoseNormalEquations};
use crate::linalg::Covariance;
use crate::map::Wall;
use crate::scalar::Float;

/// Beams of a scan that are looked at: enough that a plate 15° wide counts five.
pub(super) const BEAMS: usize = 64;

/// A scan is worth remembering where the robot turned \[rad] or moved \[m] by this much since the last one.
const MIN_ROTATION: f64 = 0.25;
const MIN_TRANSLATION: f64 = 0.4;

/// How far the pose of now may be off, on top of what odometry may have drifted since: x, y \[m] and heading \[rad].
const POSE_STD: [f64; 3] = [0.02, 0.02, 0.006];

/// Odometry that drifted by more than this \[m], \[rad] is put right on the way back, scan by scan.
const REALIGN_DRIFT: (f64, f64) = (0.03, 0.012);

/// Odometry that drifted by more than this \[m], \[rad] lays scans on each other no longer.
const MAX_DRIFT: (f64, f64) = (0.15, 0.06);

/// The last scans that differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeyframeBuffer<S, const FRAMES: usize> {
    /// A ring: the next scan goes to `next`.
    keyframes: [Option<Keyframe<S>>; FRAMES],
    next: usize,
    /// How far the robot turned meanwhile, there and back counting twice \[rad].
    rotation: S,
}

#[derive(Clone, Copy, Debug)]
struct Keyframe<S> {
    beams: BeamSubset<S, BEAMS>,
    /// Where the robot was then, seen from where it is now.
    now_from_then: Pose<Body, Body, S>,
    /// What odometry may have drifted since then, and until the next one of these scans.
    drift: OdometryDrift<S>,
    link: OdometryDrift<S>,
}

/// Variances of the place, along each axis \[m²], and of the heading \[rad²].
#[derive(Clone, Copy, Debug)]
struct OdometryDrift<S> {
    position: S,
    heading: S,
}

impl<S: Float> OdometryDrift<S> {
    fn zero() -> Self {
        Self { position: S::from_f64(0.0), heading: S::from_f64(0.0) }
    }

    fn plus(self, other: Self) -> Self {
        Self { position: self.position + other.position, heading: self.heading + other.heading }
    }

    /// More of it, on the way from a scan so far away: what the heading is off by swings the place.
    fn grown(self, step: Self, away: S) -> Self {
        self.plus(Self { position: step.position + step.heading * away.squared(), heading: step.heading })
    }

    fn exceeds(&self, (position, heading): (f64, f64)) -> bool {
        self.position > S::from_f64(position).squared() || self.heading > S::from_f64(heading).squared()
    }

    /// With what the pose itself may be off by.
    fn covariance(&self) -> Covariance<S, 3> {
        let [x, y, heading] = POSE_STD.map(|off| S::from_f64(off).squared());
        Covariance::from_variances([x + self.position, y + self.position, heading + self.heading])
    }
}

impl<S: Float, const FRAMES: usize> KeyframeBuffer<S, FRAMES> {
    pub(super) fn new() -> Self {
        Self { keyframes: [None; FRAMES], next: 0, rotation: S::from_f64(0.0) }
    }

    /// The robot moved on.
    pub(super) fn on_odometry(&mut self, ekf: &Ekf<S>, travel: &WheelOdometry<S>) {
        let motion = ekf.drive.motion_from_travel(travel.travel);
        let step = ekf.predict(Belief::new(Pose::identity(), [S::from_f64(0.0); 3]), *travel).covariance;
        let step =
            OdometryDrift { position: step.entry(0, 0).max(step.entry(1, 1)), heading: step.entry(2, 2) };
        self.rotation = self.rotation + motion.turn.abs();
        let then_from_now = Pose::identity().integrate(motion, Integration::Arc);
        let now_from_then = then_from_now.inverse();
        let newest = self.slot_of(0);
        for (position, slot) in self.keyframes.iter_mut().enumerate() {
            let Some(keyframe) = slot else { continue };
            keyframe.now_from_then = now_from_then * keyframe.now_from_then;
            let away = keyframe.now_from_then.origin().distance(Pose::<Body, Body, S>::identity().origin());
            keyframe.drift = keyframe.drift.grown(step, away);
            if position == newest {
                keyframe.link = keyframe.link.grown(step, away);
            }
        }
    }

    /// Where in the ring the scan is that was kept so many scans ago.
    fn slot_of(&self, ago: usize) -> usize {
        (self.next + 2 * FRAMES - 1 - ago) % FRAMES
    }

    /// How far the robot turned since the first scan \[rad].
    pub(super) fn rotation(&self) -> S {
        self.rotation
    }

    /// Keeps the scan of now, if it shows something else than the last one that was kept; whether it did.
    pub(super) fn insert_if_new(&mut self, beams: &BeamSubset<S, BEAMS>) -> bool {
        let last = self.keyframes[self.slot_of(0)];
        let is_new = last.is_none_or(|last| {
            let way = last.now_from_then;
            way.heading.radians().abs() > S::from_f64(MIN_ROTATION)
                || way.origin().distance(Pose::<Body, Body, S>::identity().origin())
                    > S::from_f64(MIN_TRANSLATION)
        });
        if is_new {
            self.keyframes[self.next] = Some(Keyframe {
                beams: *beams,
                now_from_then: Pose::identity(),
                drift: OdometryDrift::zero(),
                link: OdometryDrift::zero(),
            });
            self.next = (self.next + 1) % FRAMES;
        }
        is_new
    }

    /// The scans that odometry still lays on each other.
    fn well_registered(&self) -> impl Iterator<Item = &Keyframe<S>> {
        self.keyframes.iter().flatten().filter(|keyframe| !keyframe.drift.exceeds(MAX_DRIFT))
    }

    /// Where their beams ended, seen from where the robot is now.
    pub(super) fn endpoints(&self) -> impl Iterator<Item = Point<Body, S>> + '_ {
        self.well_registered()
            .flat_map(|keyframe| keyframe.beams.endpoints().map(|end| keyframe.now_from_then * end))
    }

    /// What they say of a robot near `pose`, added to `equations`.
    pub(super) fn linearize(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
        equations: &mut PoseNormalEquations<S>,
    ) {
        for keyframe in self.well_registered() {
            let then = pose * keyframe.now_from_then;
            let _stats = keyframe.beams.linearize(then, covariance, walls, pose.origin(), equations);
        }
    }

    /// The pose of now that each asks for, the robot being near what is believed: blurred by what odometry may have
    /// drifted since.
    pub(super) fn pose_measurements<'a>(
        &'a self,
        near: &'a Belief<S>,
        walls: &'a [Wall<S>],
    ) -> impl Iterator<Item = PoseMeasurement<S>> + 'a {
        self.well_registered().filter_map(|keyframe| {
            let (then, center) = (near.pose * keyframe.now_from_then, near.pose.origin());
            let mut equations = PoseNormalEquations::new();
            let _stats = keyframe.beams.linearize(then, &near.covariance, walls, center, &mut equations);
            let OdometryDrift { position, heading } = keyframe.drift;
            Some(equations.solve(near.pose).ok()?.inflated([position, position, heading]))
        })
    }

    /// How the remembered scans agree with the map if the robot is at `pose` now.
    ///
    /// The way is walked back from scan to scan. Where odometry has drifted since the last one that was put right, the
    /// scan itself says where on the map it was taken, as far as odometry lets it, and what odometry was off by counts
    /// as misfit: so the way may be long, and a place where nothing fits that way is none.
    pub(super) fn evaluate(&self, ekf: &Ekf<S>, pose: Pose<Map, Body, S>, walls: &[Wall<S>]) -> BeamStats<S> {
        let mut sum = BeamStats::default();
        let (mut at, mut drift) = (pose, OdometryDrift::zero());
        let mut now_from_at = Pose::identity();
        for keyframe in (0..FRAMES).filter_map(|ago| self.keyframes[self.slot_of(ago)].as_ref()) {
            at = at * (now_from_at.inverse() * keyframe.now_from_then);
            now_from_at = keyframe.now_from_then;
            drift = drift.plus(keyframe.link);
            let mut belief = Belief { pose: at, covariance: drift.covariance() };
            if drift.exceeds(REALIGN_DRIFT) {
                let (_before, fix) = keyframe.beams.measure_pose(&belief, walls);
                if let Ok(fix) = fix {
                    let there = ekf.correct(belief, &fix.innovation(&belief), S::from_f64(f64::MAX)).belief;
                    sum.neg2_log_likelihood = sum.neg2_log_likelihood
                        + belief.covariance.mahalanobis_squared(belief.error(there.pose));
                    (at, drift) = (there.pose, OdometryDrift::zero());
                    belief = Belief { pose: at, covariance: drift.covariance() };
                }
            }
            sum = sum.plus(&keyframe.beams.evaluate(belief.pose, &belief.covariance, walls));
        }
        sum
    }
}
