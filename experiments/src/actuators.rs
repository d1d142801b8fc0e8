//! Bench of actuators: parking trials on bases with delay, lag, dead bands and weak motors.
//!
//! Each cell of the bench is one base, one control period and one noise, with trials from random starts. The robot
//! runs the controller and the actuator stage of its configuration, which describes the base; a cell may also have a
//! base that differs from the configuration.

use surepose::navigator::AbortReason;
use surepose::param::{self, Parameter};
use surepose_config::{Config, ConfigError};
use surepose_montecarlo::sweep::{PlantReport, PlantSweep, Starts, SweepNoise};
use surepose_sim::robot::Scenario;
use surepose_sim::{CancelToken, WorldSettings};

/// Control periods of the bench \[s].
pub const PERIODS: [f64; 4] = [0.02, 0.05, 0.1, 0.2];

/// Success rates that every cell must have, without noise and with the noise of the bench.
pub const REQUIRED: [f64; 2] = [0.99, 0.97];

/// The robot of the bench, which has no acceleration limit: the largest valid value has the same effect.
pub const BENCH: [(&Parameter, f64); 4] = [
    (&param::WHEEL_RADIUS, 0.05),
    (&param::WHEEL_SEPARATION, 0.6),
    (&param::WHEEL_SPEED_LIMIT, 0.3),
    (&param::WHEEL_ACCELERATION_LIMIT, 1000.0),
];

/// Returns the sweep of a robot with `config` on the base of a world that differs from it.
pub fn plant_sweep(
    config: Config,
    world_settings: WorldSettings,
    noise: SweepNoise,
    starts: Starts,
    threads: usize,
    seed: u64,
) -> PlantSweep {
    let scenario = Scenario { config, world_settings, ..Scenario::default() };
    let (world, config) = (scenario.world(), &scenario.config);
    PlantSweep {
        starts,
        controller: config.controller(),
        actuator: config.actuator(),
        stall_timeout: config.number(&param::STALL_TIMEOUT),
        progress_timeout: config.number(&param::PROGRESS_TIMEOUT),
        drive: world.drive,
        plant: world.plant,
        traction: world.traction,
        noise,
        threads,
        seed,
    }
}

/// One cell: a base, a period and a noise.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorCell {
    /// Factors of the base, by name; empty for an ideal one.
    pub factors: Vec<&'static str>,
    /// Control period \[s].
    pub period: f64,
    /// Whether the estimate and the wheels have the noise of the bench.
    pub noisy: bool,
    /// Options of robot and world: `SECTION.KEY=VALUE`.
    told: Vec<String>,
    /// Options of the world alone.
    world: Vec<String>,
    /// Whether one period at the least speed moves less than the tolerance.
    pub is_feasible: bool,
}

/// A factor of the bench: one deviation of a base from an ideal one.
struct Factor {
    name: &'static str,
    /// Factors of one kind are not combined with each other.
    kind: &'static str,
    told: fn(period: f64) -> String,
    world: Option<&'static str>,
    /// Motion of one period at the least speed \[m] and \[°], per second of the period.
    least: [f64; 2],
}

const NONE: [f64; 2] = [0.0, 0.0];

/// Rim speeds of 10, 20 and 30 mm/s, and the turn rates in place of wheels at these speeds.
const FACTORS: [Factor; 14] = [
    delay("delay 1 tick", |period| format!("robot.command_delay_s={period}")),
    delay("delay 2 ticks", |period| format!("robot.command_delay_s={}", 2.0 * period)),
    delay("delay 3 ticks", |period| format!("robot.command_delay_s={}", 3.0 * period)),
    Factor {
        name: "lag 0.3 s",
        kind: "lag",
        told: |_| "robot.motor_time_constant_s=0.3".to_owned(),
        world: None,
        least: NONE,
    },
    dead_band("wheels 10 mm/s", |_| "robot.min_wheel_speed_m_s=0.01".to_owned(), [0.01, 1.91]),
    dead_band("wheels 20 mm/s", |_| "robot.min_wheel_speed_m_s=0.02".to_owned(), [0.02, 3.82]),
    dead_band("wheels 30 mm/s", |_| "robot.min_wheel_speed_m_s=0.03".to_owned(), [0.03, 5.73]),
    dead_band("speed 10 mm/s", |_| "robot.min_speed_m_s=0.01".to_owned(), [0.01, 0.0]),
    dead_band("speed 20 mm/s", |_| "robot.min_speed_m_s=0.02".to_owned(), [0.02, 0.0]),
    dead_band("speed 30 mm/s", |_| "robot.min_speed_m_s=0.03".to_owned(), [0.03, 0.0]),
    turn("turn rate 1.9 °/s", |_| "robot.min_turn_rate_deg_s=1.91".to_owned(), [0.0, 1.91]),
    turn("turn rate 3.8 °/s", |_| "robot.min_turn_rate_deg_s=3.82".to_owned(), [0.0, 3.82]),
    turn("turn rate 5.7 °/s", |_| "robot.min_turn_rate_deg_s=5.73".to_owned(), [0.0, 5.73]),
    Factor {
        name: "acceleration 0.1 m/s²",
        kind: "acceleration",
        told: |_| "robot.wheel_acceleration_limit_m_s2=0.1".to_owned(),
        world: Some("robot.wheel_acceleration_limit_m_s2=0.1"),
        least: NONE,
    },
];

