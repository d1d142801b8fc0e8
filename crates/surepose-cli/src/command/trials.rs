//! What trials of the bench need to be told, in `sweep` and `tune` alike.

use clap::{Args, ValueEnum};
use serde_json::{Value as Json, json};
use surepose::param;
use surepose_config::{Config, Setting, ValueSource};
use surepose_montecarlo::sweep::{Filter, PoseSource, Precision, Starts, Sweep, SweepNoise};

use crate::error::CliError;
use crate::settings::{LawArgs, whole};

/// The loop, its noise, and what they are drawn from.
#[derive(Debug, Args)]
pub(super) struct TrialArgs {
    /// Time between two ticks, in seconds; the configuration's, or 0.02, unless given
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    period: Option<String>,
    /// What tells the law where the robot is
    #[arg(long = "loop", value_name = "LOOP", value_enum, default_value_t = LoopName::Bench)]
    pub(super) loop_: LoopName,
    /// What is wrong with the estimate or the sensors, and with the wheels; unless given, bench, and for `sweep` without --loop ekf none
    #[arg(long, value_enum)]
    noise: Option<NoiseName>,
    /// How many threads; all cores unless given
    #[arg(long, value_name = "N", value_parser = whole(1..=1024_u16), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// What all noise, all random starts and a search are drawn from
    #[arg(long, default_value_t = 1, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true)]
    pub(super) seed: u64,
    #[command(flatten)]
    config: LawArgs,
}

/// The same, read: the configuration of the bench's robot with the user's over it, and how it is driven.
pub(super) struct Trials<'a> {
    pub(super) config: Config,
    bench: Config,
    noise: NoiseName,
    arguments: &'a TrialArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LoopName {
    /// The bench trial: the true pose, with white noise
    Bench,
    /// The full loop: odometry, compass and walls through the filter
    Ekf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum NoiseName {
    /// None
    None,
    /// 5 mm and 0.3° on the estimate, 5 % on each wheel's speed
    Bench,
}

/// What the filter's belief jumps from tick to tick \[m]: of its error of 1.2 mm, the part that is white.
const FILTER_JITTER: f64 = 5e-4;

impl TrialArgs {
    /// Reads the configuration; the noise is this one unless it was given.
    pub(super) fn read(&self, noise_unless_given: NoiseName) -> Result<Trials<'_>, CliError> {
        let noise = self.noise.unwrap_or(noise_unless_given);
        // The bench has no limit of acceleration: the largest that there is a parameter for is none in effect.
        let bench = [
            (&param::POSITION_NOISE, self.loop_.told(noise.sizes())),
            (&param::WHEEL_RADIUS, 0.05),
            (&param::WHEEL_SEPARATION, 0.6),
            (&param::WHEEL_SPEED_LIMIT, 0.3),
            (&param::WHEEL_ACCELERATION_LIMIT, 1000.0),
            (&param::PERIOD, 0.02),
        ];
        let bench = Config::default().with_preset(BENCH, &bench);
        let mut config = self.config.over(bench.clone())?;
        if let Some(period) = &self.period {
            config = config.with_option_of("--period", &format!("loop.period_s={period}"))?;
        }
        Ok(Trials { config, bench, noise, arguments: self })
    }
}

impl Trials<'_> {
    /// What the trials are, for whoever reads their figures later.
    pub(super) fn described(&self) -> [(&'static str, Json); 4] {
        [
            ("loop", json!(name(&self.arguments.loop_))),
            ("noise", json!(name(&self.noise))),
            ("period_s", json!(self.config.number(&param::PERIOD))),
            ("law", json!(self.config.choice(&param::LAW_NAME))),
        ]
    }

    /// What the user set otherwise than the bench has it, and the trials do not heed: `SECTION.KEY` each.
    pub(super) fn unheeded(&self) -> Vec<String> {
        let counts = |setting: &Setting| match setting.parameter.section {
            "law" | "loop" => true,
            "filter" if self.arguments.loop_ == LoopName::Ekf => {
                [&param::DELTA, &param::GATE_PROBABILITY].contains(&setting.parameter)
            }
            _ => false,
        };
        let is_set =
            |setting: &Setting| matches!(setting.origin, ValueSource::File { .. } | ValueSource::CommandLine);
        // Both are in the order of the table.
        let settings = self.config.settings().iter().zip(self.bench.settings());
        settings
            .filter(|(set, bench)| is_set(set) && set.value != bench.value && !counts(set))
            .map(|(set, _)| format!("{}.{}", set.parameter.section, set.parameter.key))
            .collect()
    }

    /// The sweep of these trials.
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

/// A choice as it is typed.
pub(super) fn name(choice: &impl ValueEnum) -> String {
    choice.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// The name of the bench's robot, as the origin of values.
const BENCH: &str = "bench";

impl LoopName {
    /// How far off its estimate the law is told to be from tick to tick \[m], as a robot's owner would tell it.
    fn told(self, noise: SweepNoise) -> f64 {
        match self {
            Self::Bench => noise.position,
            Self::Ekf => FILTER_JITTER,
        }
    }

    /// What tells the law where the robot is.
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
