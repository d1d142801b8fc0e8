//! Throughput of the sweep:
//! `cargo run --release -p surepose-montecarlo --example floor f64|f32 none|bench|ekf paper|fitted [THREADS [ROBOTS [PERIODS]]]`.
//!
//! Every robot drives for the same number of periods of 0.02 s, by default 10 000 for 400 robots, for
//! comparison with hand-written programs. The paper's law has the gains 4, 8, ½, 2 and a capture radius of 30
//! mm. Without noise the errors shrink until, after about 500 periods, they are subnormal in `f32`, which
//! slows processors down.

use std::process::ExitCode;

use surepose::control::{Direction, Gains, Law, Tran2012Law};
use surepose_montecarlo::sweep::{Filter, PoseSource, Precision, Starts, Sweep, SweepNoise, fitted_law};

const PERIOD: f64 = 0.02;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((sweep, periods)) = sweep(&arguments) else {
        eprintln!("usage: floor f64|f32 none|bench|ekf paper|fitted [THREADS [ROBOTS [PERIODS]]]");
        return ExitCode::from(2);
    };
    let best = (0..5).map(|_| sweep.periods_per_second(periods)).fold(0.0, f64::max);
    println!("{} on {}: {:.1} Msteps/s", arguments.join(" "), surepose_simd::instruction_set(), best * 1e-6);
    ExitCode::SUCCESS
}

fn sweep(arguments: &[String]) -> Option<(Sweep, u64)> {
    let text = |k: usize| arguments.get(k).map(String::as_str);
    let number = |k: usize, default: usize| text(k).map_or(Some(default), |text| text.parse().ok());
    let precision = match text(0)? {
        "f64" => Precision::F64,
        "f32" => Precision::F32,
        _ => return None,
    };
    let (noise, estimate) = match text(1)? {
        "none" => (SweepNoise::NONE, PoseSource::Given),
        "bench" => (SweepNoise::BENCH, PoseSource::Given),
        "ekf" => (SweepNoise::BENCH, PoseSource::Filtered(Filter::BENCH)),
        _ => return None,
    };
    let law = match text(2)? {
        "paper" => Law::Tran2012(Tran2012Law {
            gains: Gains { k_v: 4.0, k_alpha: 8.0, h: 0.5, k_theta: 2.0 },
            capture_radius: 0.03,
            capture_heading: core::f64::consts::PI,
        }),
        "fitted" => fitted_law(PERIOD, Direction::Auto, noise),
        _ => return None,
    };
    let starts = Starts::Random(number(4, 10_000)?);
    let sweep =
        Sweep { starts, law, period: PERIOD, noise, estimate, precision, threads: number(3, 1)?, seed: 1 };
    Some((sweep, number(5, 400)? as u64))
}
