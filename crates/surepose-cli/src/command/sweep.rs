//! `surepose sweep`: runs many closed-loop trials and compares them with the minimum time.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::{Map, Value as Json};
use surepose_figures as picture;
use surepose_io::start_poses;
use surepose_montecarlo::sweep::{Precision, Quantiles, Starts, Sweep, SweepReport};
use surepose_sim::CancelToken;

use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, align_numbers, object, table, warning};
use crate::output_dir::OutputDir;
use crate::settings::{toml_of, whole};
use crate::{interrupt, progress};

use super::trials::{LoopName, NoiseName, TrialArgs, Trials, name};

/// Run the bench trial from many starts: success, time over the least possible, final error.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose sweep --runs 100000 --noise bench --json
  surepose sweep --law paper --period 0.1
  surepose sweep --loop ekf --runs 1000000 --json        consistent if nees_mean is 3
  surepose sweep --starts starts.csv --out out          start poses x_m,y_m,heading_deg, one per line

The bench trial: wheel radius 0.05 m, wheel separation 0.60 m, wheel speed limit 0.3 m/s, exact arcs, no acceleration limit. \
Success: within 1 cm and 1° of the goal for 1 s, within 120 s. The robot is always the bench robot; of the configuration, \
only [law] and the period are used.

With --loop ekf the law uses the belief of the filter instead of the true pose with noise, and [filter] delta and \
gate_probability are used as well. The initial belief has a standard deviation of 1 cm and 0.5°. Encoders report the \
commanded wheel travel, from which the actual rim travel differs by the wheel noise. Each tick has a compass measurement \
(0.1°) and two wall measurements (5 mm, 0.25°). The result then has nees_mean, position_rmse_m, heading_rmse_deg and \
refused_part, over all ticks.

Files in --out: trials.csv and trials.parquet, one row per trial; start_map and spreads, as SVG and PNG; config.toml, with \
every effective parameter; summary.json, the JSON result without wall_s and steps_per_s. The same command line gives the \
same bytes.

Exit codes: 0 done; 1 no trial succeeded; 2 usage or configuration error; 3 file of start poses unreadable or malformed; \
130 interrupted (the trials before the first unfinished one are kept).")]
pub(crate) struct SweepCommand {
    /// The number of random start poses
    #[arg(long, default_value_t = 10_000, conflicts_with = "starts", value_parser = whole(1..=u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    /// A CSV file of start poses relative to the goal, in meters and degrees
    #[arg(long, value_name = "FILE.csv")]
    starts: Option<PathBuf>,
    /// The floating-point type of the loop
    #[arg(long, value_enum, default_value_t = PrecisionName::F64)]
    precision: PrecisionName,
    /// A directory for the summary, the trials, a map of the start poses and histograms
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    trials: TrialArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PrecisionName {
    /// Single precision, as on the microcontroller
    F32,
    /// Double precision, as on the robot
    F64,
}

impl SweepCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let trials = self.trials.read(self.noise_unless_given())?;
        let sweep = self.sweep(&trials)?;
        let ignored_parameters = trials.ignored_parameters();
        if !ignored_parameters.is_empty() {
            warning(&format!(
                "the trials use the bench robot and goal; [robot] only affects fitted gains. Ignored parameters: \
                 {}",
                ignored_parameters.join(", ")
            ));
        }
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;

        let (cancel, bar, total) =
            (CancelToken::default(), progress::bar(output, "sweeping"), sweep.starts.len());
        let part = || cancel.completed() as f64 / total.max(1) as f64;
        let report = progress::attended(&bar, part, || cancel.cancel(), || sweep.run(&cancel))?;

        let mut json = object(&report);
        json.extend(trials.described().map(|(key, value)| (key.to_owned(), value)));
        json.insert("precision".to_owned(), name(&self.precision).into());
        interrupt::mark(&mut json);
        if let Some(folder) = &folder {
            folder.text("config.toml", &toml_of(&trials.config.fitted()))?;
            write(folder, &report, &json)?;
        }
        output.result(&json, || shown(&report))?;
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

    fn sweep(&self, trials: &Trials<'_>) -> Result<Sweep, CliError> {
        let starts = match &self.starts {
            Some(file) => Starts::Given(start_poses::read(file)?),
            None => Starts::Random(self.runs as usize),
        };
        let precision = match self.precision {
            PrecisionName::F32 => Precision::F32,
            PrecisionName::F64 => Precision::F64,
        };
        Ok(trials.sweep(starts, precision))
    }
}

fn write(folder: &OutputDir, report: &SweepReport, json: &Map<String, Json>) -> Result<(), CliError> {
    folder.table("trials.csv", &report.trials)?;
    folder.parquet("trials.parquet", &report.trials)?;
    folder.picture("start_map", &picture::start_map(&report.trials))?;
    folder.picture("spreads", &picture::quantile_plots(&report.trials))?;
    folder.summary(json)
}

fn shown(report: &SweepReport) -> comfy_table::Table {
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
