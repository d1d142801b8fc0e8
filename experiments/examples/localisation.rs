//! Localization accuracy in the loop world: `cargo run --release -p surepose-experiments --example localisation RUNS
//! [BEAMS]`.

use std::process::ExitCode;

use surepose::param::LASER_BEAMS;
use surepose_config::Config;
use surepose_experiments::reproduce::{Configuration, LoopWorld, extraction, localization};
use surepose_sim::{CancelToken, Clutter};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>().ok());
    let runs = arguments.next().flatten().unwrap_or(20);
    let beams = arguments.next().flatten().unwrap_or(181);
    for (name, clutter) in [
        ("clean", Clutter::default()),
        ("20 % single", Clutter { fraction: 0.2, width: 1.0 }),
        ("20 % in groups of 6", Clutter { fraction: 0.2, width: 6.0 }),
    ] {
        let config = Config::default().with_preset("localisation", &[(&LASER_BEAMS, beams as f64)]);
        let Ok(world) = LoopWorld::new(&config, clutter) else { return ExitCode::FAILURE };
        println!("{name}, {beams} beams, {runs} runs");
        for configuration in Configuration::ALL {
            if let Some(a) = localization(&world, configuration, 1..runs + 1, &CancelToken::default()) {
                let (position, heading) = (a.position_rmse * 1e3, a.heading_rmse.to_degrees());
                println!(
                    "  {:<24} {position:8.3} mm {heading:7.4}° NEES {:.3}",
                    configuration.name(),
                    a.nees_mean
                );
            }
        }
        let considered = world.clone().with_model_errors(&config);
        let cancel = CancelToken::default();
        if let Some(a) = localization(&considered, Configuration::Both, 1..runs + 1, &cancel) {
            let (position, heading) = (a.position_rmse * 1e3, a.heading_rmse.to_degrees());
            println!("  with considered errors   {position:8.3} mm {heading:7.4}° NEES {:.3}", a.nees_mean);
        }
        let Some(e) = extraction(&world, 1..runs.min(50) + 1, &CancelToken::default()) else { continue };
        println!(
            "  found {} of {}, line NEES {:.3} over {}, spurious {}, wrong {} of {}",
            e.found,
            e.visible,
            e.line_nees_mean().unwrap_or(f64::NAN),
            e.lines,
            e.spurious,
            e.wrong,
            e.matched
        );
    }
    ExitCode::SUCCESS
}
