//! Drives with a laser whose scan takes as long as its period.

#![allow(clippy::unwrap_used, reason = "tests panic on failed preconditions")]

use surepose::estimation::Belief;
use surepose::kinematics::WheelPair;
use surepose::lidar::{ScanTiming, StampedBeam};
use surepose::safety::Health;
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::owned_map::OwnedMap;
use surepose_sim::robot::{Scenario, Sensors, walls_from_segments, with_sensor_input};
use surepose_sim::simulation::{Simulation, SimulationOutcome, SimulationSummary, simulate};
use surepose_sim::{Seed, World};

/// Scenario with a sweep of 0.1 s over `degrees`; the robot is configured rightly.
fn swept(degrees: u32, stamped: &str) -> Scenario {
    let beams = degrees + 1;
    let options = [
        format!("laser.field_of_view_deg={degrees}"),
        format!("laser.beams={beams}"),
        "laser.sweep_s=0.1".to_owned(),
        format!("laser.stamp={stamped}"),
    ];
    let config = options.iter().fold(Config::default(), |config, option| config.with_option(option).unwrap());
    Scenario::configured(config)
}

fn mean_nees(runs: &[SimulationSummary]) -> f64 {
    runs.iter().filter_map(|run| run.nees_mean).sum::<f64>() / runs.len() as f64
}

#[test]
fn swept_scans_park_the_robot_whichever_beam_is_stamped() {
    for degrees in [270, 360] {
        for stamped in ["first", "middle", "last"] {
            let mut runs = Vec::new();
            for seed in 1..=4 {
                let mut simulation = Simulation::new(&swept(degrees, stamped), seed);
                while simulation.next().is_some() {
                    assert_ne!(simulation.health(), Health::Lost, "{degrees}° {stamped} seed {seed}");
                }
                let summary = simulation.summary();
                assert_eq!(summary.outcome, SimulationOutcome::Reached, "{degrees}° {stamped}: {summary:?}");
                assert!(summary.final_position_error_m < 0.003, "{degrees}° {stamped}: {summary:?}");
                runs.push(summary);
            }
        }
    }
}

/// The estimate is as consistent as with a laser that measures all beams at once.
#[test]
fn estimates_by_swept_scans_are_consistent() {
    let runs: Vec<_> = (1..=12).map(|seed| simulate(&swept(270, "first"), seed).1).collect();
    let band = 1.96 * (6.0 / runs.len() as f64).sqrt();
    let nees = mean_nees(&runs);
    assert!((nees - 3.0).abs() < band, "{nees}");
}

/// Largest position \[m] and heading \[rad] error of a robot that turns at full rate, then drives on a circle, and whether it
/// was lost. `timing` is what the robot assumes of its laser.
fn errors_at_full_rate(scenario: &Scenario, timing: &ScanTiming, seed: u64) -> (f64, f64, bool) {
    let start = scenario.start();
    let belief = Belief::new(start, scenario.start_std);
    let config = &scenario.config;
    let mut navigator = config.navigator(&scenario.navigator_setup(), Stamp::default(), belief);
    let mut world = World::new(scenario.world(), start, Seed(seed));
    let map = OwnedMap::from_walls(walls_from_segments(scenario.arena.walls()));
    let (mut position, mut heading, mut is_lost) = (0.0_f64, 0.0_f64, false);
    let rate = config.drive().wheel_angle_from_travel(WheelPair::new(0.3, 0.3)).right;
    for step in 0..600 {
        let wheels = match step / 100 {
            0 | 1 => WheelPair::new(rate, -rate),
            2 | 3 => WheelPair::new(-rate, rate),
            4 => WheelPair::new(rate, 0.2 * rate),
            _ => WheelPair::new(-0.2 * rate, -rate),
        };
        let output = world.step(wheels, 0.1);
        let report =
            with_sensor_input(&output, &config.compass(), timing, |input| navigator.step(&map.view(), input));
        is_lost |= report.health == Health::Lost;
        let error = report.belief.error(world.pose());
        position = position.max(error[0].hypot(error[1]));
        heading = heading.max(error[2].abs());
    }
    (position, heading, is_lost)
}

#[test]
fn robot_that_turns_at_full_rate_is_not_lost() {
    for degrees in [270, 360] {
        for stamped in ["first", "middle", "last"] {
            let scenario =
                Scenario { sensors: Sensors { compass: false, laser: true }, ..swept(degrees, stamped) };
            let timing = scenario.config.laser().timing;
            let (position, heading, is_lost) = errors_at_full_rate(&scenario, &timing, 1);
            let neglected = ScanTiming { sweep: Some(0.0), stamped: StampedBeam::First };
            let without = errors_at_full_rate(&scenario, &neglected, 1);
            assert!(
                !is_lost && position < 0.03 && heading < 0.02,
                "{degrees}° {stamped}: {position} m, {heading} rad"
            );
            assert!(
                without.2 && without.1 > 3.0 * heading,
                "{degrees}° {stamped}: {without:?} without deskewing"
            );
        }
    }
}
