//! The whole tick: whatever arrives and whenever, the wheels do what they can and the belief is that of its time.

use proptest::prelude::*;
use surepose::closed_loop::{Controller, Localiser, Progress, Sensed, Signal, tick};
use surepose::{
    Angle, Belief, Body, Compass, Direction, Drive, Ekf, Estimator, Eye, Gate, Goal, HybridLaw, Integration,
    Law, Limits, Map, Matcher, Measurement, Memory, Navigation, Point, Pose, RangeFinder, Recognition,
    Refusal, Rest, Scan, Stamp, Stamped, Tolerance, Travel, Twist, Wall, Wheels,
};

const PERIOD: f64 = 0.1;
const DRIVE: Drive<f64> = Drive::new(0.05, 0.6);
const LIMITS: Limits<f64> = Limits { wheel_speed: 0.3, wheel_acceleration: 0.5 };

fn controller() -> Controller<f64> {
    let tolerance = Tolerance { position: 0.01, heading: 0.017, hold: 1.0, release: 1.5 };
    Controller::fitted(DRIVE, LIMITS, PERIOD, Direction::Auto, tolerance)
}

fn localiser() -> Localiser<f64, 64, 61> {
    let ekf = Ekf { drive: DRIVE, delta: 0.0025, integration: Integration::Arc };
    let belief = Belief::new(Pose::new(1.0, 1.0, Angle::zero()), [0.02, 0.02, 0.01]);
    let laser = RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: 0.01,
        bearing_std: 0.002,
        nearest: 0.05,
        farthest: 10.0,
    };
    Localiser {
        estimator: Estimator::new(ekf, Gate::new(0.999), 1.0, at(0), belief),
        eye: Eye::new(laser, Recognition::Lines(Matcher::default())),
    }
}

/// A room of 4 m by 3 m.
fn room() -> Vec<Wall<f64>> {
    let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)].map(|(x, y)| Point::new(x, y));
    corners.windows(2).filter_map(|ends| Wall::between(ends[0], ends[1]).ok()).collect()
}

fn at(ticks: i64) -> Stamp {
    Stamp::from_nanoseconds(ticks * 100_000_000)
}

const FIRST: f64 = -1.5;
const STEP: f64 = 0.05;

/// How far the room's walls are from `pose`, without noise.
fn ranges(pose: Pose<Map, Body, f64>) -> Vec<f64> {
    let range = |i: usize| {
        let (sin, cos) = pose.heading.turned(FIRST + STEP * i as f64).sin_cos();
        let x = if cos > 0.0 { (4.0 - pose.x) / cos } else { -pose.x / cos };
        let y = if sin > 0.0 { (3.0 - pose.y) / sin } else { -pose.y / sin };
        x.min(y)
    };
    (0..61).map(range).collect()
}

fn scan(ranges: &[f64]) -> Signal<'_, f64> {
    Signal::Scan(Scan { first_bearing: Angle::wrapped(FIRST), bearing_step: STEP, ranges })
}

/// Both rims roll by this \[m] in a period.
fn rolled(rim: f64) -> Travel<f64> {
    Travel { rims: Wheels::new(rim, rim), variance: Wheels::new(1e-6, 1e-6) }
}

const NOTHING_TOLD: Travel<f64> =
    Travel { rims: Wheels { right: 0.0, left: 0.0 }, variance: Wheels { right: 0.0, left: 0.0 } };

#[test]
fn late_scan_is_read_from_where_the_robot_was() {
    let walls = room();
    // The robot starts 2 cm beside where it believes, and drives ahead at 2 cm a tick.
    let seen = ranges(Pose::new(1.02 + 0.02, 0.98, Angle::zero()));
    let ends = [1, 4].map(|arrival| {
        let mut localiser = localiser();
        for now in 1..=5 {
            let signals = [Stamped::new(at(1), scan(&seen))];
            let signals = if now == arrival { &signals[..] } else { &[] };
            let sensed = Sensed { stamp: at(now), travel: rolled(0.02), signals };
            localiser.sense(&sensed, NOTHING_TOLD, &walls, &mut ());
        }
        assert!(localiser.estimator.tally().accepted >= 2, "{arrival}: {:?}", localiser.estimator.tally());
        localiser.estimator.belief()
    });
    let [timely, late] = ends.map(|belief| belief.error(Pose::new(1.12, 0.98, Angle::zero())));
    for (timely, late) in timely.iter().zip(late) {
        assert!(timely.abs() < 0.006, "{timely}");
        assert!((timely - late).abs() < 1e-12, "{timely} and {late}");
    }
}

#[test]
fn scan_from_before_the_history_is_counted_as_stale() {
    let (walls, mut localiser) = (room(), localiser());
    let seen = ranges(Pose::new(1.0, 1.0, Angle::zero()));
    for now in 1..=30 {
        let signals = [Stamped::new(at(now - 20), scan(&seen))];
        let sensed = Sensed { stamp: at(now), travel: rolled(0.0), signals: &signals[..] };
        localiser.sense(&sensed, NOTHING_TOLD, &walls, &mut ());
    }
    assert_eq!(
        (localiser.estimator.tally().accepted, localiser.estimator.tally().refused(Refusal::Stale)),
        (0, 30)
    );
}

