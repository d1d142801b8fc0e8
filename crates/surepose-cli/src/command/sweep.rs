//! `surepose sweep`: runs many closed-loop trials and compares them with the minimum time.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::{Map, Value as Json};
use surepose::control::ActuatorModel;
use surepose_figures as picture;
use surepose_io::start_poses;
use surepose_montecarlo::sweep::{Precision, Quantiles, Starts, SweepReport};
use surepose_sim::world_parameters::base_parameters;
use surepose_sim::{CancelToken, WorldSettings};

use crate::error::CliError;
use crate::exit::Exit;
use crate::explanation;
use crate::output::{Output, align_numbers, object, shown_value, table, text, warning};
use crate::output_dir::OutputDir;
use crate::settings::{toml_of, whole};
use crate::{capture, interrupt, progress};

use super::trials::{LoopName, NoiseName, TrialArgs, name};

/// Run the bench trial from many starts: success, time over the least possible, final error.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose sweep --runs 100000 --noise bench --json
  surepose sweep --law paper --period 0.1
  surepose sweep --loop ekf --runs 1000000 --json        consistent if nees_mean is 3
  surepose sweep --starts starts.csv --out out          start poses x_m,y_m,heading_deg, one per line
  surepose sweep --runs 150 --set robot.min_speed_m_s=0.03     a base that ignores slow commands, known to the robot
  surepose sweep --runs 150 --world robot.command_delay_s=0.1  a base that executes late, unknown to the robot

The bench trial: wheel radius 0.05 m, wheel separation 0.60 m, wheel speed limit 0.3 m/s, exact arcs, no acceleration limit. \
Success: within 1 cm and 1° of the goal for 1 s, within 120 s. The robot is always the bench robot; of the configuration, \
only [law] and the period are used.

With --loop ekf the law uses the belief of the filter instead of the true pose with noise, and [filter] delta and \
gate_probability are used as well. The initial belief has a standard deviation of 1 cm and 0.5°. Encoders report the \
commanded wheel travel, from which the actual rim travel differs by the wheel noise. Each tick has a compass measurement \
(0.1°) and two wall measurements (5 mm, 0.25°). The result then has nees_mean, position_rmse_m, heading_rmse_deg and \
refused_part, over all ticks.

With --world, or if [robot] has minimum speeds, a delay or a time constant, the trials run on a base with these properties, \
with the controller and the actuator stage of `surepose run`; then [robot] and [goal] are used as well. A trial also fails if \
the goal is aborted; the result has the reasons in `aborted`. `surepose sweep --world help` lists the properties.

Files in --out: trials.csv and trials.parquet, one row per trial; start_map and spreads, as SVG and PNG; config.toml, with \
every effective parameter; summary.json, the JSON result without wall_s and steps_per_s. The same command line gives the \
same bytes.

Exit codes: 0 done; 1 no trial succeeded; 2 usage or configuration error; 3 file of start poses unreadable or malformed; \
130 interrupted (the trials before the first unfinished one are kept).")]
pub(crate) struct SweepCommand {
    /// The number of random start poses; more than 50 million run in parts, see --first
    #[arg(long, default_value_t = 10_000, conflicts_with = "starts", value_parser = whole(1..=MAX_RUNS), allow_negative_numbers = true)]
    runs: u32,
    /// The number of the first trial: --first 1000 --runs 500 repeats the last third of --runs 1500
    #[arg(long, default_value_t = 0, conflicts_with = "starts", value_parser = whole(0..=u64::MAX), allow_negative_numbers = true)]
    first: u64,
    /// A CSV file of start poses relative to the goal, in meters and degrees
    #[arg(long, value_name = "FILE.csv")]
    starts: Option<PathBuf>,
    /// The floating-point type of the loop
    #[arg(long, value_enum, default_value_t = PrecisionName::F64)]
    precision: PrecisionName,
    /// Make the base differ from the robot's configuration: robot.command_delay_s=0.1. `help` lists the keys. May be repeated
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    world: Vec<String>,
    /// A directory for the summary, the trials, a map of the start poses and histograms
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    trials: TrialArgs,
}

/// Maximum number of trials: each keeps 200 bytes until the end.
const MAX_RUNS: u32 = 50_000_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PrecisionName {
    /// Single precision, as on the microcontroller
    F32,
    /// Double precision, as on the robot
    F64,
}

