//! `surepose sweep`: many closed-loop trials at once, judged against the least possible time.

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
  surepose sweep --starts starts.csv --out out          x_m,y_m,heading_deg on each line

The trial: wheels of 0.05 m on a track of 0.60 m, 0.3 m/s at most, exact arcs; success is within 1 cm and 1° for \
1 s, inside 120 s. The robot is the bench's; of the configuration, [law] counts.

With --loop ekf the law sees the filter's belief instead of the noisy truth, and [filter] delta and gate_probability \
count too. The belief begins within 1 cm and 0.5° (1 σ); the encoders read what the wheels were told, which the rims are \
off by the wheels' noise; each tick a compass (0.1°) and two walls (5 mm, 0.25°) are seen. The result then has \
nees_mean, position_rmse_m, heading_rmse_deg and refused_part, over all ticks.

Written to --out: trials.csv and trials.parquet, a line for each trial; start_map and spreads, as SVG and PNG; config.toml, with \
every parameter in effect; summary.json, which is the JSON of the command without wall_s and steps_per_s. The same command line \
gives the same bytes.

Exit codes: 0 done, 1 no trial succeeded, 2 wrong command line, 3 starts that cannot be read, 130 interrupted (the trials up to \
the first that has not ended are kept).")]
pub(crate) struct SweepCommand {
    /// How many random starts
    #[arg(long, default_value_t = 10_000, conflicts_with = "starts", value_parser = whole(1..=u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    /// Given starts, in metres and degrees, seen from the goal
    #[arg(long, value_name = "FILE.csv")]
    starts: Option<PathBuf>,
    /// What the loop is computed with
    #[arg(long, value_enum, default_value_t = PrecisionName::F64)]
    precision: PrecisionName,
    /// A folder for the summary, the trials, a map of their starts and histograms
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    trials: TrialArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PrecisionName {
    /// The microcontroller's
    F32,
    /// The robot's
    F64,
}

impl SweepCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let trials = self.trials.read(self.noise_unless_given())?;
        let sweep = self.sweep(&trials)?;
        let unheeded = trials.unheeded();
        if !unheeded.is_empty() {
            warning(&format!(
                "the trials are those of the bench's robot and goal, but for gains that are fitted to [robot]: they do not \
                 heed {}",
                unheeded.join(", ")
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
        ("time / least possible", report.time_ratio, 1.0, 3),
        ("way / distance", report.path_ratio, 1.0, 3),
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
        ("measurements kept out [%]", report.refused_part, 1e2, 3),
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
