//! The complete step: commands within the limits and a valid belief for every input and stamp.

use proptest::prelude::*;
use surepose::control::{
    Controller, ControllerState, Deadband, Direction, HybridLaw, HybridState, Law, Limits,
    NavigationVariables, Tolerance,
};
use surepose::estimation::{
    Belief, DelayedEkf, Ekf, Gate, HeadingMeasurement, Measurement, RejectReason, WheelOdometry,
};
use surepose::geometry::{Angle, Body, Goal, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
use surepose::lidar::{LineAssociator, RangeFinder, Scan, ScanModel, ScanProcessor};
use surepose::localization::{
    AcceptanceCriteria, LocalSearch, Localizer, MonitorConfig, Odometry, SensorInput, SensorReading,
};
use surepose::map::{MapView, Wall};
use surepose::navigator::{Navigator, NavigatorConfig};
use surepose::safety::{CollisionConfig, Footprint, SupervisorConfig};
use surepose::time::{Stamp, Stamped};

const PERIOD: f64 = 0.1;
const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
const LIMITS: Limits<f64> = Limits::symmetric(0.3, 0.5);

fn controller() -> Controller<f64> {
    let tolerance = Tolerance { position: 0.01, heading: 0.017, dwell: 1.0, hysteresis: 1.5 };
    Controller::fitted(DRIVE, LIMITS, PERIOD, Direction::Auto, tolerance)
}

fn laser() -> RangeFinder<f64> {
    RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: 0.01,
        bearing_std: 0.002,
        range_min: 0.05,
        range_max: 10.0,
    }
}

fn localizer() -> Localizer<f64, 64, 61> {
    let ekf = Ekf { drive: DRIVE, delta: 0.0025, integration: Integration::Arc };
    let belief = Belief::new(Pose::new(1.0, 1.0, Angle::zero()), [0.02, 0.02, 0.01]);
    Localizer::unsupervised(
        DelayedEkf::new(ekf, Gate::new(0.999), 1.0, at(0), belief),
        ScanProcessor::new(laser(), ScanModel::Lines(LineAssociator::default())),
    )
}

/// Localizer with supervision and relocalization.
fn supervised() -> Localizer<f64, 64, 61> {
    let monitor = MonitorConfig {
        supervisor: SupervisorConfig::default(),
        acceptance: AcceptanceCriteria::default(),
        local_search: LocalSearch::from_scan_std([0.002, 0.002, 0.001]),
        relocalization_std: [0.0; 3],
        local_search_interval: 0.8,
    };
    let localizer = localizer();
    let scan_processor = ScanProcessor::new(laser(), ScanModel::Lines(LineAssociator::default()));
    Localizer::new(*localizer.estimator(), scan_processor, monitor)
}

/// Navigator with the default thresholds.
fn config() -> NavigatorConfig<f64> {
    let usual = NavigatorConfig::new(controller(), Footprint::Circle(0.3));
    NavigatorConfig { collision: CollisionConfig { obstacle_clearance: 0.1, ..usual.collision }, ..usual }
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

/// Computes the ranges to the walls of the room from `pose`, without noise.
fn ranges(pose: Pose<Map, Body, f64>) -> Vec<f64> {
    let range = |i: usize| {
        let (sin, cos) = pose.heading.rotated_by(FIRST + STEP * i as f64).sin_cos();
        let x = if cos > 0.0 { (4.0 - pose.x) / cos } else { -pose.x / cos };
        let y = if sin > 0.0 { (3.0 - pose.y) / sin } else { -pose.y / sin };
        x.min(y)
    };
    (0..61).map(range).collect()
}

fn scan(ranges: &[f64]) -> SensorReading<'_, f64> {
    SensorReading::Scan(Scan::new(Angle::from_radians(FIRST), STEP, ranges))
}

/// Creates an input with equal rim travel \[m] of both wheels in one period.
fn odometry(rim: f64) -> Odometry<f64> {
    Odometry::WithVariance(WheelOdometry {
        travel: WheelPair::new(rim, rim),
        variance: WheelPair::new(1e-6, 1e-6),
    })
}

