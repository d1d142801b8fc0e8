//! Statistics of kidnapped-robot trials:
//! `cargo run --release -p surepose-experiments --example kidnappings -- [TRIALS] [CLUTTER] [ARENA or MAP.yaml] [FIRST SEED] [SENSORS]`
//! with SENSORS `laser` or `laser+compass`; by default both in turn.

use surepose::geometry::{Body, Map, Pose};
use surepose_config::{Config, ScanMethod};
use surepose_experiments::kidnapping::{KidnappingSetup, SpawnArea, run_trial, run_trials};
use surepose_io::map_server;
use surepose_sim::robot::Sensors;
use surepose_sim::{Arena, Clutter};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number =
        |index: usize, usual: f64| arguments.get(index).and_then(|text| text.parse().ok()).unwrap_or(usual);
    let (trials, fraction, first) = (number(0, 50.0) as u64, number(1, 0.0), number(3, 1.0) as u64);
    let name = arguments.get(2).map_or("paper", String::as_str);
    let (area, scan_method) = match Arena::named(name) {
        Some(arena) => (SpawnArea::anywhere(arena), ScanMethod::Lines),
        None => match map_server::read(name.as_ref()) {
            Ok((grid, _)) => (SpawnArea::on_grid("map", &grid), ScanMethod::Beams),
            Err(error) => {
                eprintln!("{error}");
                return;
            }
        },
    };
    println!("{} walls", area.arena.walls().len());
    let filter = |name: &str| arguments.get(4).is_none_or(|filter| filter == name);
    let without = Sensors { compass: false, laser: true };
    let sets = [("laser+compass", Sensors::ALL), ("laser", without)];
    for (_, sensors) in sets.into_iter().filter(|(name, _)| filter(name)) {
        let clutter = Clutter { fraction, width: 5.0 };
        let setup = KidnappingSetup { config: Config::default(), sensors, scan_method, clutter };
        let sum = run_trials(&area, &setup, first..first + trials);
        println!("{name} {sensors:?} clutter {fraction}: {sum:?}");
        println!("flagged {:.4} recovered {:.4}", sum.flagged_share(), sum.recovered_share());
        for seed in sum.failed_seeds.iter().chain(&sum.late_seeds).take(24) {
            let trial = run_trial(&area, &setup, *seed);
            let pose = |at: Pose<Map, Body, f64>| {
                format!("({:.2}, {:.2}, {:.0}°)", at.x, at.y, at.heading.degrees())
            };
            println!(
                "  {seed}: {} to {}, flagged {:.2?}, found {:.2?}, NEES {:.1?}, error {:.3} m{}",
                pose(trial.from),
                pose(trial.to),
                trial.flagged,
                trial.found,
                trial.found_nees,
                trial.final_error,
                if trial.confidently_wrong { ", confidently wrong" } else { "" }
            );
        }
    }
}
