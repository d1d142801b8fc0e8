//! Considered parameters: the covariance of the textbook's Schmidt–Kalman filter, and the bits of today without any.

mod textbook;

use surepose::estimation::{
    Belief, ConsideredParameters, DelayedEkf, DisagreeingSensor, Ekf, Gate, HeadingMeasurement,
    LineMeasurement, Measurement,
};
use surepose::geometry::{Angle, Body, Line, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::scalar::Float;
use surepose::time::Stamped;

use crate::at;
use crate::common::Noise;
use textbook::Textbook;

const SEPARATION: f64 = 0.6;
const DELTA: f64 = 0.0025;
/// Compass bias and delay; laser x, y, heading, range scale, delay; radii, their ratio, separation; two walls.
const PARAMETERS: usize = 12;
/// The pose comes first.
const STATES: usize = 3 + PARAMETERS;
/// Two walls, by distance from the origin and direction of the normal.
const WALLS: [(f64, f64); 2] = [(3.0, 0.2), (2.0, 1.9)];
const COMPASS_STD: f64 = 0.01;
const LINE_STD: [f64; 2] = [0.004, 0.003];

fn considered<S: Float>() -> ConsideredParameters<S> {
    let num = S::from_f64;
    ConsideredParameters {
        compass_bias: num(0.02),
        compass_delay: num(0.01),
        laser_position: num(0.005),
        laser_heading: num(0.006),
        range_scale: num(0.003),
        laser_delay: num(0.02),
        radius_scale: num(0.005),
        radius_difference: num(0.007),
        separation_scale: num(0.006),
        wall: num(0.008),
    }
}

fn parameter_std() -> [f64; PARAMETERS] {
    [0.02, 0.01, 0.005, 0.005, 0.006, 0.003, 0.02, 0.005, 0.007, 0.006, 0.008, 0.008]
}

fn filter<S: Float>() -> DelayedEkf<S, 64> {
    let drive = DiffDrive::new(S::from_f64(0.05), S::from_f64(SEPARATION));
    let ekf = Ekf { drive, delta: S::from_f64(DELTA), integration: Integration::Arc };
    let belief = Belief::new(Pose::identity(), [0.05, 0.04, 0.03].map(S::from_f64));
    DelayedEkf::new(ekf, Gate::disabled(), 1.0, at(0), belief)
}

fn wall_measurement<S: Float>(wall: usize, seen: [f64; 2]) -> Measurement<S> {
    let line =
        |distance: f64, direction: f64| (S::from_f64(distance), Angle::from_radians(S::from_f64(direction)));
    let (distance, direction) = line(WALLS[wall].0, WALLS[wall].1);
    let (seen_distance, seen_direction) = line(seen[0], seen[1]);
    Measurement::Line(LineMeasurement {
        wall: Line::new(distance, direction),
        seen: Line::new(seen_distance, seen_direction),
        distance_variance: S::from_f64(LINE_STD[0] * LINE_STD[0]),
        direction_variance: S::from_f64(LINE_STD[1] * LINE_STD[1]),
        covariance: S::from_f64(0.0),
        wall_variance: S::from_f64(0.0),
    })
}

/// On a drive with compass and two walls, pose and covariance are those of the dense filter, step by step.
#[test]
fn considered_filter_is_the_textbooks_schmidt_filter() {
    let mut filter = filter::<f64>().with_considered(&considered());
    let mut textbook = Textbook::new();
    let mut noise = Noise(3);
    for k in 1..=200_i64 {
        let travel = [0.03 + 0.01 * noise.normal(), 0.025 + 0.01 * noise.normal()];
        let odometry = filter.wheel_odometry(at(100 * k), WheelPair::new(travel[0], travel[1]));
        filter.predict_with(at(100 * k), odometry).unwrap();
        textbook.predict(travel, [odometry.variance.right, odometry.variance.left], 0.1);
        if k % 3 == 0 {
            let mut state = [0.0; STATES];
            state[..3].copy_from_slice(&textbook.pose);
            let heading = textbook.heading(&state)[0] + COMPASS_STD * noise.normal();
            let compass = HeadingMeasurement { heading: Angle::from_radians(heading), std: COMPASS_STD };
            filter.update(Stamped::new(at(100 * k), Measurement::Heading(compass)));
            let model = Textbook { velocity: textbook.velocity, ..Textbook::new() };
            textbook.update([heading], [COMPASS_STD], |state| model.heading(state));
        }
        if k % 2 == 0 {
            let wall = usize::from(k % 4 == 0);
            let mut state = [0.0; STATES];
            state[..3].copy_from_slice(&textbook.pose);
            let seen = textbook.wall(&state, wall);
            let seen = [0, 1].map(|i| seen[i] + 2.0 * LINE_STD[i] * noise.normal());
            filter.update(Stamped::new(at(100 * k), wall_measurement(wall, seen)));
            let model = Textbook { velocity: textbook.velocity, ..Textbook::new() };
            textbook.update(seen, LINE_STD, |state| model.wall(state, wall));
        }
        let belief = filter.belief();
        let truth: Pose<Map, Body, f64> =
            Pose::new(textbook.pose[0], textbook.pose[1], Angle::from_radians(textbook.pose[2]));
        for (i, off) in belief.error(truth).into_iter().enumerate() {
            assert!(off.abs() < 1e-8, "step {k}: component {i} off by {off}");
        }
        for i in 0..3 {
            for j in 0..3 {
                let size = (textbook.covariance[i][i] * textbook.covariance[j][j]).sqrt();
                let off = belief.covariance.entry(i, j) - textbook.covariance[i][j];
                assert!(off.abs() < 1e-6 * size, "step {k}: ({i}, {j}) off by {off} of {size}");
            }
        }
    }
}

/// A constant error is not averaged away: at rest, a thousand headings leave the deviation of the bias.
#[test]
fn bias_of_the_compass_stays_in_the_covariance() {
    let bias = ConsideredParameters { compass_bias: 0.02, ..ConsideredParameters::default() };
    let ekf = *filter::<f64>().ekf();
    let unknown = Belief::new(Pose::identity(), [0.05, 0.05, 1.0]);
    let mut filter =
        DelayedEkf::<f64, 64>::new(ekf, Gate::disabled(), 1.0, at(0), unknown).with_considered(&bias);
    for k in 1..=1000 {
        filter.predict(at(100 * k), WheelPair::zero()).unwrap();
        let compass = HeadingMeasurement { heading: Angle::zero(), std: 0.01 };
        filter.update(Stamped::new(at(100 * k), Measurement::Heading(compass)));
    }
    let std = filter.belief().covariance.std(2);
    assert!((std - 0.02).abs() < 0.0002, "{std}, expected 0.02");
}

/// A wall of uncertain position is considered without any configured parameter, and its variance adds to the configured one.
#[test]
fn variance_of_a_wall_counts_like_the_configured_one() {
    let with =
        |wall: f64| filter::<f64>().with_considered(&ConsideredParameters { wall, ..Default::default() });
    let mut filters = vec![(with(0.05), 0.0), (filter(), 0.05_f64.powi(2)), (with(0.03), 0.04_f64.powi(2))];
    let mut noise = Noise(7);
    for k in 1..=200 {
        let travel = WheelPair::new(0.03 + 0.01 * noise.normal(), 0.025 + 0.01 * noise.normal());
        let wall = usize::from(k % 2 == 0);
        let seen = [WALLS[wall].0 + 0.02 * noise.normal(), WALLS[wall].1 + 0.01 * noise.normal()];
        for (filter, variance) in &mut filters {
            filter.predict(at(100 * k), travel).unwrap();
            let Measurement::Line(line) = wall_measurement(wall, seen) else { panic!("a line") };
            let line = LineMeasurement { wall_variance: *variance, ..line };
            filter.update(Stamped::new(at(100 * k), Measurement::Line(line)));
        }
        let beliefs: Vec<_> = filters.iter().map(|(filter, _)| filter.belief()).collect();
        let first = beliefs[0];
        for other in &beliefs[1..] {
            assert!(first.error(other.pose).iter().all(|off| off.abs() < 1e-12), "step {k}");
            for i in 0..3 {
                let off = first.covariance.std(i) - other.covariance.std(i);
                assert!(off.abs() < 1e-9 * first.covariance.std(i), "step {k}: component {i} off by {off}");
            }
        }
    }
    // Two hundred sightings of two walls leave the position as uncertain as they are.
    let covariance = filters[0].0.belief().covariance;
    assert!(covariance.std(0) > 0.03 && covariance.std(1) > 0.03, "{covariance:?}");
    assert_eq!(filters[1].0.disagreement(), None, "only configured parameters are compared");
}

/// Deviations of 0 leave every bit as it is without considered parameters.
#[test]
fn deviations_of_0_change_no_bit() {
    let mut plain = filter::<f64>();
    let mut zero = filter::<f64>().with_considered(&ConsideredParameters::default());
    let mut noise = Noise(5);
    for k in 1..=100 {
        let travel = WheelPair::new(0.03 + 0.01 * noise.normal(), 0.025 + 0.01 * noise.normal());
        let seen = [2.5 + 0.1 * noise.normal(), 0.2 + 0.1 * noise.normal()];
        for filter in [&mut plain, &mut zero] {
            filter.predict(at(100 * k), travel).unwrap();
            filter.update(Stamped::new(at(100 * k), wall_measurement(0, seen)));
        }
        assert_eq!(plain.belief(), zero.belief());
    }
}

/// A late measurement corrects pose, covariance and the effect of the parameters at its time.
#[test]
fn late_measurements_with_parameters_match_timely_ones() {
    let travel = WheelPair::new(0.03, 0.02);
    let headings = [(150, 0.01), (210, 0.03), (290, 0.02)];
    let heading = |(stamp, heading): (i64, f64)| {
        let compass = HeadingMeasurement { heading: Angle::from_radians(heading), std: COMPASS_STD };
        Stamped::new(at(stamp), Measurement::Heading(compass))
    };
    let drive = |order: [usize; 3]| {
        let mut filter = filter::<f64>().with_considered(&considered());
        for k in 1..=4 {
            filter.predict(at(100 * k), travel).unwrap();
        }
        for index in order {
            filter.update(heading(headings[index]));
            filter.update(Stamped::new(at(headings[index].0), wall_measurement(index % 2, [2.9, 0.2])));
        }
        filter.belief()
    };
    let (timely, late) = (drive([0, 1, 2]), drive([2, 0, 1]));
    assert!(timely.error(late.pose).iter().all(|off| off.abs() < 1e-12), "{timely:?} {late:?}");
    for i in 0..9 {
        let (a, b) = (timely.covariance.entry(i / 3, i % 3), late.covariance.entry(i / 3, i % 3));
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }
}

/// More walls than are distinguished, for a million steps: the covariance stays valid and close to that in `f64`.
fn endured<S: Float>() -> Belief<S> {
    let mut filter = filter::<S>().with_considered(&considered());
    let mut noise = Noise(8);
    for k in 1..=1_000_000_i64 {
        let phase = k as f64 * 0.01;
        let travel = [0.02 + 0.01 * phase.sin(), 0.02 - 0.01 * phase.sin()].map(S::from_f64);
        assert_eq!(filter.predict(at(20 * k), WheelPair::new(travel[0], travel[1])), Ok(()));
        let pose = filter.belief().pose;
        if k % 3 == 0 {
            let heading = Angle::from_radians(pose.heading.radians());
            let compass = HeadingMeasurement { heading, std: S::from_f64(1e-3) };
            filter.update(Stamped::new(at(20 * k), Measurement::Heading(compass)));
        }
        if k % 5 == 0 {
            let direction = Angle::from_radians(S::from_f64(((k / 5) % 9) as f64 * 0.7 - 3.0));
            let wall = Line::new(S::from_f64(2.0), direction);
            let seen_direction = direction - pose.heading;
            let distance = wall.distance_from(pose.origin()) + S::from_f64(1e-3 * noise.normal());
            let line = LineMeasurement {
                wall,
                seen: Line::new(distance, seen_direction),
                distance_variance: S::from_f64(1e-8),
                direction_variance: S::from_f64(1e-7),
                covariance: S::from_f64(0.0),
                wall_variance: S::from_f64(0.0),
            };
            filter.update(Stamped::new(at(20 * k), Measurement::Line(line)));
        }
        assert!(filter.belief().covariance.is_valid(), "step {k}: {:?}", filter.belief());
    }
    filter.belief()
}

#[test]
fn considered_covariance_stays_valid_for_a_million_steps_in_f32() {
    let (single, double) = (endured::<f32>(), endured::<f64>());
    for i in 0..3 {
        let (single, double) = (f64::from(single.covariance.std(i)), double.covariance.std(i));
        assert!((single / double - 1.0).abs() < 0.02, "component {i}: {single}, in f64 {double}");
    }
}

/// A compass that is wrong by five of its considered deviations is named, one that is wrong by one is not.
#[test]
fn wrong_compass_is_named_by_its_disagreement() {
    let named = |offset: f64| {
        let mut filter = filter::<f64>().with_considered(&considered());
        let mut noise = Noise(21);
        for k in 1..=100 {
            filter.predict(at(100 * k), WheelPair::zero()).unwrap();
            let heading = Angle::from_radians(offset + COMPASS_STD * noise.normal());
            filter.update(Stamped::new(
                at(100 * k),
                Measurement::Heading(HeadingMeasurement { heading, std: COMPASS_STD }),
            ));
            for (wall, (distance, direction)) in WALLS.into_iter().enumerate() {
                let seen =
                    [distance + LINE_STD[0] * noise.normal(), direction + LINE_STD[1] * noise.normal()];
                filter.update(Stamped::new(at(100 * k), wall_measurement(wall, seen)));
            }
        }
        filter.disagreement()
    };
    assert_eq!(named(0.02), None);
    assert_eq!(named(0.15), Some(DisagreeingSensor::Compass));
}