const NO_COMMAND: WheelOdometry<f64> = WheelOdometry {
    travel: WheelPair { right: 0.0, left: 0.0 },
    variance: WheelPair { right: 0.0, left: 0.0 },
};

#[test]
fn late_scan_is_processed_at_its_stamp() {
    let walls = room();
    // The robot starts 2 cm beside its estimate and drives 2 cm per tick.
    let seen = ranges(Pose::new(1.02 + 0.02, 0.98, Angle::zero()));
    let ends = [1, 4].map(|arrival| {
        let mut localizer = localizer();
        for now in 1..=5 {
            let readings = [Stamped::new(at(1), scan(&seen))];
            let readings = if now == arrival { &readings[..] } else { &[] };
            let input = SensorInput { stamp: at(now), odometry: odometry(0.02), readings };
            localizer.update(&input, NO_COMMAND, &MapView::from_walls(&walls), &mut ());
        }
        assert!(
            localizer.estimator().measurement_stats().accepted >= 2,
            "{arrival}: {:?}",
            localizer.estimator().measurement_stats()
        );
        localizer.estimator().belief()
    });
    let [timely, late] = ends.map(|belief| belief.error(Pose::new(1.12, 0.98, Angle::zero())));
    for (timely, late) in timely.iter().zip(late) {
        assert!(timely.abs() < 0.006, "{timely}");
        assert!((timely - late).abs() < 1e-12, "{timely} and {late}");
    }
}

#[test]
fn scan_from_before_the_history_is_counted_as_stale() {
    let (walls, mut localizer) = (room(), localizer());
    let seen = ranges(Pose::new(1.0, 1.0, Angle::zero()));
    for now in 1..=30 {
        let readings = [Stamped::new(at(now - 20), scan(&seen))];
        let input = SensorInput { stamp: at(now), odometry: odometry(0.0), readings: &readings[..] };
        localizer.update(&input, NO_COMMAND, &MapView::from_walls(&walls), &mut ());
    }
    assert_eq!(
        (
            localizer.estimator().measurement_stats().accepted,
            localizer.estimator().measurement_stats().rejected(RejectReason::Stale)
        ),
        (0, 30)
    );
}

/// Rejected odometry: the filter predicts by the command, with a variance as large as the travel.
#[test]
fn rejected_odometry_is_replaced_by_the_command() {
    let mut config = config();
    config.controller.limits.wheel_acceleration = 100.0;
    let mut navigator = Navigator::new(config, localizer());
    let goal: Pose<Map, Goal, f64> = Pose::new(3.0, 1.0, Angle::zero());
    navigator.set_goal(&MapView::empty(), goal).unwrap();
    // The third step is one period late.
    for now in [1, 2, 4] {
        let input = SensorInput { stamp: at(now), odometry: odometry(f64::NAN), readings: &[] };
        navigator.step(&MapView::empty(), &input);
    }
    let belief = navigator.localizer().belief();
    assert!((belief.pose.x - 1.09).abs() < 1e-9, "{belief:?}");
    assert!(belief.covariance.std(0) > 0.02 && navigator.localizer().stamp() == at(4), "{belief:?}");
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -4.0..4.0,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, -1e300, 0.0, 1e-300, 1e7]),
    ]
}

