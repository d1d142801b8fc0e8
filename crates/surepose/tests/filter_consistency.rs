//! Consistency of the filter: the mean NEES matches its χ² distribution.

mod common;

use common::Noise;
use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate, Measurement, RangeBearingMeasurement};
use surepose::geometry::{Angle, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::scalar::Float;
use surepose::time::{Stamp, Stamped};

fn estimator<S: Float>() -> DelayedEkf<S, 64> {
    let ekf = Ekf {
        drive: DiffDrive::new(S::from_f64(0.05), S::from_f64(0.6)),
        delta: S::from_f64(0.0025),
        integration: Integration::Arc,
    };
    let belief = Belief::new(Pose::identity(), [S::from_f64(0.05), S::from_f64(0.05), S::from_f64(0.02)]);
    DelayedEkf::new(ekf, Gate::new(0.999), 1.0, Stamp::default(), belief)
}

fn at(milliseconds: i64) -> Stamp {
    Stamp::from_nanoseconds(milliseconds * 1_000_000)
}

/// A simulated filter's mistakes have the size it claims: mean NEES within the 95 % χ² band of 3, in both precisions.
fn consistent<S: Float>() {
    let runs = 400;
    let mut sum = 0.0;
    let mut random = Noise(7);
    for _ in 0..runs {
        let mut estimator = estimator::<S>();
        let start = [random.normal() * 0.05, random.normal() * 0.05, random.normal() * 0.02];
        let mut truth = Pose::new(
            S::from_f64(start[0]),
            S::from_f64(start[1]),
            Angle::from_radians(S::from_f64(start[2])),
        );
        for tick in 1..=50_i64 {
            let rims = WheelPair::new(S::from_f64(0.03), S::from_f64(0.025));
            assert_eq!(estimator.predict(at(tick * 100), rims), Ok(()));
            let slip = |rim: S, noise: f64| rim * S::from_f64(1.0 + 0.05 * noise);
            let real = WheelPair::new(slip(rims.right, random.normal()), slip(rims.left, random.normal()));
            truth = truth.integrate(estimator.ekf().drive.motion_from_travel(real), Integration::Arc);

            let point = Point::new(S::from_f64(2.0), S::from_f64(1.0));
            let seen = RangeBearingMeasurement {
                landmark: point,
                range: truth.origin().distance(point) + S::from_f64(0.05 * random.normal()),
                bearing: (truth.origin().direction_to(point) - truth.heading)
                    .rotated_by(S::from_f64(0.02 * random.normal())),
                range_std: S::from_f64(0.05),
                bearing_std: S::from_f64(0.02),
            };
            estimator.update(Stamped::new(at(tick * 100), Measurement::RangeBearing(seen)));
        }
        sum += estimator.belief().nees(truth).to_f64();
    }
    // χ² with 3·runs degrees of freedom: mean 3, standard deviation √(6/runs).
    let (mean, band) = (sum / f64::from(runs), 1.96 * (6.0 / f64::from(runs)).sqrt());
    assert!((mean - 3.0).abs() < band, "mean NEES {mean}, expected 3 ± {band}");
}

#[test]
fn filter_is_consistent_in_f64() {
    consistent::<f64>();
}

#[test]
fn filter_is_consistent_in_f32() {
    consistent::<f32>();
}
