//! Late, stale, invalid and outlying measurements: classification, counts and effect on the belief.

mod common;
mod estimator {
    mod considered;
    mod consistency;
    mod gyroscope;
}

use proptest::prelude::*;
use surepose::estimation::{
    Belief, DelayedEkf, Ekf, Gate, HeadingMeasurement, LineMeasurement, Measurement, MeasurementOutcome,
    PoseMeasurement, PositionMeasurement, RangeBearingMeasurement, RejectReason,
};
use surepose::geometry::{Angle, Line, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::linalg::Matrix;
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

fn compass(heading: f64) -> Measurement<f64> {
    Measurement::Heading(HeadingMeasurement { heading: Angle::from_radians(heading), std: 0.01 })
}

fn landmark(range: f64) -> Measurement<f64> {
    Measurement::RangeBearing(RangeBearingMeasurement {
        landmark: Point::new(2.0, 1.0),
        range,
        bearing: Angle::from_radians(0.45),
        range_std: 0.05,
        bearing_std: 0.02,
    })
}

fn same(a: &Belief<f64>, b: &Belief<f64>) -> bool {
    let pose = a.error(b.pose).iter().all(|e| e.abs() < 1e-12);
    let covariance =
        (0..9).all(|i| (a.covariance.entry(i / 3, i % 3) - b.covariance.entry(i / 3, i % 3)).abs() < 1e-14);
    pose && covariance
}

/// The belief depends on the time order of measurements, not on their arrival order.
#[test]
fn late_measurements_match_timely_ones() {
    let rims = WheelPair::new(0.03, 0.02);
    let measured = [(100, compass(0.02)), (150, landmark(2.1)), (200, compass(0.04)), (260, landmark(2.0))];

    let mut timely = estimator::<f64>();
    let mut late = timely;
    let mut pending = measured.iter().peekable();
    for tick in 1..=6_i64 {
        // The timely filter receives odometry up to each measurement at the stamp of the measurement.
        let mut from = (tick - 1) * 50;
        let whole = timely.ekf().wheel_odometry(rims);
        while let Some((time, value)) = pending.next_if(|(time, _)| *time <= tick * 50) {
            let part = (time - from) as f64 / 50.0;
            timely.predict_with(at(*time), whole.fraction(part)).unwrap();
            assert!(matches!(
                timely.update(Stamped::new(at(*time), *value)),
                MeasurementOutcome::Accepted { .. }
            ));
            from = *time;
        }
        timely.predict_with(at(tick * 50), whole.fraction((tick * 50 - from) as f64 / 50.0)).unwrap();
        late.predict(at(tick * 50), rims).unwrap();
    }
    for (time, value) in [measured[3], measured[1], measured[0], measured[2]] {
        assert!(matches!(late.update(Stamped::new(at(time), value)), MeasurementOutcome::Accepted { .. }));
    }
    assert!(same(&timely.belief(), &late.belief()), "{:?}\n{:?}", timely.belief(), late.belief());
    assert_eq!(late.measurement_stats().accepted, 4);
}

#[test]
fn belief_at_returns_past_beliefs() {
    let mut estimator = estimator::<f64>();
    for tick in 1..=4 {
        estimator.predict(at(tick * 50), WheelPair::new(0.02, 0.02)).unwrap();
    }
    let halfway = estimator.belief_at(at(125)).unwrap();
    assert!((halfway.pose.x - 0.05).abs() < 1e-12);
    assert!(estimator.belief_at(at(250)).is_none(), "a belief in the future");
    assert!(estimator.belief_at(at(-10)).is_none(), "a belief before the start");
}

#[test]
fn stale_and_future_measurements_are_rejected() {
    let mut estimator = estimator::<f64>();
    for tick in 1..=60 {
        estimator.predict(at(tick * 50), WheelPair::new(0.0, 0.0)).unwrap();
    }
    let before = estimator.belief();
    assert_eq!(
        estimator.update(Stamped::new(at(1000), compass(0.0))),
        MeasurementOutcome::Rejected(RejectReason::Stale)
    );
    assert_eq!(
        estimator.update(Stamped::new(at(3001), compass(0.0))),
        MeasurementOutcome::Rejected(RejectReason::Future)
    );
    assert_eq!(
        estimator.update(Stamped::new(at(3000), compass(1.0))),
        MeasurementOutcome::Rejected(RejectReason::Outlier)
    );
    assert_eq!(estimator.belief(), before);
    assert_eq!(estimator.measurement_stats().rejected(RejectReason::Stale), 1);
    assert_eq!(estimator.measurement_stats().rejected_total(), 3);
    assert!(matches!(
        estimator.update(Stamped::new(at(2500), compass(0.0))),
        MeasurementOutcome::Accepted { .. }
    ));
}

/// Neither one stamp an hour ahead nor a clock that is set back loses travel; time continues at the new stamps.
#[test]
fn clock_jumps_lose_no_travel() {
    for jumps in [[3_600_000, 0], [-5_000, -5_000], [-80, 0]] {
        let mut estimator = estimator::<f64>();
        for tick in 1..=100_i64 {
            let jump = match tick {
                ..50 => 0,
                50 => jumps[0],
                _ => jumps[1],
            };
            let now = at(50 * tick + jump);
            assert_eq!(estimator.predict(now, WheelPair::new(0.01, 0.01)), Ok(()));
            assert_eq!(estimator.stamp(), now);
        }
        assert!((estimator.belief().pose.x - 1.0).abs() < 1e-9, "{jumps:?}: {:?}", estimator.belief());
        assert_eq!(estimator.measurement_stats().clock_resets, 1, "{jumps:?}");
        let now = Stamped::new(estimator.stamp(), compass(0.0));
        assert!(matches!(estimator.update(now), MeasurementOutcome::Accepted { .. }), "{jumps:?}");
    }
}

/// Late outliers do not shorten the history.
#[test]
fn rejected_outlier_leaves_the_belief_unchanged() {
    let mut estimator = estimator::<f64>();
    for tick in 1..=64_i64 {
        estimator.predict(at(tick * 10), WheelPair::new(0.001, 0.0012)).unwrap();
    }
    let before = estimator;
    for late in 1..60_i64 {
        let outlier = Stamped::new(at(640 - 10 * late + 3), compass(2.0));
        assert_eq!(estimator.update(outlier), MeasurementOutcome::Rejected(RejectReason::Outlier));
    }
    assert_eq!(estimator.belief(), before.belief());
    assert!((1..64).all(|tick| estimator.belief_at(at(tick * 10)) == before.belief_at(at(tick * 10))));
}

/// A full history drops its oldest entry; measurements from before the history are rejected as stale.
#[test]
fn full_history_drops_only_its_oldest_entry() {
    let mut estimator = estimator::<f64>();
    for tick in 1..=640_i64 {
        estimator.predict(at(tick), WheelPair::new(0.0001, 0.0001)).unwrap();
        let late = Stamped::new(at(tick - 20), compass(0.0));
        let outcome = estimator.update(late);
        assert!(matches!(
            outcome,
            MeasurementOutcome::Accepted { .. } | MeasurementOutcome::Rejected(RejectReason::Stale)
        ));
        assert!(estimator.belief().covariance.is_valid());
    }
    assert!(estimator.measurement_stats().accepted > 600, "{:?}", estimator.measurement_stats());
    assert!((estimator.belief().pose.x - 0.064).abs() < 1e-9);
}

/// Late measurements lose no travel, even in a full history.
#[test]
fn late_measurements_lose_no_travel() {
    for half_ticks_late in 0..160_i64 {
        for heading in [0.0, 3.0] {
            let mut estimator = estimator::<f64>();
            for tick in 1..=100_i64 {
                estimator.predict(at(tick), WheelPair::new(0.0001, 0.0001)).unwrap();
            }
            let half_tick = (at(1).nanoseconds() - at(0).nanoseconds()) / 2;
            let taken = Stamp::from_nanoseconds(at(100).nanoseconds() - half_ticks_late * half_tick);
            let outcome = estimator.update(Stamped::new(taken, compass(heading)));
            let x = estimator.belief().pose.x;
            assert!(
                (x - 0.01).abs() < 1e-9,
                "{half_ticks_late} half ticks late, {heading} rad, {outcome:?}: {x} m"
            );
        }
    }
}

/// A reset to a past pose replays the odometry since then.
#[test]
fn reset_at_replays_odometry() {
    let known = Belief::new(Pose::new(3.0, -1.0, Angle::from_degrees(90.0)), [0.01, 0.02, 0.003]);
    let rims = WheelPair::new(0.03, 0.02);
    let mut rolled = estimator::<f64>();
    for tick in 1..=20_i64 {
        rolled.predict(at(tick * 50), rims).unwrap();
        let heading = compass(0.01 / 0.6 * tick as f64);
        let outcome = rolled.update(Stamped::new(at(tick * 50 - 20), heading));
        assert!(matches!(outcome, MeasurementOutcome::Accepted { .. }));
    }
    // The last odometry arrives in two parts with the same stamp.
    rolled.predict(at(1000), rims).unwrap();

    // 12 of 50 ms remain of the odometry interval of the reset; later measurements are dropped.
    let whole = rolled.ekf().wheel_odometry(rims);
    let mut expected = known;
    for part in [0.24, 0.6, 0.4, 0.6, 0.4, 1.0] {
        expected = rolled.ekf().predict(expected, whole.fraction(part));
    }
    let mut resumed = rolled;
    resumed.reset_at(at(888), known);
    assert_eq!(resumed.stamp(), at(1000));
    assert!(same(&resumed.belief(), &expected), "{:?}\n{expected:?}", resumed.belief());
    assert!(resumed.belief_at(at(880)).is_none(), "a belief before the reset");

    for outside in [at(-1), at(1001), Stamp::from_seconds(1e9)] {
        let mut resumed = rolled;
        resumed.reset_at(outside, known);
        assert_eq!(
            (resumed.stamp(), resumed.belief()),
            (at(1000), known),
            "a reset outside of the history applies at the current stamp"
        );
    }
}

/// Two odometry inputs with one stamp both count after a reset to an earlier stamp.
#[test]
fn zero_duration_odometry_is_kept() {
    let mut estimator = estimator::<f64>();
    for time in [0, 50, 50] {
        estimator.predict(at(time), WheelPair::new(0.05, 0.05)).unwrap();
    }
    estimator.reset_at(at(20), Belief::new(Pose::identity(), [0.01; 3]));
    assert!((estimator.belief().pose.x - 0.08).abs() < 1e-12, "{:?}", estimator.belief());
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -10.0..10.0_f64,
        1 => prop::sample::select(vec![
            0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e-300, f64::MAX, 1e7
        ]),
    ]
}