/// The configuration rejects such constants. Without a configuration, as in firmware, the robot stays at rest.
#[test]
fn invalid_constants_stop_the_wheels() {
    let usual = controller();
    let broken = [
        Controller { drive: DiffDrive::new(0.0, 0.6), ..usual },
        Controller { drive: DiffDrive::new(f64::NAN, 0.6), ..usual },
        Controller { drive: DiffDrive::new(0.05, 0.0), ..usual },
        Controller { limits: Limits { wheel_speed: 0.0, ..LIMITS }, ..usual },
        Controller { limits: Limits { wheel_speed: f64::NAN, ..LIMITS }, ..usual },
        Controller { limits: Limits { wheel_acceleration: f64::NAN, ..LIMITS }, ..usual },
        Controller { period: f64::NAN, ..usual },
    ];
    let goal = Pose::new(1.0, 0.5, Angle::zero());
    for controller in broken {
        let mut state = ControllerState::new();
        for pose in
            [Pose::identity(), Pose::new(1.0, 0.5, Angle::zero()), Pose::new(f64::NAN, 0.0, Angle::zero())]
        {
            let step = controller.step(state, pose, goal);
            state = step.state;
            let wheels = step.wheels;
            assert!(wheels.right.is_finite() && wheels.left.is_finite(), "{controller:?}: {wheels:?}");
        }
    }
}

/// A period of 0 changes nothing, and a deadband of size 0 has no effect.
#[test]
fn zero_period_and_zero_deadband_are_identities() {
    let going = Twist::new(0.1, -0.2);
    assert_eq!(LIMITS.limit(&DRIVE, going, going, 0.0), going);
    let usual = HybridLaw::fitted(&DRIVE, &LIMITS, PERIOD, Direction::Forward);
    let there = NavigationVariables { rho: 0.0, alpha: Angle::from_radians(-0.5), phi: Angle::zero() };
    let memory = HybridState { local_mode: true, ..HybridState::new() };
    let twist = |rest| Law::Hybrid(HybridLaw { deadband: rest, ..usual }).compute(&there, memory).twist;
    assert_eq!(twist(Some(Deadband::from_noise(0.0, PERIOD))), twist(None));
    assert!(twist(None).omega < -0.1);
}

proptest! {
    /// Every input yields a command within the limits and a finite belief.
    #[test]
    fn every_input_yields_feasible_commands(
        inputs in prop::collection::vec(
            (any_number(), any_number(), any_number(), -20_i64..2, prop::collection::vec(any_number(), 0..70)),
            1..30,
        ),
        goal in (any_number(), any_number(), any_number()),
    ) {
        let walls = room();
        let map = MapView::from_walls(&walls);
        let mut navigator = Navigator::new(config(), supervised());
        let goal = Pose::new(goal.0.clamp(-1e4, 1e4), goal.1.clamp(-1e4, 1e4), Angle::from_radians(goal.2));
        prop_assume!(goal.x.is_finite() && goal.y.is_finite() && goal.heading.radians().is_finite());
        navigator.set_goal(&MapView::empty(), goal).unwrap();
        let mut previous = Twist::zero();
        for (now, (right, left, heading, lateness, mut seen)) in (1..).zip(inputs) {
            let true_ranges = ranges(navigator.localizer().belief().pose);
            for (range, right) in seen.iter_mut().zip(true_ranges).step_by(2) {
                *range = right;
            }
            let compass = HeadingMeasurement { heading: Angle::from_radians(heading), std: left.abs() };
            let readings = [
                Stamped::new(at(now + lateness), scan(&seen)),
                Stamped::new(at(now), SensorReading::Measurement(Measurement::Heading(compass))),
            ];
            let odometry = Odometry::WheelTravel(WheelPair::new(right, left));
            let report = navigator.step(&map, &SensorInput { stamp: at(now), odometry, readings: &readings });
            let twist = report.command.map_or(Twist::zero(), |command| command.twist);
            let speeds = DRIVE.wheel_speeds_from_twist(twist);
            prop_assert!(speeds.max_abs() <= LIMITS.wheel_speed + 1e-12, "{:?}", report);
            let change = DRIVE.wheel_speeds_from_twist(twist - previous).max_abs();
            prop_assert!(change <= LIMITS.wheel_acceleration * PERIOD + 1e-12, "{:?}", report);
            let pose = report.belief.pose;
            prop_assert!(pose.x.is_finite() && pose.y.is_finite() && pose.heading.radians().is_finite());
            prop_assert!(report.belief.covariance.is_valid());
            previous = twist;
        }
    }
}
