//! Drives on bases as they are: minimum speeds, delay, lag, slip, held wheels, a gyroscope; known to the robot or not.

#![allow(clippy::unwrap_used, reason = "tests panic on failed preconditions")]

use surepose_config::Config;
use surepose_sim::WorldSettings;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::{SimulationOutcome, SimulationSummary, simulate};

/// A drive in the paper's arena: `set` for robot and world, `world` for the world alone.
fn drive(set: &[&str], world: &[&str], seed: u64) -> SimulationSummary {
    let config = set.iter().fold(Config::default(), |config, option| config.with_option(option).unwrap());
    let mut scenario = Scenario::configured(config);
    scenario.world_settings = WorldSettings::from_options(world.iter().copied()).unwrap();
    simulate(&scenario, seed).1
}

fn assert_parked(summary: &SimulationSummary, what: &str) {
    assert_eq!(summary.outcome, SimulationOutcome::Reached, "{what}: {summary:?}");
    assert!(summary.final_position_error_m < 0.01 && summary.final_heading_error_deg < 1.0, "{what}");
    assert!(summary.time_s < 30.0, "{what}: {summary:?}");
}

#[test]
fn robots_park_on_bases_that_they_know() {
    let bases: [&[&str]; 7] = [
        &["robot.min_wheel_speed_m_s=0.03"],
        &["robot.min_speed_m_s=0.03"],
        &["robot.min_turn_rate_deg_s=5"],
        &["robot.min_speed_m_s=0.02", "robot.min_turn_rate_deg_s=4.6", "robot.command_delay_s=0.2"],
        &["robot.motor_time_constant_s=0.3"],
        &["robot.wheel_acceleration_limit_m_s2=0.1", "robot.wheel_deceleration_limit_m_s2=0.3"],
        &["robot.command_delay_s=0.3", "robot.motor_time_constant_s=0.2", "robot.min_wheel_speed_m_s=0.02"],
    ];
    for base in bases {
        for seed in 1..=2 {
            assert_parked(&drive(base, &[], seed), &format!("{base:?}, seed {seed}"));
        }
    }
}

#[test]
fn every_goal_ends_with_its_reason() {
    let ends: [(&[&str], &str); 3] = [
        (&["robot.min_wheel_speed_m_s=0.03"], "stalled"),
        (&["fault.held_wheels=both", "fault.held_from_s=3"], "blocked"),
        (&["fault.held_wheels=left", "fault.held_from_s=3"], "blocked"),
    ];
    for (world, reason) in ends {
        let summary = drive(&[], world, 1);
        assert_eq!(
            (summary.outcome, summary.reason),
            (SimulationOutcome::Stopped, Some(reason)),
            "{world:?}"
        );
        assert!(reason == "stalled" || summary.time_s < 13.5, "{world:?}: {summary:?}");
    }
}

/// Wheels that spin as they speed up, which the robot does not know: without the search after slip it is lost.
#[test]
fn robots_park_on_slippery_floors() {
    for gyroscope in ["no", "yes"] {
        for seed in 1..=4 {
            let gyroscope = format!("gyroscope.installed={gyroscope}");
            let world = ["slip.traction_limit_m_s2=0.15", "slip.ratio=0.1", gyroscope.as_str()];
            assert_parked(&drive(&[], &world, seed), &format!("{world:?}, seed {seed}"));
        }
    }
}

/// The mean NEES of drives with a gyroscope lies within the 95 % band of as many single draws of χ²₃.
#[test]
fn estimate_with_gyroscope_is_consistent() {
    let runs: Vec<_> = (1..=16).map(|seed| drive(&[], &["gyroscope.installed=yes"], seed)).collect();
    let nees = runs.iter().filter_map(|summary| summary.nees_mean).sum::<f64>() / runs.len() as f64;
    let band = 1.96 * (6.0 / runs.len() as f64).sqrt();
    assert!((nees - 3.0).abs() < band, "{nees}");
}
