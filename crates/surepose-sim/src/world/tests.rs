use surepose::geometry::{Angle, Pose};
use surepose::kinematics::{Integration, Twist, WheelPair};

use crate::arena::Arena;
use crate::fault::{Fault, FaultKind, ScanFault, Sensor};
use crate::gyroscope::GyroscopeModel;
use crate::plant::PlantModel;
use crate::random::Seed;
use crate::slip::{Slip, Traction};

use super::{SensorOutput, Timing, World, WorldModel};

fn world(model: WorldModel, seed: u64) -> World {
    World::new(model, Pose::new(2.0, 1.0, Angle::zero()), Seed(seed))
}

fn paper() -> WorldModel {
    WorldModel::paper(Arena::loop_world())
}

/// Drives `steps` steps of 0.1 s along a circle of 0.6 m radius.
fn circle(world: &mut World, steps: usize) -> Vec<SensorOutput> {
    let rates = world.model().drive.wheel_rates_from_twist(Twist::new(0.15, 0.25));
    (0..steps).map(|_| world.step(rates, 0.1)).collect()
}

#[test]
fn same_seed_gives_the_same_bits() {
    let run = |seed| format!("{:?}", circle(&mut world(paper(), seed), 50));
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn removing_a_sensor_does_not_change_the_others() {
    let (mut with, mut without) = (world(paper(), 1), world(WorldModel { laser: None, ..paper() }, 1));
    for (a, b) in circle(&mut with, 50).iter().zip(circle(&mut without, 50)) {
        assert_eq!((a.rims, &a.headings), (b.rims, &b.headings));
    }
    assert_eq!(with.pose(), without.pose());
}

#[test]
fn odometry_without_slip_matches_the_true_pose() {
    let mut world = world(WorldModel { slip: Slip { delta: 0.0 }, ..paper() }, 1);
    let mut pose = world.pose();
    let drive = world.model().drive;
    for sensed in circle(&mut world, 300) {
        pose = pose.integrate(drive.motion_from_travel(sensed.rims), Integration::Arc);
    }
    assert!(pose.origin().distance(world.pose().origin()) < 1e-3, "{pose:?} {:?}", world.pose());
    assert!((pose.heading - world.pose().heading).radians().abs() < 1e-3);
}

#[test]
fn wheel_travel_follows_the_setpoint_within_one_percent() {
    let mut world = world(paper(), 1);
    let sensed = circle(&mut world, 300);
    let (desired, mut rolled) = (world.model().drive.wheel_speeds_from_twist(Twist::new(0.15, 0.25)), 0.0);
    for sensed in &sensed[10..] {
        rolled += sensed.rims.right;
    }
    let ratio = rolled / (desired.right * 0.1 * 290.0);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn messages_have_measurement_stamps_and_arrive_after_their_latency() {
    let slow = |period, latency| Timing { period, latency };
    let mut model = paper();
    model.compass = model.compass.map(|(compass, _)| (compass, slow(0.05, 0.0)));
    model.laser = model.laser.map(|(laser, _)| (laser, slow(0.2, 0.13)));
    let sensed = circle(&mut world(model, 1), 10);

    let headings: Vec<_> = sensed[3].headings.iter().map(|h| h.stamp.nanoseconds() / 1_000_000).collect();
    assert_eq!(headings, [350, 400]);
    for sensed in &sensed {
        for scan in &sensed.scans {
            let age = sensed.stamp.since(scan.stamp);
            assert!((age - 0.2).abs() < 1e-9, "period 200 ms, latency 130 ms, step 100 ms: age {age}");
        }
    }
    assert_eq!(sensed.iter().map(|s| s.scans.len()).sum::<usize>(), 4);
}

#[test]
fn faults_are_active_in_their_interval_only() {
    let during = |kind| Fault::between(0.5, 1.0, kind);
    let faults = vec![
        during(FaultKind::Dropout(Sensor::Laser)),
        during(FaultKind::NotANumber(Sensor::Compass)),
        Fault::between(1.5, 2.0, FaultKind::NotANumber(Sensor::Encoders)),
        Fault::between(1.5, 2.0, FaultKind::StampOffset(Sensor::Compass, 3.0)),
    ];
    let mut world = world(WorldModel { faults, ..paper() }, 1);
    for sensed in circle(&mut world, 30) {
        let now = sensed.stamp.nanoseconds() / 1_000_000;
        assert_eq!(sensed.rims.right.is_nan(), (1500..2000).contains(&now), "encoders at {now} ms");
        for heading in &sensed.headings {
            let measured = sensed.stamp.since(heading.stamp);
            assert_eq!(measured > 1.0, (1600..2100).contains(&now), "age {measured} at {now} ms");
            assert_eq!(heading.value.radians().is_nan(), (600..1100).contains(&now), "compass at {now} ms");
        }
        assert_eq!(sensed.scans.is_empty(), now < 150 || (600..1100).contains(&now), "laser at {now} ms");
    }
    assert!(world.pose().x.is_finite());
}

#[test]
fn displacement_moves_the_robot_once_without_encoder_travel() {
    let pushed = Fault::at(0.5, FaultKind::Displaced([0.4, -0.2, 0.1]));
    let mut world = world(WorldModel { faults: vec![pushed], ..paper() }, 1);
    let at_rest = WheelPair::new(0.0, 0.0);
    let rolled: f64 = (0..10).map(|_| world.step(at_rest, 0.1).rims.max_abs()).sum();
    assert_eq!(rolled.to_bits(), 0.0_f64.to_bits());
    let pose = world.pose();
    assert!((pose.x - 2.4).abs() < 1e-12 && (pose.y - 0.8).abs() < 1e-12, "{pose:?}");
    assert!((pose.heading.radians() - 0.1).abs() < 1e-12);
}

#[test]
fn clock_rate_does_not_depend_on_the_period() {
    // 333 steps of 3 ms are 0.999 s; a third of 0.1 s is not a whole number of nanoseconds.
    for (period, steps) in
        [(0.001, 1000), (0.003, 333), (0.007, 143), (0.025, 40), (0.1 / 3.0, 30), (0.1, 10)]
    {
        let mut world = world(WorldModel { slip: Slip { delta: 0.0 }, ..paper() }, 1);
        let rates = world.model().drive.wheel_rates_from_twist(Twist::new(0.15, 0.25));
        let sensed: Vec<SensorOutput> = (0..steps).map(|_| world.step(rates, period)).collect();
        let time = period * f64::from(steps);
        assert!((world.now().seconds() - time).abs() < 1e-6, "{period}: {}", world.now().seconds());
        // One second suffices to reach the speed.
        let speed = world.twist().v;
        assert!((speed / 0.15 - 1.0).abs() < 0.1, "{period}: {speed}");
        // Headings come every 100 ms from 100 ms on, with 10 ms latency; the last one has not arrived yet.
        let headings: usize = sensed.iter().map(|sensed| sensed.headings.len()).sum();
        assert_eq!(headings, 9, "{period}");
    }
}

/// A base without noise whose wheels follow their setpoints.
fn ideal() -> WorldModel {
    let paper = paper();
    WorldModel {
        motor: crate::MotorModel { ideal: true, ticks_per_turn: 1e7, ..paper.motor },
        slip: Slip { delta: 0.0 },
        ..paper
    }
}

/// Drives straight ahead for `steps` steps of 0.1 s at 0.2 m/s; returns the true travel \[m] and the wheels'.
fn ahead(world: &mut World, steps: usize) -> [f64; 2] {
    let before = world.pose();
    let rates = world.model().drive.wheel_rates_from_twist(Twist::new(0.2, 0.0));
    let rolled = (0..steps).map(|_| world.step(rates, 0.1).rims.right).sum();
    [world.pose().origin().distance(before.origin()), rolled]
}

/// The world's motion is the closed form of its plant: delay, ramp and lag lose travel one after another.
#[test]
fn plant_delays_and_slows_the_robot() {
    let plant = PlantModel { command_delay: 0.2, wheel_acceleration: 0.4, lag: 0.3, ..PlantModel::default() };
    let [travel, rolled] = ahead(&mut world(WorldModel { plant, ..ideal() }, 1), 60);
    let lost = 0.2 * 0.2 + 0.2 * 0.2 / (2.0 * 0.4) + 0.2 * 0.3;
    assert!((travel - (0.2 * 6.0 - lost)).abs() < 1e-9, "{travel}");
    assert!((rolled - travel).abs() < 1e-6, "{rolled}");
}

#[test]
fn robot_in_its_dead_band_does_not_move() {
    for plant in [
        PlantModel { min_speed: 0.21, ..PlantModel::default() },
        PlantModel { min_wheel_speed: 0.21, ..PlantModel::default() },
        PlantModel { breakaway_speed: 0.21, ..PlantModel::default() },
    ] {
        let mut world = world(WorldModel { plant, ..paper() }, 1);
        let (before, [travel, rolled]) = (world.pose(), ahead(&mut world, 20));
        assert!(world.pose() == before && travel.max(rolled.abs()) < 1e-15, "{plant:?}");
    }
}

/// The encoders report the turn of the wheels, and the robot moves less.
#[test]
fn slipping_wheels_report_more_than_the_robot_moves() {
    let traction = Traction { slip_ratio: 0.1, ..Traction::default() };
    let [travel, rolled] = ahead(&mut world(WorldModel { traction, ..ideal() }, 1), 20);
    assert!((rolled - 0.4).abs() < 1e-6 && (travel - 0.36).abs() < 1e-9, "{travel} {rolled}");
    let traction = Traction { acceleration: 0.25, ..Traction::default() };
    let [travel, rolled] = ahead(&mut world(WorldModel { traction, ..ideal() }, 1), 20);
    let lost = 0.2 * 0.2 / (2.0 * 0.25);
    assert!((rolled - 0.4).abs() < 1e-6 && (travel - (0.4 - lost)).abs() < 1e-9, "{travel} {rolled}");
}

/// With the left wheel held the robot pivots about it, and its encoder reports nothing.
#[test]
fn robot_pivots_about_a_held_wheel() {
    let held = Fault::from(0.5, FaultKind::WheelsHeld { right: false, left: true });
    let mut world = world(WorldModel { faults: vec![held], ..ideal() }, 1);
    ahead(&mut world, 5);
    let before = world.pose();
    let rates = world.model().drive.wheel_rates_from_twist(Twist::new(0.2, 0.0));
    let sensed = world.step(rates, 0.1);
    assert!(((world.pose().heading - before.heading).radians() - 0.02 / 0.6).abs() < 1e-9);
    assert!(sensed.rims.left.abs() < 1e-6 && (sensed.rims.right - 0.02).abs() < 1e-6, "{:?}", sensed.rims);
    assert!((world.twist().omega - 0.2 / 0.6).abs() < 1e-9 && world.rim_speeds().left.abs() < 1e-15);
}

#[test]
fn faulty_scans_have_valid_stamps_and_useless_ranges() {
    let scans = |kind: Option<ScanFault>| {
        let faults = kind.map(|kind| Fault::from(1.0, FaultKind::Scan(kind)));
        let mut world = world(WorldModel { faults: faults.into_iter().collect(), ..paper() }, 1);
        circle(&mut world, 20).into_iter().flat_map(|sensed| sensed.scans).collect::<Vec<_>>()
    };
    let clean = scans(None);
    let is_useless = |kind, range: f64| match kind {
        ScanFault::Infinite => range == f64::INFINITY,
        ScanFault::NotANumber => range.is_nan(),
        ScanFault::Zero => range.to_bits() == 0,
        _ => range < 0.0,
    };
    for kind in [ScanFault::Infinite, ScanFault::NotANumber, ScanFault::Zero, ScanFault::Negative] {
        let faulty = scans(Some(kind));
        assert_eq!(faulty[..9], clean[..9], "{kind:?}");
        for (scan, clean) in faulty[9..].iter().zip(&clean[9..]) {
            assert_eq!((scan.stamp, scan.value.ranges.len()), (clean.stamp, 181));
            assert!(scan.value.ranges.iter().all(|range| is_useless(kind, *range)), "{kind:?}");
        }
    }
    assert!(scans(Some(ScanFault::Empty))[9..].iter().all(|scan| scan.value.ranges.is_empty()));
    for scan in &scans(Some(ScanFault::Frozen))[9..] {
        assert_eq!(scan.value.ranges, clean[8].value.ranges);
    }
}

/// Without noise the gyroscope reads the mean yaw rate; adding it changes no other sensor.
#[test]
fn gyroscope_reads_the_yaw_rate_alone() {
    let exact = GyroscopeModel { bias: 0.01, ..GyroscopeModel::default() };
    let (mut with, mut without) =
        (world(WorldModel { gyroscope: Some(exact), ..paper() }, 1), world(paper(), 1));
    let mut before = with.pose();
    for (sensed, clean) in circle(&mut with, 30).iter().zip(circle(&mut without, 30)) {
        assert!(sensed.yaw_rate.is_some());
        assert_eq!(
            (sensed.rims, &sensed.headings, &sensed.scans),
            (clean.rims, &clean.headings, &clean.scans)
        );
        assert_eq!(clean.yaw_rate, None);
    }
    let rates = with.model().drive.wheel_rates_from_twist(Twist::new(0.15, 0.25));
    for _ in 0..10 {
        before = with.pose();
        let read = with.step(rates, 0.1).yaw_rate.unwrap();
        let turned = (with.pose().heading - before.heading).radians();
        assert!((read - 0.01 - turned / 0.1).abs() < 1e-9, "{read} {turned}");
    }
    assert_ne!(before, with.pose());
}

/// A laser that is frozen from the start repeats its first scan.
#[test]
fn frozen_laser_repeats_its_first_scan() {
    let faults = vec![Fault::from(0.0, FaultKind::Scan(ScanFault::Frozen))];
    let sensed = circle(&mut world(WorldModel { faults, ..paper() }, 1), 20);
    let mut scans = sensed.iter().flat_map(|sensed| &sensed.scans);
    let first = scans.next().unwrap();
    assert!(scans.all(|scan| scan.value.ranges == first.value.ranges && scan.stamp > first.stamp));
}
