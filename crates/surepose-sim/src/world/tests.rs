use surepose::geometry::{Angle, Pose};
use surepose::kinematics::{Integration, Twist, WheelPair};

use crate::arena::Arena;
use crate::fault::{Fault, FaultKind, Sensor};
use crate::random::Seed;
use crate::slip::Slip;

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
