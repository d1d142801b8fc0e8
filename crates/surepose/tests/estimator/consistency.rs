//! Consistency of the filter: the mean NEES matches its χ² distribution.

use surepose::estimation::{Measurement, RangeBearingMeasurement};
use surepose::geometry::{Angle, Point, Pose};
use surepose::kinematics::{Integration, WheelPair};
use surepose::scalar::Float;
use surepose::time::Stamped;

use crate::common::Noise;
use crate::{at, estimator};

/// The mean NEES of simulated filters lies within the 95 % band of χ² with 3 degrees of freedom, in both precisions.
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