impl SweepCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        if self.world.iter().any(|option| option == "help") {
            text(&explanation::world_help(&base_parameters(), output.json))?;
            return Ok(Exit::Done);
        }
        let trials = self.trials.read(self.noise_unless_given())?;
        let world =
            WorldSettings::from_options_in(&base_parameters(), self.world.iter().map(String::as_str))?;
        let has_base = !world.settings().is_empty() || trials.config.actuator() != ActuatorModel::ideal();
        if has_base {
            self.check_base()?;
        }
        let ignored_parameters = trials.ignored_parameters(has_base);
        if !ignored_parameters.is_empty() {
            warning(&format!(
                "the trials use the bench robot and goal; [robot] only affects fitted gains. Ignored parameters: \
                 {}",
                ignored_parameters.join(", ")
            ));
        }
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;

        let (starts, cancel, bar) =
            (self.starts()?, CancelToken::default(), progress::bar(output, "sweeping"));
        let total = starts.len();
        let part = || cancel.completed() as f64 / total.max(1) as f64;
        let (report, mut json) = if has_base {
            let (sweep, different) = (trials.plant_sweep(world.clone(), starts), world.settings());
            let report = progress::attended(&bar, part, || cancel.cancel(), || sweep.run(&cancel))?;
            let mut json = object(&report);
            if !different.is_empty() {
                json.insert("world".to_owned(), explanation::settings_as_json(different));
            }
            (report.figures, json)
        } else {
            let sweep = trials.sweep(starts, self.precision.precision());
            let report = progress::attended(&bar, part, || cancel.cancel(), || sweep.run(&cancel))?;
            let json = object(&report);
            (report, json)
        };
        capture::trials(&report.trials);
        json.extend(trials.described().map(|(key, value)| (key.to_owned(), value)));
        json.insert("precision".to_owned(), name(&self.precision).into());
        interrupt::mark(&mut json);
        // A result is printed even if its files cannot be written.
        let written = folder.as_ref().map_or(Ok(()), |folder| {
            folder.text("config.toml", &toml_of(&trials.config.fitted()))?;
            write(folder, &report, &json)
        });
        output.result(&json, || shown(&report, &json))?;
        written?;
        Ok(match report.success_rate {
            _ if interrupt::asked() => Exit::Interrupted,
            Some(0.0) => Exit::Negative,
            _ => Exit::Done,
        })
    }

    fn noise_unless_given(&self) -> NoiseName {
        match self.trials.loop_ {
            LoopName::Bench => NoiseName::None,
            LoopName::Ekf => NoiseName::Bench,
        }
    }

    fn starts(&self) -> Result<Starts, CliError> {
        Ok(match &self.starts {
            Some(file) => Starts::Given(start_poses::read(file)?),
            None => Starts::RandomFrom { first: self.first as usize, count: self.runs as usize },
        })
    }

    /// Rejects options that do not apply to trials on a base.
    fn check_base(&self) -> Result<(), CliError> {
        let what = if self.trials.loop_ == LoopName::Ekf {
            "--loop ekf: not available for trials on a base with its own properties"
        } else if self.precision == PrecisionName::F32 {
            "--precision f32: trials on a base with its own properties run in f64"
        } else {
            return Ok(());
        };
        let help = "leave it out, or leave out --world and the actuator parameters of [robot]".to_owned();
        Err(CliError::Usage { what: what.to_owned(), help })
    }
}

impl PrecisionName {
    fn precision(self) -> Precision {
        match self {
            Self::F32 => Precision::F32,
            Self::F64 => Precision::F64,
        }
    }
}

fn write(folder: &OutputDir, report: &SweepReport, json: &Map<String, Json>) -> Result<(), CliError> {
    folder.table("trials.csv", &report.trials)?;
    folder.parquet("trials.parquet", &report.trials)?;
    folder.picture("start_map", &picture::start_map(&report.trials))?;
    folder.picture("spreads", &picture::quantile_plots(&report.trials))?;
    folder.summary(json)
}

fn shown(report: &SweepReport, json: &Map<String, Json>) -> comfy_table::Table {
    let mut table = table(&["", "p50", "p95", "max"]);
    let rows = [
        ("time [s]", report.time_s, 1.0, 2),
        ("time / minimum time", report.time_ratio, 1.0, 3),
        ("path length / distance", report.path_ratio, 1.0, 3),
        ("final error [mm]", report.final_position_error_m, 1e3, 2),
        ("final error [°]", report.final_heading_error_deg, 1.0, 3),
    ];
    for (name, spread, factor, digits) in rows {
        let Some(Quantiles { p50, p95, max }) = spread else { continue };
        let number = |value: f64| format!("{:.digits$}", value * factor);
        table.add_row([name.to_owned(), number(p50), number(p95), number(max)]);
    }
    if let Some(success) = report.success_rate {
        table.add_row(["success", &format!("{:.3} %", 1e2 * success), "of", &report.runs.to_string()]);
    }
    if let Some(aborted) = json.get("aborted") {
        table.add_row(["goals aborted", &shown_value(aborted)]);
    }
    if let Some(cusps) = report.cusps_mean {
        table.add_row(["reversals, mean".to_owned(), format!("{cusps:.2}")]);
    }
    let beliefs = [
        ("NEES, mean (3 if consistent)", report.nees_mean, 1.0, 3),
        ("estimated position, RMSE [mm]", report.position_rmse_m, 1e3, 2),
        ("estimated heading, RMSE [°]", report.heading_rmse_deg, 1.0, 3),
        ("measurements rejected [%]", report.refused_part, 1e2, 3),
    ];
    for (name, value, factor, digits) in beliefs {
        if let Some(value) = value {
            table.add_row([name.to_owned(), format!("{:.digits$}", value * factor)]);
        }
    }
    table.add_row(["steps per second".to_owned(), format!("{:.3e}", report.steps_per_s)]);
    align_numbers(&mut table);
    table
}
