//! One period of the full loop of every trial: sensors, filter, law and wheels.
//!
//! Encoders read the commanded wheel speeds; the rims deviate from them by the wheels' noise. Encoders
//! predict the belief, rims move the robot. In each period the compass and two walls correct the belief. The
//! filter is that of the core, in lanes: its gate is a mask.

use surepose::estimation::{Belief, HeadingMeasurement, Innovation, LineMeasurement};
use surepose::geometry::{Angle, Body, Line, Map, Pose};
use surepose::kinematics::Twist;
use surepose::linalg::Covariance;
use surepose::scalar::Scalar;
use surepose_simd::{Element, Kernel, dispatch_simd};

use super::belief_batch::{BeliefBatch, OF_COMPASS, OF_WALLS};
use super::bench::{DRIVE, SweepNoise, limits};
use super::filter::{Filter, walls};
use super::phases;
use super::trial_batch::{BatchArray, LaneScalar, TrialBatch};

/// Advances every trial by one `period` \[s].
pub(super) fn step<T: Element>(
    batch: &mut TrialBatch<T>,
    beliefs: &mut BeliefBatch<T>,
    law: &surepose::control::Law<f64>,
    noise: &SweepNoise,
    period: f64,
) {
    dispatch_simd(Draw(batch, beliefs));
    // Without noise the sensors are exact, but the filter assumes their usual noise.
    let real = (*noise != SweepNoise::NONE).then_some(Filter::BENCH);
    dispatch_simd(Correct(batch, beliefs, OfCompass { real }));
    for (wall, deviates) in walls().into_iter().zip(OF_WALLS) {
        dispatch_simd(Correct(batch, beliefs, OfWall { real, wall, deviates }));
    }
    dispatch_simd(Judge(batch, beliefs));
    dispatch_simd(Look(batch, beliefs));
    phases::decide(batch, law);
    phases::drive(batch, Some(noise), period);
    dispatch_simd(Predict(batch, beliefs, period));
    phases::judge(batch);
}

/// Kernel: draws the noise of this period for sensors and wheels.
struct Draw<'a, T: Element>(&'a mut TrialBatch<T>, &'a mut BeliefBatch<T>);

impl<T: Element> Kernel for Draw<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, beliefs) = self;
        batch.streams.normals(&mut beliefs.deviates);
        let [.., right, left] = beliefs.deviates;
        let [.., of_right, of_left] = &mut batch.deviates;
        (*of_right, *of_left) = (right, left);
    }
}

/// True pose, belief, and noise parameters of a measurement.
struct Whereabouts<T: Element> {
    filter: Filter,
    truth: Pose<Map, Body, LaneScalar<T>>,
    belief: Belief<LaneScalar<T>>,
}

/// A sensor with `M` measured values.
trait Sensor<T: Element, const M: usize> {
    /// Returns the innovation of a measurement; `deviate` returns its noise by index.
    fn innovation(
        &self,
        there: &Whereabouts<T>,
        deviate: impl Fn(usize) -> LaneScalar<T>,
    ) -> Innovation<LaneScalar<T>, M>;
}

struct OfCompass {
    real: Option<Filter>,
}

impl<T: Element> Sensor<T, 1> for OfCompass {
    #[inline(always)]
    fn innovation(
        &self,
        there: &Whereabouts<T>,
        deviate: impl Fn(usize) -> LaneScalar<T>,
    ) -> Innovation<LaneScalar<T>, 1> {
        let Whereabouts { filter, truth, belief } = there;
        let std = LaneScalar::from_f64(self.real.map_or(0.0, |real| real.compass_std));
        let heading = truth.heading + Angle::from_radians_unchecked(deviate(OF_COMPASS) * std);
        HeadingMeasurement { heading, std: LaneScalar::from_f64(filter.compass_std) }.innovation(belief)
    }
}

struct OfWall<T: Element> {
    real: Option<Filter>,
    wall: Line<Map, LaneScalar<T>>,
    deviates: [usize; 2],
}

impl<T: Element> Sensor<T, 2> for OfWall<T> {
    #[inline(always)]
    fn innovation(
        &self,
        there: &Whereabouts<T>,
        deviate: impl Fn(usize) -> LaneScalar<T>,
    ) -> Innovation<LaneScalar<T>, 2> {
        let Whereabouts { filter, truth, belief } = there;
        let std = |of: fn(&Filter) -> f64| LaneScalar::<T>::from_f64(self.real.as_ref().map_or(0.0, of));
        let distance = deviate(self.deviates[0]) * std(|real| real.wall_distance_std);
        let direction = deviate(self.deviates[1]) * std(|real| real.wall_direction_std);
        let sighting = LineMeasurement {
            wall: self.wall,
            seen: Line::new(
                self.wall.distance_from(truth.origin()) + distance,
                (self.wall.direction - truth.heading) + Angle::from_radians_unchecked(direction),
            ),
            distance_variance: LaneScalar::from_f64(filter.wall_distance_std).squared(),
            direction_variance: LaneScalar::from_f64(filter.wall_direction_std).squared(),
            covariance: LaneScalar::from_f64(0.0),
            wall_variance: LaneScalar::from_f64(0.0),
        };
        sighting.innovation(belief)
    }
}

