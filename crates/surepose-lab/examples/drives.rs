//! Many drives of the simulated robot, summed up: `cargo run --release -p surepose-lab --example drives [COUNT]`.
//!
//! The default scenario with the seeds 1 to COUNT (100), then twice as many random starts in the arena without its
//! plates for each direction of approach.

use std::process::ExitCode;

use surepose::param::{START_HEADING, START_X, START_Y};
use surepose_data::Config;
use surepose_lab::drive::{Outcome, Summary, drive};
use surepose_lab::rig::Scenario;
use surepose_sim::{Arena, Seed};

fn main() -> ExitCode {
    let count = std::env::args().nth(1).map_or(Ok(100), |count| count.parse::<u64>());
    let Ok(count) = count else {
        eprintln!("usage: drives [COUNT]");
        return ExitCode::from(2);
    };
    println!("               runs reached   nees  final error mm     final error °     time s   nearest");
    println!("                                     p50   p95   max      p95   max    p50   max   wall m");
    let default: Vec<Summary> = (1..=count).map(|seed| drive(&Scenario::default(), seed).1).collect();
    let mut all_reached = report("default", &default);
    for direction in ["auto", "forward", "reverse"] {
        let mut starts = Seed(0).stream("starts");
        let runs: Vec<Summary> = (1..=2 * count)
            .filter_map(|seed| {
                let start = [
                    (&START_X, starts.uniform(-1.5, 4.0)),
                    (&START_Y, starts.uniform(-1.5, 4.0)),
                    (&START_HEADING, starts.uniform(-180.0, 180.0)),
                ];
                let config = Config::default().with_preset("random start", &start);
                let config = config.with_option(&format!("law.direction={direction}")).ok()?;
                Some(drive(&Scenario::in_arena(Arena::open(), config), seed).1)
            })
            .collect();
        all_reached &= report(direction, &runs);
    }
    ExitCode::from(u8::from(!all_reached))
}

/// Prints one line; says whether all were reached within 1 cm and 1°.
fn report(name: &str, runs: &[Summary]) -> bool {
    let within = |run: &&Summary| {
        run.outcome == Outcome::Reached
            && run.final_position_error_m <= 0.01
            && run.final_heading_error_deg <= 1.0
    };
    let reached = runs.iter().filter(within).count();
    let nees = runs.iter().filter_map(|run| run.nees_mean).sum::<f64>() / runs.len() as f64;
    let sorted = |value: fn(&Summary) -> f64| {
        let mut values: Vec<f64> = runs.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        move |part: f64| values[((values.len() - 1) as f64 * part).round() as usize]
    };
    let position = sorted(|run| run.final_position_error_m * 1e3);
    let heading = sorted(|run| run.final_heading_error_deg);
    let time = sorted(|run| run.time_s);
    let wall = sorted(|run| run.closest_wall_m);
    println!(
        "{name:<12} {:>6} {reached:>7} {nees:>6.2} {:>6.2} {:>5.2} {:>5.2} {:>8.3} {:>5.3} {:>6.1} {:>5.1} {:>8.2}",
        runs.len(),
        position(0.5),
        position(0.95),
        position(1.0),
        heading(0.95),
        heading(1.0),
        time(0.5),
        time(1.0),
        wall(0.0),
    );
    reached == runs.len()
}
