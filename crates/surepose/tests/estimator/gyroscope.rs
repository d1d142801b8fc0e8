//! Gyroscope: the turn by wheels and gyroscope together is consistent, the bias is found, and slip is noticed.

use surepose::estimation::{
    Belief, DelayedEkf, Ekf, Gate, Gyroscope, GyroscopeTurn, HeadingMeasurement, Measurement,
    RangeBearingMeasurement,
};
use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::scalar::Float;
use surepose::time::Stamped;

use crate::at;
use crate::common::Noise;

const PERIOD: f64 = 0.1;

fn gyroscope<S: Float>(std: f64) -> Gyroscope<S> {
    Gyroscope { std: S::from_f64(std), bias_std: S::from_f64(0.02), bias_walk: S::from_f64(0.002) }
}

fn filter<S: Float>(std: f64) -> DelayedEkf<S, 64> {
    let ekf = Ekf {
        drive: DiffDrive::new(S::from_f64(0.05), S::from_f64(0.6)),
        delta: S::from_f64(0.0025),
        integration: Integration::Arc,
    };
    let belief = Belief::new(Pose::identity(), [0.02, 0.02, 0.01].map(S::from_f64));
    let gate = Gate::new(0.999_999);
    DelayedEkf::new(ekf, gate, 2.0, at(0), belief).with_gyroscope(gyroscope(std))
}

/// NEES at the end of drives with a bias that walks, without any other sensor or with a landmark that is seen late.
fn mean_nees<S: Float>(std: f64, has_landmark: bool, rests: bool) -> (f64, f64) {
    let (runs, mut sum, mut random) = (600, 0.0, Noise(11));
    for _ in 0..runs {
        let mut filter = filter::<S>(std);
        let mut bias = 0.02 * random.normal();
        let start = [0.02, 0.02, 0.01].map(|std| std * random.normal());
        let mut truth: Pose<Map, Body, f64> = Pose::new(start[0], start[1], Angle::from_radians(start[2]));
        let drive: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
        for tick in 1..=60_i64 {
            let is_at_rest = rests && tick <= 20;
            let command = if is_at_rest { [0.0, 0.0] } else { [0.03, 0.022] };
            let real = command.map(|rim| rim * (1.0 + 0.05 * random.normal()));
            let motion = drive.motion_from_travel(WheelPair::new(real[0], real[1]));
            truth = truth.integrate(motion, Integration::Arc);
            bias += 0.002 * PERIOD.sqrt() * random.normal();
            let turn = motion.turn + (bias + std * random.normal()) * PERIOD;
            let turn = GyroscopeTurn {
                turn: S::from_f64(turn),
                variance: S::from_f64((std * PERIOD).powi(2)),
                duration: S::from_f64(PERIOD),
            };
            let odometry =
                filter.ekf().wheel_odometry(WheelPair::new(S::from_f64(command[0]), S::from_f64(command[1])));
            assert_eq!(filter.predict_interval(at(tick * 100), odometry, Some(turn)), Ok(()));
            if has_landmark && tick % 5 == 0 {
                let point = Point::new(2.0, 1.0);
                let seen = RangeBearingMeasurement {
                    landmark: Point::new(S::from_f64(2.0), S::from_f64(1.0)),
                    range: S::from_f64(truth.origin().distance(point) + 0.05 * random.normal()),
                    bearing: Angle::from_radians(S::from_f64(
                        (truth.origin().direction_to(point) - truth.heading).radians()
                            + 0.02 * random.normal(),
                    )),
                    range_std: S::from_f64(0.05),
                    bearing_std: S::from_f64(0.02),
                };
                filter.update(Stamped::new(at(tick * 100), Measurement::RangeBearing(seen)));
            }
        }
        let heading = Angle::from_radians(S::from_f64(truth.heading.radians()));
        let truth = Pose::new(S::from_f64(truth.x), S::from_f64(truth.y), heading);
        sum += filter.belief().nees(truth).to_f64();
    }
    (sum / f64::from(runs), 2.58 * (6.0 / f64::from(runs)).sqrt())
}

#[test]
fn filter_with_gyroscope_is_consistent() {
    // A good gyroscope, and one that is no better than the wheels.
    for std in [0.005, 0.02] {
        for (has_landmark, rests) in [(false, false), (false, true), (true, false), (true, true)] {
            for (mean, band) in
                [mean_nees::<f64>(std, has_landmark, rests), mean_nees::<f32>(std, has_landmark, rests)]
            {
                assert!(
                    (mean - 3.0).abs() < band,
                    "σ {std} rad/s, landmark {has_landmark}, rest {rests}: mean NEES {mean}, expected 3 ± {band}"
                );
            }
        }
    }
}

/// At rest the wheels are exact, and every reading measures the bias.
#[test]
fn bias_is_found_at_rest() {
    let (bias, std, mut random) = (0.015, 0.005, Noise(3));
    let mut filter = filter::<f64>(std);
    for tick in 1..=100 {
        let turn = (bias + std * random.normal()) * PERIOD;
        let turn = GyroscopeTurn { turn, variance: (std * PERIOD).powi(2), duration: PERIOD };
        let odometry = filter.ekf().wheel_odometry(WheelPair::zero());
        filter.predict_interval(at(tick * 100), odometry, Some(turn)).unwrap();
    }
    let found = filter.gyroscope_bias().unwrap().value;
    // Ten seconds: a hundred readings, and a random walk of 0.002 rad/s in each second, which averages over about a second.
    assert!((found - bias).abs() < 3.0 * 0.0025, "{found}");
    let [x, y, heading] = filter.belief().error(Pose::identity());
    assert!(x.abs() + y.abs() + heading.abs() < 1e-12, "the robot rests");
}

/// Wheels that spin do not turn the estimate: the gyroscope does, and the position says that it is uncertain.
#[test]
fn slipping_wheels_do_not_turn_the_estimate() {
    let std = 0.005;
    let mut filter = filter::<f64>(std);
    let heading = HeadingMeasurement { heading: Angle::zero(), std: 0.01 };
    for tick in 1..=20 {
        filter.predict(at(tick * 100), WheelPair::zero()).unwrap();
        filter.update(Stamped::new(at(tick * 100), Measurement::Heading(heading)));
    }
    let before = filter.belief().covariance.std(0);
    for tick in 21..=30 {
        // The right wheel spins at 0.4 m/s; the robot does not turn.
        let turn = GyroscopeTurn { turn: 0.0, variance: (std * PERIOD).powi(2), duration: PERIOD };
        let odometry = filter.ekf().wheel_odometry(WheelPair::new(0.04, 0.0));
        filter.predict_interval(at(tick * 100), odometry, Some(turn)).unwrap();
    }
    let belief = filter.belief();
    assert!(belief.pose.heading.radians().abs() < 0.05, "{belief:?}");
    assert!(belief.covariance.std(0) > before + 0.04, "the slip makes the position uncertain: {belief:?}");
    assert!(belief.nees(Pose::identity()) < 16.0, "{belief:?}");
}
