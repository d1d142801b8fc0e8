//! Drives with a laser that sends scans and sees nothing, and drives through open space.

#![allow(clippy::unwrap_used, reason = "tests panic on failed preconditions")]

use surepose::estimation::Belief;
use surepose::kinematics::WheelPair;
use surepose::navigator::{AbortReason, GoalResult};
use surepose::safety::BlockReason;
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::owned_map::OwnedMap;
use surepose_sim::robot::{Scenario, walls_from_segments, with_sensor_input};
use surepose_sim::{Arena, Seed, SimulatedScan, World};

/// Result of a drive.
#[derive(Debug)]
struct TestDrive {
    /// Time from the first changed scan until the robot rested \[s]; `None` if it did not.
    rested_after: Option<f64>,
    blocked_by: Option<BlockReason>,
    result: Option<GoalResult>,
}

/// Drives to the goal of the scenario; from 3 s on, `change` spoils each scan.
fn drive(scenario: &Scenario, mut change: impl FnMut(&mut SimulatedScan)) -> TestDrive {
    let config = &scenario.config;
    let belief = Belief::new(scenario.start(), scenario.start_std);
    let mut navigator = config.navigator(&scenario.navigator_setup(), Stamp::default(), belief);
    let map = OwnedMap::from_walls(walls_from_segments(scenario.arena.walls()));
    navigator.set_goal(&map.view(), scenario.goal()).unwrap();
    let mut world = World::new(scenario.world(), scenario.start(), Seed(1));
    let mut drive = TestDrive { rested_after: None, blocked_by: None, result: None };
    let (mut wheels, mut first) = (WheelPair::zero(), None);
    while drive.result.is_none() && world.now().seconds() < 60.0 {
        let mut output = world.step(wheels, 0.1);
        if world.now().seconds() > 3.0 {
            for scan in &mut output.scans {
                change(&mut scan.value);
                first = first.or(Some(output.stamp));
            }
        }
        let timing = config.laser().timing;
        let report = with_sensor_input(&output, &config.compass(), &timing, |input| {
            navigator.step(&map.view(), input)
        });
        wheels = report.command.map_or(WheelPair::zero(), |command| command.wheels);
        drive.result = report.result;
        drive.blocked_by = report.blocked_by.or(drive.blocked_by);
        let rests = world.rim_speeds().max_abs() < 0.01;
        if let Some(first) = first.filter(|_| rests && drive.rested_after.is_none()) {
            drive.rested_after = Some(world.now().since(first));
        }
    }
    drive
}

fn all(value: f64) -> impl FnMut(&mut SimulatedScan) {
    move |scan| scan.ranges.fill(value)
}

#[track_caller]
fn assert_stops(drive: &TestDrive, within: f64) {
    assert!(drive.rested_after.is_some_and(|time| time <= within), "{drive:?}");
    assert_eq!(drive.blocked_by, Some(BlockReason::LaserBlind), "{drive:?}");
    let aborted = GoalResult::Aborted(AbortReason::Blocked(BlockReason::LaserBlind));
    assert_eq!(drive.result, Some(aborted), "{drive:?}");
}

#[test]
fn robot_with_a_blind_laser_stops_within_a_second() {
    let scenario = Scenario::default();
    for value in [f64::NAN, f64::INFINITY, 0.0, -1.0, 200.0] {
        assert_stops(&drive(&scenario, all(value)), 1.0);
    }
    assert_stops(&drive(&scenario, |scan| scan.ranges.clear()), 1.0);
    assert_stops(&drive(&scenario, |scan| scan.angle_increment = 0.0), 1.0);
    assert_stops(&drive(&scenario, |scan| scan.ranges[2..].fill(f64::NAN)), 1.0);
}

/// The robot moves by three noise widths until it is certain that the scan should have changed.
#[test]
fn robot_with_a_frozen_laser_stops() {
    let mut frozen = None;
    let freeze = |scan: &mut SimulatedScan| *scan = frozen.get_or_insert_with(|| scan.clone()).clone();
    assert_stops(&drive(&Scenario::default(), freeze), 1.0);
}

/// A hall with walls far beyond the range of the laser: no beam ever returns.
#[test]
fn robot_parks_in_open_space() {
    let hall = Arena::rectangle("hall", (-40.0, -40.0), (40.0, 40.0), &[]);
    for goal in ["scenario.goal_heading_deg=30", "scenario.goal_heading_deg=-150"] {
        let scenario = Scenario::in_arena(hall.clone(), Config::default().with_option(goal).unwrap());
        let drive = drive(&scenario, |scan| assert!(scan.ranges.iter().all(|range| *range == f64::INFINITY)));
        assert_eq!((drive.result, drive.blocked_by), (Some(GoalResult::Reached), None), "{drive:?}");
    }
}