fn any_measurement<S: Float>() -> impl Strategy<Value = Measurement<S>> {
    (0..5, prop::array::uniform9(any_number())).prop_map(|(kind, v)| {
        let v = v.map(S::from_f64);
        let pose = Pose::new(v[0], v[1], Angle::from_radians(v[2]));
        match kind {
            0 => Measurement::Heading(HeadingMeasurement { heading: Angle::from_radians(v[0]), std: v[1] }),
            1 => Measurement::Line(LineMeasurement {
                wall: Line::new(v[0], Angle::from_radians(v[1])),
                seen: Line::new(v[2], Angle::from_radians(v[3])),
                distance_variance: v[4],
                direction_variance: v[5],
                covariance: v[6],
                wall_variance: v[7],
            }),
            2 => Measurement::RangeBearing(RangeBearingMeasurement {
                landmark: Point::new(v[0], v[1]),
                range: v[2],
                bearing: Angle::from_radians(v[3]),
                range_std: v[4],
                bearing_std: v[5],
            }),
            3 => Measurement::Position(PositionMeasurement {
                position: Point::new(v[0], v[1]),
                x_variance: v[2],
                y_variance: v[3],
                covariance: v[4],
            }),
            _ => Measurement::Pose(PoseMeasurement {
                pose,
                information: Matrix([[v[3], v[4], v[5]], [v[4], v[6], v[7]], [v[5], v[7], v[8]]]),
            }),
        }
    })
}