const fn delay(name: &'static str, told: fn(f64) -> String) -> Factor {
    Factor { name, kind: "delay", told, world: None, least: NONE }
}

const fn dead_band(name: &'static str, told: fn(f64) -> String, least: [f64; 2]) -> Factor {
    Factor { name, kind: "dead band", told, world: None, least }
}

const fn turn(name: &'static str, told: fn(f64) -> String, least: [f64; 2]) -> Factor {
    Factor { name, kind: "turn rate", told, world: None, least }
}

/// Tolerance of the bench \[m] and \[°].
const TOLERANCE: [f64; 2] = [0.01, 1.0];

/// Returns every cell: no factor, each factor alone and all pairs of factors of different kinds.
pub fn actuator_cells() -> Vec<ActuatorCell> {
    let mut bases: Vec<Vec<&Factor>> = vec![Vec::new()];
    for (index, factor) in FACTORS.iter().enumerate() {
        bases.push(vec![factor]);
        let others = FACTORS[index + 1..].iter().filter(|other| other.kind != factor.kind);
        bases.extend(others.map(|other| vec![factor, other]));
    }
    let mut cells = Vec::new();
    for period in PERIODS {
        for noisy in [false, true] {
            cells.extend(bases.iter().map(|base| cell(base, period, noisy)));
        }
    }
    cells
}

/// Returns the cells of a weak base that claims to be strong: acceleration 0.1 m/s², configured as 0.5 m/s².
pub fn overstated_cells() -> Vec<ActuatorCell> {
    let cell = |(period, noisy)| ActuatorCell {
        factors: vec!["acceleration 0.1 m/s² configured as 0.5"],
        period,
        noisy,
        told: vec!["robot.wheel_acceleration_limit_m_s2=0.5".to_owned()],
        world: vec!["robot.wheel_acceleration_limit_m_s2=0.1".to_owned()],
        is_feasible: true,
    };
    PERIODS.into_iter().flat_map(|period| [(period, false), (period, true)]).map(cell).collect()
}

/// Whether every trial of a base that claims to be stronger than it is succeeds or ends with `no_progress`.
pub fn arrives_or_says_why(report: &PlantReport) -> bool {
    report.timeouts == 0 && report.aborted.keys().all(|reason| *reason == AbortReason::NoProgress.name())
}

fn cell(base: &[&Factor], period: f64, noisy: bool) -> ActuatorCell {
    let fits = |factor: &&Factor| {
        factor.least.iter().zip(TOLERANCE).all(|(speed, tolerance)| speed * period < tolerance)
    };
    ActuatorCell {
        factors: base.iter().map(|factor| factor.name).collect(),
        period,
        noisy,
        told: base.iter().map(|factor| (factor.told)(period)).collect(),
        world: base.iter().filter_map(|factor| factor.world.map(str::to_owned)).collect(),
        is_feasible: base.iter().all(fits),
    }
}

impl ActuatorCell {
    /// Runs `runs` trials of the cell from random starts.
    ///
    /// # Errors
    /// [`ConfigError`] for an option that does not exist.
    pub fn run(&self, runs: usize, threads: usize, seed: u64) -> Result<PlantReport, ConfigError> {
        let noise = if self.noisy { SweepNoise::BENCH } else { SweepNoise::NONE };
        let cell = [(&param::PERIOD, self.period), (&param::POSITION_NOISE, noise.position)];
        let mut config = Config::default().with_preset("bench", &BENCH).with_preset("bench", &cell);
        for option in &self.told {
            config = config.with_option(option)?;
        }
        let world = WorldSettings::from_options(self.world.iter().map(String::as_str))?;
        let sweep = plant_sweep(config, world, noise, Starts::Random(runs), threads, seed);
        Ok(sweep.run(&CancelToken::default()))
    }

    /// Returns the success rate that the cell must have.
    pub fn required(&self) -> f64 {
        REQUIRED[usize::from(self.noisy)]
    }
}
