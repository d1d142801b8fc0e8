//! Odometry's own noise: what the filter makes of wheels that are measured badly.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod common;

use common::Noise;
use surepose::estimation::{
    Belief, DelayedEkf, Ekf, Gate, HeadingMeasurement, Measurement, MeasurementOutcome, WheelOdometry,
};
use surepose::geometry::{Angle, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::time::{Stamp, Stamped};

const DELTA: f64 = 0.04;
const PERIOD: f64 = 0.05;
/// How far each rim rolls in a period \[m].
const RIM: f64 = 0.3 * PERIOD;
const TICKS: i64 = 400;
/// How well the start is known \[m], \[rad].
const START: [f64; 3] = [0.01, 0.01, 0.002];

fn at(tick: i64) -> Stamp {
    Stamp::from_seconds(PERIOD * tick as f64)
}

/// Robots that drive 6 m straight ahead with 20 % of noise on their wheels and a good compass, and take the variance of a stretch
/// from `travel`: how far beyond the truth they believe to be in the mean, the standard error of that \[m], and the mean NEES.
fn believed(
    travel: impl Fn(&DelayedEkf<f64>, Stamp, WheelPair<f64>) -> WheelOdometry<f64>,
) -> (f64, f64, f64) {
    let runs = 300;
    let mut noise = Noise(11);
    let (mut sum, mut squares, mut nees) = (0.0, 0.0, 0.0);
    let ekf = Ekf { drive: DiffDrive::new(0.05, 0.6), delta: DELTA, integration: Integration::Arc };
    for _ in 0..runs {
        let [x, y, heading] = START.map(|std| std * noise.normal());
        let known = Belief::new(Pose::new(x, y, Angle::from_radians(heading)), START);
        let mut estimator = DelayedEkf::<f64>::new(ekf, Gate::new(0.999_999), 1.0, at(0), known);
        for tick in 1..=TICKS {
            let rim = |noise: &mut Noise| RIM * (1.0 + DELTA.sqrt() * noise.normal());
            let rims = WheelPair::new(rim(&mut noise), rim(&mut noise));
            let travel = travel(&estimator, at(tick), rims);
            estimator.predict_with(at(tick), travel).unwrap();
            let compass =
                HeadingMeasurement { heading: Angle::from_radians(0.002 * noise.normal()), std: 0.002 };
            let outcome = estimator.update(Stamped::new(at(tick), Measurement::Heading(compass)));
            assert!(matches!(outcome, MeasurementOutcome::Accepted { .. }));
        }
        let truth = Pose::new(RIM * TICKS as f64, 0.0, Angle::zero());
        let beyond = estimator.belief().error(truth)[0];
        sum += beyond;
        squares += beyond * beyond;
        nees += estimator.belief().nees(truth);
    }
    let runs = f64::from(runs);
    let mean = sum / runs;
    (mean, ((squares / runs - mean * mean) / runs).sqrt(), nees / runs)
}

#[test]
fn noisy_odometry_with_heading_updates_is_unbiased() {
    let (mean, std_error, nees) = believed(DelayedEkf::wheel_odometry);
    let (papers, papers_error, papers_nees) =
        believed(|estimator, _, rims| estimator.ekf().wheel_odometry(rims));
    assert!(mean.abs() < 0.03 && std_error < 0.003, "{mean} ± {std_error} m");
    // 0.3 of NEES are what is left of the bias; χ² with 900 degrees of freedom is within 0.28 of 3.
    assert!((2.7..3.6).contains(&nees), "{nees}");
    // Two tests in one: the sizes above mean nothing if (15) had them too.
    assert!(papers < -0.15 && papers_error < 0.003 && papers_nees > 20.0, "{papers} m, {papers_nees}");
}

/// However the stamps jitter, and after a silence: what the variances of a way add up to is what (15) makes of it.
#[test]
fn stamp_jitter_and_gaps_keep_the_odometry_variance() {
    let ekf = Ekf { drive: DiffDrive::new(0.05, 0.6), delta: DELTA, integration: Integration::Arc };
    let known = Belief::new(Pose::identity(), START);
    // From one stamp to the next \[ms], while the rims roll 15 mm each time, or as far as the time says.
    let (even, burst, silent) =
        ([50; 12], [50, 50, 50, 99, 1, 50, 50, 100, 0, 50, 50, 50], [50, 50, 50, 5000, 50, 50]);
    for (steps, in_time) in [(&even[..], true), (&burst[..], false), (&silent[..], true)] {
        let mut estimator = DelayedEkf::<f64>::new(ekf, Gate::new(0.999_999), 1.0, at(0), known);
        let (mut ours, mut papers, mut now) = (0.0, 0.0, at(0));
        for step in steps {
            now = now.after(0.001 * f64::from(*step));
            let rim = if in_time { 0.0003 * f64::from(*step) } else { RIM };
            let rims = WheelPair::new(rim, -rim);
            let travel = estimator.wheel_odometry(now, rims);
            estimator.predict_with(now, travel).unwrap();
            let enough = !in_time || travel.variance.right > 0.2 * DELTA * rim * rim;
            assert!(enough, "{steps:?}: {travel:?} in {step} ms");
            (ours, papers) = (ours + travel.variance.right, papers + ekf.wheel_odometry(rims).variance.right);
        }
        assert!((0.8..2.0).contains(&(ours / papers)), "{steps:?}: {ours} m², by (15) {papers} m²");
    }
}

/// Of a way along x, from `x` \[m] on at `speed` \[m/s], the part by which `f32` is off.
fn rounded_away(x: f64, speed: f64, period: f64) -> f64 {
    let ekf = Ekf { drive: DiffDrive::new(0.05_f32, 0.6), delta: 0.0025, integration: Integration::Arc };
    let mut belief = Belief::new(Pose::new(x as f32, 0.0, Angle::zero()), [0.01; 3]);
    let rim = (speed * period) as f32;
    let ticks = (10.0 / period) as u32;
    for _ in 0..ticks {
        belief = ekf.predict(belief, ekf.wheel_odometry(WheelPair::new(rim, rim)));
    }
    let way = f64::from(belief.pose.x) - f64::from(x as f32);
    (1.0 - way / (speed * period * f64::from(ticks))).abs()
}

/// What the crate's page says of `f32`.
#[test]
fn f32_dead_reckoning_keeps_the_travel_of_each_period() {
    for x in [0.0, 3.0, 10.0, -40.0, 99.0] {
        for speed in [0.01, 0.013, 0.02, 0.05, 0.3, 1.0] {
            let lost = rounded_away(x, speed, 0.02);
            assert!(lost < 0.01, "at {x} m and {speed} m/s: {lost}");
        }
    }
    let lost = rounded_away(99.0, 0.01, 0.001);
    assert!((0.1..0.3).contains(&lost), "{lost}");
}