/// Any input at any stamp leaves a finite belief with a valid covariance; a rejected measurement changes nothing.
fn beliefs_stay_valid<S: Float>(
    inputs: Vec<(Measurement<S>, f64, f64, i64, i64)>,
) -> Result<(), TestCaseError> {
    let mut estimator = estimator::<S>();
    let mut now = 0;
    for (measurement, right, left, lateness, step) in inputs {
        now += step;
        let before = estimator.belief();
        if estimator.predict(at(now), WheelPair::new(S::from_f64(right), S::from_f64(left))).is_err() {
            prop_assert_eq!(estimator.belief(), before);
        }
        let before = estimator.belief();
        let outcome = estimator.update(Stamped::new(at(now + lateness), measurement));
        if matches!(outcome, MeasurementOutcome::Rejected(_)) {
            prop_assert_eq!(estimator.belief(), before);
        }
        let belief = estimator.belief();
        prop_assert!(belief.pose.x.is_finite() && belief.pose.y.is_finite());
        prop_assert!(belief.pose.heading.radians().is_finite() && belief.covariance.is_valid());
    }
    Ok(())
}

/// Measurement, rim travel, delay and clock step \[ms].
fn any_inputs<S: Float>() -> impl Strategy<Value = Vec<(Measurement<S>, f64, f64, i64, i64)>> {
    let step = prop_oneof![8 => Just(50_i64), 1 => -3000_i64..3000];
    prop::collection::vec((any_measurement(), any_number(), any_number(), -200_i64..50, step), 1..40)
}

proptest! {
    #[test]
    fn belief_stays_valid_for_any_input(inputs in any_inputs::<f64>()) {
        beliefs_stay_valid(inputs)?;
    }

    #[test]
    fn belief_stays_valid_for_any_input_in_f32(inputs in any_inputs::<f32>()) {
        beliefs_stay_valid(inputs)?;
    }
}

/// A landmark at zero range has an unbounded Jacobian; an overflow must not pass the gate.
#[test]
fn landmark_at_zero_range_leaves_the_belief_finite() {
    fn tried<S: Float>(apart: f64) {
        let mut estimator = estimator::<S>();
        estimator.reset(
            at(0),
            Belief::new(Pose::identity(), [S::from_f64(30.0), S::from_f64(30.0), S::from_f64(0.1)]),
        );
        let sighting = RangeBearingMeasurement {
            landmark: Point::new(S::from_f64(apart), S::from_f64(0.0)),
            range: S::from_f64(0.0),
            bearing: Angle::zero(),
            range_std: S::from_f64(0.1),
            bearing_std: S::from_f64(0.1),
        };
        let _either = estimator.update(Stamped::new(at(0), Measurement::RangeBearing(sighting)));
        assert!(estimator.belief().covariance.is_valid(), "{apart} m: {:?}", estimator.belief());
    }
    for exponent in 0..160 {
        let apart = 10_f64.powi(-exponent);
        tried::<f64>(apart);
        tried::<f32>(apart);
    }
}
