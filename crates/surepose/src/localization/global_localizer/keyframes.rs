//! Keyframes: a few scans from different headings, so that scans before a turn still contribute.

use crate::estimation::{Belief, Ekf, PoseMeasurement, WheelOdometry};
use crate::geometry::{Body, Map, Point, Pose};
use crate::kinematics::Integration;
use crate::lidar::{BeamStats, BeamSubset, PoseNormalEquations};
use crate::linalg::Covariance;
use crate::map::Wall;
use crate::scalar::Float;

/// Number of beams of a keyframe; a plate 15° wide has at least five.
pub(super) const BEAMS: usize = 64;

/// Minimum turn \[rad] or displacement \[m] of the robot between keyframes.
const MIN_ROTATION: f64 = 0.25;
const MIN_TRANSLATION: f64 = 0.4;

/// Standard deviation of the present pose in addition to odometry drift: x, y \[m] and heading \[rad].
const POSE_STD: [f64; 3] = [0.02, 0.02, 0.006];

/// Odometry drift \[m], \[rad] beyond which the path back is realigned scan by scan.
const REALIGN_DRIFT: (f64, f64) = (0.03, 0.012);

/// Odometry drift \[m], \[rad] beyond which scans are no longer registered with each other.
const MAX_DRIFT: (f64, f64) = (0.15, 0.06);

/// Ring buffer of keyframes.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeyframeBuffer<S, const FRAMES: usize> {
    /// The next keyframe is stored at `next`.
    keyframes: [Option<Keyframe<S>>; FRAMES],
    next: usize,
    /// Absolute turn of the robot since the first keyframe \[rad]; both directions add up.
    rotation: S,
}

#[derive(Clone, Copy, Debug)]
struct Keyframe<S> {
    beams: BeamSubset<S, BEAMS>,
    /// Pose of the robot at the keyframe, relative to the present pose.
    now_from_then: Pose<Body, Body, S>,
    /// Odometry drift since the keyframe, and from it to the next keyframe.
    drift: OdometryDrift<S>,
    link: OdometryDrift<S>,
}

/// Variances of the position, along each axis \[m²], and of the heading \[rad²].
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

    /// Adds the drift of `step` at the distance `away` \[m]: a heading error also displaces the keyframe.
    fn grown(self, step: Self, away: S) -> Self {
        self.plus(Self { position: step.position + step.heading * away.squared(), heading: step.heading })
    }

    fn exceeds(&self, (position, heading): (f64, f64)) -> bool {
        self.position > S::from_f64(position).squared() || self.heading > S::from_f64(heading).squared()
    }

    /// Covariance including the uncertainty of the pose itself.
    fn covariance(&self) -> Covariance<S, 3> {
        let [x, y, heading] = POSE_STD.map(|off| S::from_f64(off).squared());
        Covariance::from_variances([x + self.position, y + self.position, heading + self.heading])
    }
}

impl<S: Float, const FRAMES: usize> KeyframeBuffer<S, FRAMES> {
    pub(super) fn new() -> Self {
        Self { keyframes: [None; FRAMES], next: 0, rotation: S::from_f64(0.0) }
    }

    /// Updates the relative poses and the drift by odometry.
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

    /// Ring index of the keyframe before the last `ago` ones.
    fn slot_of(&self, ago: usize) -> usize {
        (self.next + 2 * FRAMES - 1 - ago) % FRAMES
    }

    /// Absolute turn of the robot since the first keyframe \[rad].
    pub(super) fn rotation(&self) -> S {
        self.rotation
    }

    /// Stores the present scan if it differs enough from the last keyframe; returns whether it was stored.
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

    /// Keyframes within the drift limit.
    fn well_registered(&self) -> impl Iterator<Item = &Keyframe<S>> {
        self.keyframes.iter().flatten().filter(|keyframe| !keyframe.drift.exceeds(MAX_DRIFT))
    }

    /// End points of their beams in the present body frame.
    pub(super) fn endpoints(&self) -> impl Iterator<Item = Point<Body, S>> + '_ {
        self.well_registered()
            .flat_map(|keyframe| keyframe.beams.endpoints().map(|end| keyframe.now_from_then * end))
    }

    /// Adds their information on a robot near `pose` to `equations`.
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

    /// Measurements of the present pose from each keyframe, linearized near the belief and inflated by the odometry
    /// drift.
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

    /// Agreement of the keyframes with the map if the robot is at `pose` now.
    ///
    /// The path is followed backward from keyframe to keyframe. Where the drift since the last alignment exceeds the
    /// limit, the keyframe itself is aligned with the map within the drift. The correction counts as misfit. The path
    /// may therefore be long, and a wrong pose still misfits.
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
