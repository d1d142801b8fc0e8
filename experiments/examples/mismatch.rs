//! Drives in worlds that differ from the robot's models: `cargo run --release -p surepose-experiments --example mismatch [COUNT] [exact] [WORLD]`.
//!
//! Each world takes seeds 1 to COUNT (60) of the default scenario, as `surepose run --world` does. The filter considers typical model errors, with `exact` none; WORLD selects the worlds whose name contains it. The columns are shares of the drives: at the goal in truth;
//! at rest outside the tolerance while "reached" is believed, unflagged and flagged; ended for a named reason; ever lost; ever
//! flagged as inconsistent. Then the median and the largest NEES of a drive, the median time of the first flag, and the median
//! and largest final position error.

use std::process::ExitCode;

use surepose::safety::{FaultReason, Health, SafetyAction};
use surepose_config::Config;
use surepose_sim::WorldSettings;
use surepose_sim::robot::{Scenario, Sensors};
use surepose_sim::simulation::{Simulation, SimulationOutcome, SimulationSummary};

/// Name, differences of the world, and whether the robot has a compass and a laser.
const WORLDS: &[(&str, &[&str], [bool; 2])] = &[
    ("as modeled", &[], [true, true]),
    ("laser noise x 1.5", &["laser.range_std_m=0.045"], [true, true]),
    ("laser noise x 2", &["laser.range_std_m=0.06"], [true, true]),
    ("laser noise x 3", &["laser.range_std_m=0.09"], [true, true]),
    ("map 0.3 % too large", &["map.scale=1.003"], [true, true]),
    ("map 1 % too large", &["map.scale=1.01"], [true, true]),
    ("compass + 1°", &["compass.offset_deg=1"], [true, true]),
    ("compass + 3°", &["compass.offset_deg=3"], [true, true]),
    ("compass drifts 0.1°/s", &["compass.drift_deg_s=0.1"], [true, true]),
    ("laser stamps 0.1 s late", &["laser.latency_s=0.1"], [true, true]),
    ("all stamps 0.1 s late", &["laser.latency_s=0.1", "compass.latency_s=0.1"], [true, true]),
    ("slip x 5", &["filter.delta=0.0625"], [true, true]),
    ("clutter 45 %", &["clutter.fraction=0.45"], [true, true]),
    ("laser 3 cm forward", &["laser.x_m=0.03"], [true, true]),
    ("laser 3 cm left", &["laser.y_m=0.03"], [true, true]),
    ("laser turned by 2°", &["laser.heading_deg=2"], [true, true]),
    ("radius ratio + 2 %, compass", &["robot.wheel_radius_ratio=1.02"], [true, false]),
    ("radius ratio - 2 %, compass", &["robot.wheel_radius_ratio=0.98"], [true, false]),
    ("both radii + 2 %, odometry", &["robot.wheel_radius_m=0.051"], [false, false]),
    ("both radii - 2 %, odometry", &["robot.wheel_radius_m=0.049"], [false, false]),
    ("both radii + 2 %, compass", &["robot.wheel_radius_m=0.051"], [true, false]),
];

/// One drive.
struct Trial {
    summary: SimulationSummary,
    /// Time of the first flag `inconsistent` \[s], and whether it stands at the end.
    flagged: Option<f64>,
    is_flagged_at_end: bool,
    was_lost: bool,
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).peekable();
    let count = arguments.next_if(|text| text.parse::<u64>().is_ok()).map_or(60, |n| n.parse().unwrap_or(60));
    let config = match arguments.next_if(|text| text == "exact") {
        Some(_) => Config::default(),
        None => Config::default().with_typical_model_errors(),
    };
    let selected = arguments.next().unwrap_or_default();
    println!(
        "{:<28} good  missed flagged  ended   lost inconsistent  NEES p50    max  flag s  error mm p50   max",
        "world"
    );
    for (name, options, [compass, laser]) in WORLDS.iter().filter(|(name, ..)| name.contains(&selected)) {
        let Ok(world_settings) = WorldSettings::from_options(options.iter().copied()) else {
            eprintln!("{name}: not a world");
            return ExitCode::FAILURE;
        };
        let sensors = Sensors { compass: *compass, laser: *laser };
        let scenario = Scenario { config: config.clone(), world_settings, sensors, ..Scenario::default() };
        let trials: Vec<Trial> = (1..=count).map(|seed| drive(&scenario, seed)).collect();
        report(name, &trials);
    }
    ExitCode::SUCCESS
}

fn drive(scenario: &Scenario, seed: u64) -> Trial {
    let mut simulation = Simulation::new(scenario, seed);
    let (mut flagged, mut was_lost) = (None, false);
    while simulation.next().is_some() {
        let time = simulation.summary().time_s;
        was_lost |= simulation.health() == Health::Lost;
        if is_inconsistent(simulation.action()) {
            flagged = flagged.or(Some(time));
        }
    }
    let is_flagged_at_end = is_inconsistent(simulation.action());
    Trial { summary: simulation.summary(), flagged, is_flagged_at_end, was_lost }
}

fn is_inconsistent(action: SafetyAction) -> bool {
    matches!(
        action,
        SafetyAction::Slowdown(FaultReason::Inconsistent) | SafetyAction::Stop(FaultReason::Inconsistent)
    )
}

fn report(name: &str, trials: &[Trial]) {
    let share = |is: &dyn Fn(&Trial) -> bool| {
        let count = trials.iter().filter(|trial| is(trial)).count();
        format!("{:.0}%", 100.0 * count as f64 / trials.len() as f64)
    };
    let quantile = |value: &dyn Fn(&Trial) -> Option<f64>, part: f64| {
        let mut values: Vec<f64> = trials.iter().filter_map(value).collect();
        values.sort_by(f64::total_cmp);
        let index = (values.len().saturating_sub(1) as f64 * part).round() as usize;
        values.get(index).map_or("-".to_owned(), |value| format!("{value:.1}"))
    };
    let missed = |trial: &Trial| trial.summary.outcome == SimulationOutcome::Missed;
    let nees = |trial: &Trial| trial.summary.nees_mean;
    let error = |trial: &Trial| Some(1e3 * trial.summary.final_position_error_m);
    println!(
        "{name:<28} {:>4} {:>7} {:>7} {:>6} {:>6} {:>12} {:>9} {:>6} {:>7} {:>13} {:>5}",
        share(&|trial| trial.summary.outcome == SimulationOutcome::Reached),
        share(&|trial| missed(trial) && !trial.is_flagged_at_end),
        share(&|trial| missed(trial) && trial.is_flagged_at_end),
        share(&|trial| trial.summary.reason.is_some()),
        share(&|trial| trial.was_lost),
        share(&|trial| trial.flagged.is_some()),
        quantile(&nees, 0.5),
        quantile(&nees, 1.0),
        quantile(&|trial| trial.flagged, 0.5),
        quantile(&error, 0.5),
        quantile(&error, 1.0),
    );
}
