//! Effect of noisy wheel odometry on the filter.

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
/// Rim travel per period \[m].
const RIM: f64 = 0.3 * PERIOD;
const TICKS: i64 = 400;
/// Standard deviations of the start pose \[m], \[rad].
const START: [f64; 3] = [0.01, 0.01, 0.002];

fn at(tick: i64) -> Stamp {
    Stamp::from_seconds(PERIOD * tick as f64)
}

/// Simulates robots that drive 6 m straight ahead with 20 % wheel noise and an accurate compass; `travel` gives the variance.
///
/// Returns the mean error along the path \[m], its standard error \[m] and the mean NEES.
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
    // The remaining bias adds 0.3 to the NEES; the mean of 300 runs is within 0.28 of 3.
    assert!((2.7..3.6).contains(&nees), "{nees}");
    // With the variance of Eq. (15), the same runs are biased: the bounds above are sharp.
    assert!(papers < -0.15 && papers_error < 0.003 && papers_nees > 20.0, "{papers} m, {papers_nees}");
}

/// With jitter of the stamps and after a gap, the sum of the variances along a path equals that of Eq. (15).
#[test]
fn stamp_jitter_and_gaps_keep_the_odometry_variance() {
    let ekf = Ekf { drive: DiffDrive::new(0.05, 0.6), delta: DELTA, integration: Integration::Arc };
    let known = Belief::new(Pose::identity(), START);
    // Intervals between stamps \[ms]; the rim travel is 15 mm each, or proportional to the interval.
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

/// Returns the relative error of `f32` on a path along x, from `x` \[m] at `speed` \[m/s].
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

/// Verifies the figures for `f32` in the documentation of the crate.
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
