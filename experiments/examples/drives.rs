//! Statistics of many simulated drives: `cargo run --release -p surepose-experiments --example drives [COUNT]`.
//!
//! The default scenario with seeds 1 to COUNT (100), then, for each direction of approach, twice as many
//! random starts in the arena without its plates. Every drive is checked. It must end within 1 cm and 1° of
//! the goal. No commanded wheel speed or acceleration may exceed its limit. No number of the time series may
//! be NaN or infinite.

use std::process::ExitCode;

use surepose::control::{Direction, Limits};
use surepose::param::{Choice, START_HEADING, START_X, START_Y};
use surepose_config::Config;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::{Sample, SimulationOutcome, SimulationSummary, simulate};
use surepose_sim::{Arena, Seed};

fn main() -> ExitCode {
    let count = std::env::args().nth(1).map_or(Ok(100), |count| count.parse::<u64>());
    let Ok(count) = count else {
        eprintln!("usage: drives [COUNT]");
        return ExitCode::from(2);
    };
    println!(
        "               runs reached   nees  final error mm     final error °     time s   nearest  max. use of limit %  NaN"
    );
    println!(
        "                                     p50   p95   max      p95   max    p50   max   wall m      speed  accel."
    );
    let default: Vec<Run> = (1..=count).map(|seed| Run::of(&Scenario::default(), seed)).collect();
    let mut all_right = report("default", &default);
    for &direction in Direction::ALL {
        let mut starts = Seed(0).stream("starts");
        let runs: Vec<Run> = (1..=2 * count)
            .map(|seed| {
                let start = [
                    (&START_X, starts.uniform(-1.5, 4.0)),
                    (&START_Y, starts.uniform(-1.5, 4.0)),
                    (&START_HEADING, starts.uniform(-180.0, 180.0)),
                ];
                let config = Config::default().with_preset("random start", &start);
                let config = config.with_preset_choice("direction", direction);
                Run::of(&Scenario::in_arena(Arena::open(), config), seed)
            })
            .collect();
        all_right &= report(direction.name(), &runs);
    }
    ExitCode::from(u8::from(!all_right))
}

/// A drive with the limits of its robot.
struct Run {
    summary: SimulationSummary,
    limits: Limits<f64>,
    /// Number of NaN or infinite values in its time series.
    broken: usize,
}

impl Run {
    fn of(scenario: &Scenario, seed: u64) -> Self {
        let (samples, summary) = simulate(scenario, seed);
        let broken = samples.iter().map(broken).sum();
        Self { summary, limits: scenario.config.limits(), broken }
    }

    fn is_parked(&self) -> bool {
        let SimulationSummary { outcome, final_position_error_m, final_heading_error_deg, .. } = self.summary;
        outcome == SimulationOutcome::Reached
            && final_position_error_m <= 0.01
            && final_heading_error_deg <= 1.0
    }

    /// Returns maximum commanded wheel speed and acceleration over their limits.
    fn use_of_limits(&self) -> [f64; 2] {
        [
            self.summary.wheel_speed_max_m_s / self.limits.wheel_speed,
            self.summary.wheel_acceleration_max_m_s2 / self.limits.wheel_acceleration,
        ]
    }
}

/// Counts the NaN or infinite numbers of a row, which JSON writes as null.
fn broken(sample: &Sample) -> usize {
    match serde_json::to_value(sample) {
        Ok(serde_json::Value::Object(row)) => row.values().filter(|value| value.is_null()).count(),
        _ => 1,
    }
}

/// Prints one line and returns whether all checks passed.
fn report(name: &str, runs: &[Run]) -> bool {
    let reached = runs.iter().filter(|run| run.is_parked()).count();
    let broken: usize = runs.iter().map(|run| run.broken).sum();
    let [speed, acceleration] = runs
        .iter()
        .map(Run::use_of_limits)
        .fold([0.0_f64; 2], |worst, used| [worst[0].max(used[0]), worst[1].max(used[1])]);
    let nees = runs.iter().filter_map(|run| run.summary.nees_mean).sum::<f64>() / runs.len() as f64;
    let sorted = |value: fn(&SimulationSummary) -> f64| {
        let mut values: Vec<f64> = runs.iter().map(|run| value(&run.summary)).collect();
        values.sort_by(f64::total_cmp);
        move |part: f64| values[((values.len() - 1) as f64 * part).round() as usize]
    };
    let position = sorted(|run| run.final_position_error_m * 1e3);
    let heading = sorted(|run| run.final_heading_error_deg);
    let time = sorted(|run| run.time_s);
    let wall = sorted(|run| run.closest_wall_m);
    println!(
        "{name:<12} {:>6} {reached:>7} {nees:>6.2} {:>6.2} {:>5.2} {:>5.2} {:>8.3} {:>5.3} {:>6.1} {:>5.1} {:>8.2} {:>10.6} {:>8.6} {broken:>4}",
        runs.len(),
        position(0.5),
        position(0.95),
        position(1.0),
        heading(0.95),
        heading(1.0),
        time(0.5),
        time(1.0),
        wall(0.0),
        100.0 * speed,
        100.0 * acceleration,
    );
    // A limit may be exceeded by rounding: rims are computed from v and ω and vice versa.
    let within = |used: f64| used <= 1.0 + 1e-12;
    reached == runs.len() && broken == 0 && within(speed) && within(acceleration)
}
