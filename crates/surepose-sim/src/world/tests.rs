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

/// `steps` steps of 0.1 s along a circle of 0.6 m radius.
fn circle(world: &mut World, steps: usize) -> Vec<SensorOutput> {
    let rates = world.model().drive.wheel_rates_from_twist(Twist::new(0.15, 0.25));
    (0..steps).map(|_| world.step(rates, 0.1)).collect()
}

#[test]
fn same_seed_same_bits() {
    let run = |seed| format!("{:?}", circle(&mut world(paper(), seed), 50));
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn sensor_left_out_changes_nothing_about_the_others() {
    let (mut with, mut without) = (world(paper(), 1), world(WorldModel { laser: None, ..paper() }, 1));
    for (a, b) in circle(&mut with, 50).iter().zip(circle(&mut without, 50)) {
        assert_eq!((a.rims, &a.headings), (b.rims, &b.headings));
    }
    assert_eq!(with.pose(), without.pose());
}

#[test]
fn odometry_without_slip_ends_where_the_robot_does() {
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
fn wheels_roll_as_wanted_within_what_motor_and_slip_allow() {
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
fn messages_carry_the_time_of_measurement_and_arrive_late() {
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
            assert!(
                (age - 0.2).abs() < 1e-9,
                "measured every 200 ms, 130 ms late, asked every 100 ms: {age}"
            );
        }
    }
    assert_eq!(sensed.iter().map(|s| s.scans.len()).sum::<usize>(), 4);
}

#[test]
fn faults_happen_in_their_time_and_only_then() {
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
fn push_moves_the_robot_once_and_encoders_do_not_see_it() {
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
fn time_passes_as_fast_whatever_the_period() {
    // 333 of 3 ms are 0.999 s; a third of a tenth is no whole number of nanoseconds.
    for (period, steps) in
        [(0.001, 1000), (0.003, 333), (0.007, 143), (0.025, 40), (0.1 / 3.0, 30), (0.1, 10)]
    {
        let mut world = world(WorldModel { slip: Slip { delta: 0.0 }, ..paper() }, 1);
        let rates = world.model().drive.wheel_rates_from_twist(Twist::new(0.15, 0.25));
        let sensed: Vec<SensorOutput> = (0..steps).map(|_| world.step(rates, period)).collect();
        let time = period * f64::from(steps);
        assert!((world.now().seconds() - time).abs() < 1e-6, "{period}: {}", world.now().seconds());
        // The wheels have had a second for what they reach in a fraction of one.
        let speed = world.twist().v;
        assert!((speed / 0.15 - 1.0).abs() < 0.1, "{period}: {speed}");
        // Every 100 ms, from 100 ms on; the last arrives 10 ms after that, where there still is time.
        let headings: usize = sensed.iter().map(|sensed| sensed.headings.len()).sum();
        assert_eq!(headings, 9, "{period}");
    }
}
