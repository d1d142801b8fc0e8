//! Bench of actuators: `cargo run --release -p surepose-experiments --example actuators [RUNS]`.
//!
//! Prints every cell with its success rate; exits with 1 if a cell fails. 640 cells of 150 trials take about a minute.

use std::process::ExitCode;

use surepose_experiments::actuators::{ActuatorCell, actuator_cells, arrives_or_says_why, overstated_cells};
use surepose_montecarlo::sweep::PlantReport;

fn main() -> ExitCode {
    let runs = std::env::args().nth(1).and_then(|runs| runs.parse().ok()).unwrap_or(150);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (mut failed, mut judged) = (0, 0);
    for cell in actuator_cells() {
        let Some((report, line)) = measured(&cell, runs, threads) else { return ExitCode::FAILURE };
        let passes = report.figures.success_rate >= Some(cell.required());
        if cell.is_feasible {
            judged += 1;
            failed += u32::from(!passes);
        }
        let result = match (cell.is_feasible, passes) {
            (false, _) => "not judged",
            (true, true) => "pass",
            (true, false) => "FAIL",
        };
        println!("{result:<10} {line}");
    }
    for cell in overstated_cells() {
        let Some((report, line)) = measured(&cell, runs, threads) else { return ExitCode::FAILURE };
        let passes = arrives_or_says_why(&report);
        (failed, judged) = (failed + u32::from(!passes), judged + 1);
        println!("{:<10} {line}", if passes { "pass" } else { "FAIL" });
    }
    println!("{failed} of {judged} cells fail");
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Runs a cell; returns its report and a line of its figures.
fn measured(cell: &ActuatorCell, runs: usize, threads: usize) -> Option<(PlantReport, String)> {
    let report = cell.run(runs, threads, 1).inspect_err(|error| eprintln!("{error}")).ok()?;
    let success = report.figures.success_rate?;
    let base = if cell.factors.is_empty() { "ideal".to_owned() } else { cell.factors.join(", ") };
    let noise = if cell.noisy { "bench" } else { "none" };
    let time = report.figures.time_s.map_or_else(|| "-".to_owned(), |time| format!("{:.1}", time.p50));
    let line = format!(
        "{success:.3}  {:.2} s  noise {noise:<5}  median {time:>5} s  timeouts {:>3}  aborted {:?}  {base}",
        cell.period, report.timeouts, report.aborted
    );
    Some((report, line))
}