/// Kernel: measures, and corrects the belief if the gate accepts the measurement.
struct Correct<'a, T: Element, S>(&'a TrialBatch<T>, &'a mut BeliefBatch<T>, S);

impl<T: Element, S> Correct<'_, T, S> {
    #[inline(always)]
    fn by<const M: usize>(self)
    where
        S: Sensor<T, M>,
    {
        let Self(batch, beliefs, sensor) = self;
        let filter = beliefs.filter;
        let ekf = filter.ekf();
        let threshold = LaneScalar::<T>::from_f64(beliefs.gate.threshold(M));
        let (zero, one) = (LaneScalar::<T>::from_f64(0.0), LaneScalar::<T>::from_f64(1.0));
        for k in BatchArray::<T>::rows::<1>() {
            let there = Whereabouts { filter, truth: pose_of(batch, k), belief: beliefs.get(k) };
            let innovation = sensor.innovation(&there, |of| beliefs.deviates[of].get_as(k));
            let correction = ekf.correct(there.belief, &innovation, threshold);
            beliefs.set(k, correction.belief);
            let refused = beliefs.score.refused.get(k) + LaneScalar::select(correction.accepted, zero, one);
            beliefs.score.refused.set(k, refused);
        }
    }
}

impl<T: Element> Kernel for Correct<'_, T, OfCompass> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.by::<1>();
    }
}

impl<T: Element> Kernel for Correct<'_, T, OfWall<T>> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.by::<2>();
    }
}

/// Kernel: accumulates error and NEES of every belief.
struct Judge<'a, T: Element>(&'a TrialBatch<T>, &'a mut BeliefBatch<T>);

impl<T: Element> Kernel for Judge<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, beliefs) = self;
        for k in BatchArray::<T>::rows::<1>() {
            let (belief, truth) = (beliefs.get(k), pose_of(batch, k));
            let [x, y, heading] = belief.error(truth);
            let score = &mut beliefs.score;
            score.nees.set(k, score.nees.get(k) + belief.nees(truth));
            score.position.set(k, score.position.get(k) + (x.squared() + y.squared()));
            score.heading.set(k, score.heading.get(k) + heading.squared());
        }
    }
}

/// Kernel: computes the navigation variables of the goal from the belief.
struct Look<'a, T: Element>(&'a mut TrialBatch<T>, &'a BeliefBatch<T>);

impl<T: Element> Kernel for Look<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, beliefs) = self;
        for k in BatchArray::<T>::rows::<1>() {
            // The map's origin is the goal.
            let Pose { x, y, heading, .. } = beliefs.pose(k);
            batch.see(k, Pose::new(x, y, heading));
        }
    }
}

/// Kernel: predicts every belief by the encoder readings.
struct Predict<'a, T: Element>(&'a TrialBatch<T>, &'a mut BeliefBatch<T>, f64);

impl<T: Element> Kernel for Predict<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, beliefs, period) = self;
        let (drive, limits, period) = (DRIVE.cast(), limits().cast(), LaneScalar::<T>::from_f64(period));
        let ekf = beliefs.filter.ekf();
        for k in BatchArray::<T>::rows::<1>() {
            let desired = Twist::new(batch.v.get(k), batch.omega.get(k));
            let rims = drive.wheel_speeds_from_twist(limits.limit_speed(&drive, desired));
            let belief = ekf.predict(beliefs.get(k), ekf.wheel_odometry(rims.scaled(period)));
            beliefs.set(k, belief);
        }
    }
}

#[inline(always)]
fn pose_of<T: Element>(batch: &TrialBatch<T>, k: usize) -> Pose<Map, Body, LaneScalar<T>> {
    Pose::new(batch.x.get(k), batch.y.get(k), Angle::from_radians_unchecked(batch.heading.get(k)))
}

impl<T: Element> BeliefBatch<T> {
    #[inline(always)]
    fn pose(&self, k: usize) -> Pose<Map, Body, LaneScalar<T>> {
        Pose::new(self.x.get(k), self.y.get(k), Angle::from_radians_unchecked(self.heading.get(k)))
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Belief<LaneScalar<T>> {
        let zero = LaneScalar::<T>::from_f64(0.0);
        let upper = [
            [zero, self.upper[0].get(k), self.upper[1].get(k)],
            [zero, zero, self.upper[2].get(k)],
            [zero; 3],
        ];
        let diagonal = [self.diagonal[0].get(k), self.diagonal[1].get(k), self.diagonal[2].get(k)];
        Belief { pose: self.pose(k), covariance: Covariance::from_factors(upper, diagonal) }
    }

    #[inline(always)]
    fn set(&mut self, k: usize, belief: Belief<LaneScalar<T>>) {
        self.x.set(k, belief.pose.x);
        self.y.set(k, belief.pose.y);
        self.heading.set(k, belief.pose.heading.radians());
        let (upper, diagonal) = belief.covariance.factors();
        self.upper[0].set(k, upper[0][1]);
        self.upper[1].set(k, upper[0][2]);
        self.upper[2].set(k, upper[1][2]);
        for which in 0..3 {
            self.diagonal[which].set(k, diagonal[which]);
        }
    }
}