/// Encoders that say nothing usable: the robot is taken to have done what it was told, and to be unsure of it.
#[test]
fn refused_odometry_is_replaced_by_what_the_wheels_were_told() {
    let (mut controller, mut localiser) = (controller(), localiser());
    controller.limits.wheel_acceleration = 100.0;
    let goal: Pose<Map, Goal, f64> = Pose::new(3.0, 1.0, Angle::zero());
    let mut progress = Progress::fresh();
    // The third tick comes a period late.
    for now in [1, 2, 4] {
        let sensed = Sensed { stamp: at(now), travel: rolled(f64::NAN), signals: &[] };
        progress = tick(&controller, &mut localiser, &[], progress, &sensed, goal, &mut ()).step.progress;
    }
    let belief = localiser.estimator.belief();
    assert!((belief.pose.x - 1.09).abs() < 1e-9, "{belief:?}");
    assert!(belief.covariance.std(0) > 0.02 && localiser.estimator.stamp() == at(4), "{belief:?}");
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -4.0..4.0,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, -1e300, 0.0, 1e-300, 1e7]),
    ]
}

/// A configuration refuses such constants; firmware that has none of that gets a robot that stands.
#[test]
fn constants_that_no_robot_has_make_it_rest() {
    let usual = controller();
    let broken = [
        Controller { drive: Drive::new(0.0, 0.6), ..usual },
        Controller { drive: Drive::new(f64::NAN, 0.6), ..usual },
        Controller { drive: Drive::new(0.05, 0.0), ..usual },
        Controller { limits: Limits { wheel_speed: 0.0, ..LIMITS }, ..usual },
        Controller { limits: Limits { wheel_speed: f64::NAN, ..LIMITS }, ..usual },
        Controller { limits: Limits { wheel_acceleration: f64::NAN, ..LIMITS }, ..usual },
        Controller { period: f64::NAN, ..usual },
    ];
    let goal = Pose::new(1.0, 0.5, Angle::zero());
    for controller in broken {
        let mut progress = Progress::fresh();
        for pose in
            [Pose::identity(), Pose::new(1.0, 0.5, Angle::zero()), Pose::new(f64::NAN, 0.0, Angle::zero())]
        {
            let step = controller.step(progress, pose, goal);
            progress = step.progress;
            let wheels = step.wheels;
            assert!(wheels.right.is_finite() && wheels.left.is_finite(), "{controller:?}: {wheels:?}");
        }
    }
}

/// In no time nothing changes, and a zone of rest of no size is none.
#[test]
fn nothing_is_no_quotient() {
    let going = Twist::new(0.1, -0.2);
    assert_eq!(LIMITS.grant(&DRIVE, going, going, 0.0), going);
    let usual = HybridLaw::fitted(&DRIVE, &LIMITS, PERIOD, Direction::Forward);
    let there = Navigation { rho: 0.0, alpha: Angle::wrapped(-0.5), phi: Angle::zero() };
    let memory = Memory { near: true, ..Memory::fresh() };
    let twist = |rest| Law::Hybrid(HybridLaw { rest, ..usual }).decide(&there, memory).twist;
    assert_eq!(twist(Some(Rest::of(0.0, PERIOD))), twist(None));
    assert!(twist(None).omega < -0.1);
}

proptest! {
    /// Whatever arrives, the wheels are told something that they can do.
    #[test]
    fn nothing_breaks_the_loop(
        inputs in prop::collection::vec(
            (any_number(), any_number(), any_number(), -20_i64..2, prop::collection::vec(any_number(), 0..70)),
            1..30,
        ),
        goal in (any_number(), any_number(), any_number()),
    ) {
        let (controller, walls, mut localiser) = (controller(), room(), localiser());
        let goal = Pose::new(goal.0.clamp(-1e4, 1e4), goal.1.clamp(-1e4, 1e4), Angle::wrapped(goal.2));
        prop_assume!(goal.x.is_finite() && goal.y.is_finite() && goal.heading.radians().is_finite());
        let mut progress = Progress::fresh();
        for (now, (right, left, heading, lateness, mut seen)) in (1..).zip(inputs) {
            let true_ranges = ranges(localiser.estimator.belief().pose);
            for (range, right) in seen.iter_mut().zip(true_ranges).step_by(2) {
                *range = right;
            }
            let compass = Compass { heading: Angle::wrapped(heading), std: left.abs() };
            let signals = [
                Stamped::new(at(now + lateness), scan(&seen)),
                Stamped::new(at(now), Signal::Measurement(Measurement::Compass(compass))),
            ];
            let travel = Travel { rims: Wheels::new(right, left), variance: Wheels::new(heading, 1e-4) };
            let sensed = Sensed { stamp: at(now), travel, signals: &signals };
            let before = DRIVE.rims_from_twist(progress.granted);
            let tick = tick(&controller, &mut localiser, &walls, progress, &sensed, goal, &mut ());
            progress = tick.step.progress;
            let rims = DRIVE.rims_from_twist(tick.step.granted);
            let change = Wheels::new(rims.right - before.right, rims.left - before.left).largest();
            prop_assert!(rims.largest() <= LIMITS.wheel_speed + 1e-12, "{rims:?}");
            prop_assert!(change <= LIMITS.wheel_acceleration * PERIOD + 1e-12, "{change}");
            prop_assert!(tick.step.wheels.right.is_finite() && tick.step.wheels.left.is_finite());
            prop_assert!(tick.belief.pose.x.is_finite() && tick.belief.pose.y.is_finite());
            prop_assert!(tick.belief.pose.heading.radians().is_finite() && tick.belief.covariance.is_valid());
        }
    }
}
