//! Options of the bench trials, shared by `sweep` and `tune`.

use clap::{Args, ValueEnum};
use serde_json::{Value as Json, json};
use surepose::param::{self, Choice, LawName};
use surepose_config::{Config, Setting, ValueSource};
use surepose_experiments::actuators;
use surepose_montecarlo::sweep::{Filter, PlantSweep, PoseSource, Precision, Starts, Sweep, SweepNoise};
use surepose_sim::WorldSettings;

use crate::error::CliError;
use crate::settings::{LawArgs, whole};

/// The loop, its noise and the seed.
#[derive(Debug, Args)]
pub(super) struct TrialArgs {
    /// The control period, in seconds; default loop.period_s of the configuration, else 0.02
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    period: Option<String>,
    /// The source of the pose that the law uses
    #[arg(long = "loop", value_name = "LOOP", value_enum, default_value_t = LoopName::Bench)]
    pub(super) loop_: LoopName,
    /// The noise of the estimate or the sensors, and of the wheels; default bench, but none for `sweep` without --loop ekf
    #[arg(long, value_enum)]
    noise: Option<NoiseName>,
    /// The number of threads; default one per core
    #[arg(long, value_name = "N", value_parser = whole(1..=1024_u16), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// The seed of noise, random start poses and search
    #[arg(long, default_value_t = 1, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true)]
    pub(super) seed: u64,
    #[command(flatten)]
    config: LawArgs,
}

/// The options as read: the bench robot with the user's configuration on top, and the noise.
pub(super) struct Trials<'a> {
    pub(super) config: Config,
    bench: Config,
    noise: NoiseName,
    arguments: &'a TrialArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LoopName {
    /// The true pose, with white noise (the bench trial)
    Bench,
    /// The belief of the filter, from odometry, compass and walls
    Ekf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum NoiseName {
    /// No noise
    None,
    /// 5 mm and 0.3° on the estimate, 5 % on each wheel speed (standard deviations)
    Bench,
}

/// Standard deviation of the tick-to-tick noise of the filter's position \[m]: the white part of its 1.2 mm error.
const FILTER_JITTER: f64 = 5e-4;

impl TrialArgs {
    /// Reads the configuration; `noise_unless_given` is the default of `--noise`.
    pub(super) fn read(&self, noise_unless_given: NoiseName) -> Result<Trials<'_>, CliError> {
        let noise = self.noise.unwrap_or(noise_unless_given);
        let noise_of_loop = self.loop_.position_noise(noise.sizes());
        let bench = Config::default()
            .with_preset(BENCH, &actuators::BENCH)
            .with_preset(BENCH, &[(&param::POSITION_NOISE, noise_of_loop), (&param::PERIOD, 0.02)]);
        let mut config = self.config.over(bench.clone())?;
        if let Some(period) = &self.period {
            config = config.with_option_of("--period", &format!("loop.period_s={period}"))?;
        }
        Ok(Trials { config, bench, noise, arguments: self })
    }
}

impl Trials<'_> {
    /// Returns the settings of the trials, for the JSON result.
    pub(super) fn described(&self) -> [(&'static str, Json); 4] {
        [
            ("loop", json!(name(&self.arguments.loop_))),
            ("noise", json!(name(&self.noise))),
            ("period_s", json!(self.config.number(&param::PERIOD))),
            ("law", json!(self.config.choice::<LawName>().name())),
        ]
    }

    /// Returns the parameters, as `SECTION.KEY`, that the user changed but the trials ignore. `has_base`: the trials run
    /// on the base of a world.
    pub(super) fn ignored_parameters(&self, has_base: bool) -> Vec<String> {
        let counts = |setting: &Setting| match setting.parameter.section {
            "law" | "loop" => true,
            "robot" => has_base && setting.parameter != &param::FOOTPRINT_RADIUS,
            "goal" => has_base,
            "safety" => {
                has_base && [&param::STALL_TIMEOUT, &param::PROGRESS_TIMEOUT].contains(&setting.parameter)
            }
            "filter" if self.arguments.loop_ == LoopName::Ekf => {
                [&param::DELTA, &param::GATE_PROBABILITY].contains(&setting.parameter)
            }
            _ => false,
        };
        let is_set =
            |setting: &Setting| matches!(setting.origin, ValueSource::File { .. } | ValueSource::CommandLine);
        // Both lists are in the order of the parameter table.
        let settings = self.config.settings().iter().zip(self.bench.settings());
        settings
            .filter(|(set, bench)| is_set(set) && set.value != bench.value && !counts(set))
            .map(|(set, _)| format!("{}.{}", set.parameter.section, set.parameter.key))
            .collect()
    }

    /// Returns the sweep that runs these trials on the base of a world that differs from the configuration.
    pub(super) fn plant_sweep(&self, world: WorldSettings, starts: Starts) -> PlantSweep {
        let TrialArgs { threads, seed, .. } = self.arguments;
        let threads = threads.map_or_else(cores, usize::from);
        actuators::plant_sweep(self.config.clone(), world, self.noise.sizes(), starts, threads, *seed)
    }

    /// Returns the sweep that runs these trials.
    pub(super) fn sweep(&self, starts: Starts, precision: Precision) -> Sweep {
        let TrialArgs { loop_, threads, seed, .. } = self.arguments;
        Sweep {
            starts,
            law: self.config.law(),
            period: self.config.number(&param::PERIOD),
            noise: self.noise.sizes(),
            estimate: loop_.estimate(&self.config),
            precision,
            threads: threads.map_or_else(cores, usize::from),
            seed: *seed,
        }
    }
}

impl NoiseName {
    fn sizes(self) -> SweepNoise {
        match self {
            Self::None => SweepNoise::NONE,
            Self::Bench => SweepNoise::BENCH,
        }
    }
}

/// Returns the name of a choice on the command line.
pub(super) fn name(choice: &impl ValueEnum) -> String {
    choice.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// The origin of the bench robot's values.
const BENCH: &str = "bench";

impl LoopName {
    /// Returns the configured position noise of the law \[m]: the standard deviation from tick to tick.
    fn position_noise(self, noise: SweepNoise) -> f64 {
        match self {
            Self::Bench => noise.position,
            Self::Ekf => FILTER_JITTER,
        }
    }

    /// Returns the source of the pose that the law uses.
    fn estimate(self, config: &Config) -> PoseSource {
        match self {
            Self::Bench => PoseSource::Given,
            Self::Ekf => PoseSource::Filtered(Filter {
                delta: config.number(&param::DELTA),
                gate_probability: config.number(&param::GATE_PROBABILITY),
                ..Filter::BENCH
            }),
        }
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
