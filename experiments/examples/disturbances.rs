//! Parking under disturbances:
//! `cargo run --release -p surepose-experiments --example disturbances [DRIVES] [PART OF A NAME] [SECONDS] [CLUTTER] [SENSORS]`.
//!
//! The default scenario with seeds 1 to DRIVES (40). Each disturbance starts SECONDS (4) after the start;
//! obstacles that are not on the map hide a fraction CLUTTER (0) of the scan. SENSORS is `laser+compass`
//! (default) or `laser`.

use std::process::ExitCode;

use surepose_sim::robot::{Scenario, Sensors};
use surepose_sim::simulation::{SimulationOutcome, simulate};
use surepose_sim::{Clutter, Fault, FaultKind, Sensor};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Ok(count) = arguments.first().map_or(Ok(40), |count| count.parse::<u64>()) else {
        eprintln!("usage: disturbances [DRIVES] [PART OF A NAME] [SECONDS] [CLUTTER] [SENSORS]");
        return ExitCode::from(2);
    };
    let number =
        |index: usize, usual: f64| arguments.get(index).and_then(|text| text.parse().ok()).unwrap_or(usual);
    let (start, clutter) = (number(2, 4.0), Clutter { fraction: number(3, 0.0), width: 5.0 });
    let sensors = Sensors { compass: arguments.get(4).is_none_or(|sensors| sensors != "laser"), laser: true };
    let filter = arguments.get(1).map_or("", String::as_str);
    println!(
        "{:30} {:>6} {:>6} {:>9} {:>9} {:>9} {:>9}  not parked",
        "", "parked", "lost", "NEES", "x,y m", "θ °", "time s"
    );
    for (name, fault) in disturbances(start).into_iter().filter(|(name, _)| name.contains(filter)) {
        let scenario =
            Scenario { faults: fault.into_iter().collect(), clutter, sensors, ..Scenario::default() };
        let runs: Vec<_> = (1..=count).map(|seed| simulate(&scenario, seed).1).collect();
        let is_parked = |run: &surepose_sim::simulation::SimulationSummary| {
            run.outcome == SimulationOutcome::Reached
                && run.final_position_error_m <= 0.01
                && run.final_heading_error_deg <= 1.0
        };
        let mean = |of: &dyn Fn(&surepose_sim::simulation::SimulationSummary) -> Option<f64>| {
            runs.iter().filter_map(of).sum::<f64>() / runs.len() as f64
        };
        let square = |value: Option<f64>| value.map(|value| value * value);
        let unparked: Vec<u64> = runs.iter().filter(|run| !is_parked(run)).map(|run| run.seed).collect();
        println!(
            "{name:30} {:6} {:6} {:9.2} {:9.3} {:9.2} {:9.1}  {:?}",
            runs.len() - unparked.len(),
            runs.iter().filter(|run| run.stop_reason == Some("lost")).count(),
            mean(&|run| run.nees_mean),
            mean(&|run| square(run.position_rmse_m)).sqrt(),
            mean(&|run| square(run.heading_rmse_deg)).sqrt(),
            mean(&|run| Some(run.time_s)),
            &unparked[..unparked.len().min(12)],
        );
    }
    ExitCode::SUCCESS
}

/// Returns the disturbances by name; each starts `start` \[s] after the start of the drive.
fn disturbances(start: f64) -> Vec<(String, Option<Fault>)> {
    let mut all = vec![("nothing".to_owned(), None)];
    for push in [
        [0.02, 0.0, 0.0],
        [0.05, 0.0, 0.0],
        [0.0, 0.05, 0.0],
        [0.1, 0.0, 0.0],
        [-0.15, 0.1, 0.0],
        [0.2, 0.1, 0.0],
        [0.4, -0.3, 0.0],
    ] {
        all.push((format!("pushed {push:?} m"), Some(Fault::at(start, FaultKind::Displaced(push)))));
    }
    for turned in [2.0_f64, 5.0, 15.0] {
        let push = [0.0, 0.0, turned.to_radians()];
        all.push((format!("turned {turned}°"), Some(Fault::at(start, FaultKind::Displaced(push)))));
    }
    for (off, during) in [(0.05, 1.0), (0.1, 1.0), (-0.1, 1.0), (0.1, 3.0), (0.5, 0.5)] {
        let fault = Fault::between(start, start + during, FaultKind::Offset(Sensor::Laser, off));
        all.push((format!("ranges off {off} m, {during} s"), Some(fault)));
    }
    for (off, during) in [(3.0_f64, 1.0), (10.0, 1.0), (30.0, 3.0)] {
        let fault =
            Fault::between(start, start + during, FaultKind::Offset(Sensor::Compass, off.to_radians()));
        all.push((format!("compass off {off}°, {during} s"), Some(fault)));
    }
    for (off, during) in [(0.1, 1.0), (0.3, 1.0), (-1.0, 1.0)] {
        let fault = Fault::between(start, start + during, FaultKind::Offset(Sensor::Encoders, off));
        all.push((format!("rims off by {off}, {during} s"), Some(fault)));
    }
    all
}
