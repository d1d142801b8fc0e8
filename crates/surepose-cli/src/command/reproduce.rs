//! `surepose reproduce`: reproduces the figures of the paper, with their data.

mod figure_result;
mod localization;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use figure_result::FigureResult;
use localization::LocalizationRuns;
use serde::Serialize;
use serde_json::{Map, json};
use surepose_config::Config;
use surepose_experiments::reproduce::{GoalFigures, Parked};
use surepose_experiments::{picture, reproduce};

use crate::error::CliError;
use crate::exit::Exit;
use crate::interrupt;
use crate::output::{Output, table, warning};
use crate::output_dir::OutputDir;
use crate::settings::{ConfigArgs, whole};

/// Reproduce the figures of the paper, as SVG and PNG, with their data.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose reproduce --out figures                 all figures
  surepose reproduce fig4 fig5 --out figures --runs 200
  surepose reproduce fig4 --out figures --set laser.beams=361

Exit codes: 0 done; 1 a goal of fig3 or fig7 was not reached; 2 usage or configuration error; 130 interrupted (finished \
figures are kept, and fig4 covers the finished runs).")]
pub(crate) struct ReproduceCommand {
    /// The figures; default all
    figures: Vec<Figure>,
    /// The directory for plots and data
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The number of seeds for fig4; fig6 uses a tenth of them
    #[arg(long, default_value_t = 100, value_parser = whole(1..=1_000_000_u64), allow_negative_numbers = true)]
    runs: u64,
    /// The first seed
    #[arg(long, default_value_t = 1, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    #[command(flatten)]
    config: ConfigArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum Figure {
    /// The law without a robot, to three goals, under bounded noise
    Fig3,
    /// The trajectories estimated with four sets of sensors
    Fig4,
    /// The estimation errors of these sets over time
    Fig5,
    /// Two predefined paths, followed with and without the filter
    Fig6,
    /// The full robot, to three goals
    Fig7,
}

impl ReproduceCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let config = self.config.over(Config::default())?;
        let folder = OutputDir::at(&self.out)?;
        let mut figures = self.figures.clone();
        if figures.is_empty() {
            figures = Figure::value_variants().to_vec();
        }
        figures.sort_unstable();
        figures.dedup();

        if figures.contains(&Figure::Fig3) && self.config.is_given() {
            warning("fig3: uses the gains of the paper and the law alone; the configuration is ignored");
        }

        interrupt::listen();
        // Fig. 4 and Fig. 5 show the same runs, which are computed once.
        let mut localized: Option<LocalizationRuns> = None;
        let (mut json, mut good, mut rows) = (Map::new(), true, Vec::new());
        for figure in figures {
            if interrupt::asked() {
                break;
            }
            let (name, outcome) = match figure {
                Figure::Fig3 => ("fig3", self.fig3(&folder)?),
                Figure::Fig4 => ("fig4", self.localized(&config, output, &mut localized)?.fig4(&folder)?),
                Figure::Fig5 => ("fig5", self.localized(&config, output, &mut localized)?.fig5(&folder)?),
                Figure::Fig6 => ("fig6", self.fig6(&folder, &config)?),
                Figure::Fig7 => ("fig7", self.fig7(&folder, &config)?),
            };
            json.insert(name.to_owned(), outcome.json);
            json.extend(outcome.more.map(|(key, value)| (key.to_owned(), value)));
            good &= outcome.good;
            rows.extend(outcome.rows.into_iter().map(|[what, found]| [name.to_owned(), what, found]));
            // Written after each figure, so that an interrupt keeps the finished ones.
            folder.text("figures.json", &format!("{:#}\n", json!(json)))?;
        }
        interrupt::mark(&mut json);
        if interrupt::asked() {
            folder.text("figures.json", &format!("{:#}\n", json!(json)))?;
        }
        output.result(&json, || {
            let mut table = table(&["figure", "item", "result"]);
            for row in rows {
                table.add_row(row);
            }
            table.add_row(["", "output", &self.out.display().to_string()]);
            table
        })?;
        Ok(match (interrupt::asked(), good) {
            (true, _) => Exit::Interrupted,
            (false, true) => Exit::Done,
            (false, false) => Exit::Negative,
        })
    }

    fn fig3(&self, folder: &OutputDir) -> Result<FigureResult, CliError> {
        let goals = reproduce::stabilization(self.seed);
        let (printed, corrected) = (reproduce::local_law(true), reproduce::local_law(false));
        folder.picture("fig3", &picture::fig3(&goals, &printed, &corrected))?;
        for goal in &goals {
            folder.table(&format!("fig3_{}deg.csv", goal.figures.goal[2]), &goal.motion)?;
        }
        folder.table("fig3_local_law_as_printed.csv", printed)?;
        folder.table("fig3_local_law_corrected.csv", corrected)?;
        let figures: Vec<_> = goals.iter().map(|goal| goal.figures).collect();
        Ok(FigureResult {
            json: json!(figures),
            more: None,
            good: figures.iter().all(|goal| goal.reached),
            rows: figures
                .iter()
                .map(|f| parked(f.goal, f.reached, f.final_position_error_m, f.final_heading_error_deg))
                .collect(),
        })
    }

    fn localized<'a>(
        &self,
        config: &Config,
        output: Output,
        kept: &'a mut Option<LocalizationRuns>,
    ) -> Result<&'a LocalizationRuns, CliError> {
        match kept {
            Some(localized) => Ok(localized),
            None => Ok(kept.insert(LocalizationRuns::run(config, self.runs, self.seed, output)?)),
        }
    }

    fn fig6(&self, folder: &OutputDir, config: &Config) -> Result<FigureResult, CliError> {
        let runs = (self.runs / 10).max(1);
        let following = reproduce::following(config, self.seed, runs).map_err(|error| CliError::Usage {
            what: error.to_string(),
            help: "report this as a bug".to_owned(),
        })?;
        folder.picture("fig6", &picture::fig6(&following))?;
        let shapes = [
            ("rounded_rectangle", &following.rounded_rectangle, following.figures.rounded_rectangle),
            ("rounded_triangle", &following.rounded_triangle, following.figures.rounded_triangle),
        ];
        let mut rows = Vec::new();
        for (name, shape, figures) in shapes {
            for (part, points) in
                [("path", &shape.path), ("with_ekf", &shape.with_ekf), ("without_ekf", &shape.without_ekf)]
            {
                let points = points.iter().map(|point| PathSample { x_m: point.x, y_m: point.y });
                folder.table(&format!("fig6_{name}_{part}.csv"), points)?;
            }
            let (with, without) = (figures.with_ekf.path_rmse_m, figures.without_ekf.path_rmse_m);
            let found = format!("{:.1} mm with EKF, {:.1} mm without (RMS)", 1e3 * with, 1e3 * without);
            rows.push([name.replace('_', " "), found]);
        }
        Ok(FigureResult { json: json!(following.figures), more: None, good: true, rows })
    }

    fn fig7(&self, folder: &OutputDir, config: &Config) -> Result<FigureResult, CliError> {
        let goals = reproduce::parking(config, self.seed);
        let paper = config
            .clone()
            .with_option("law.name=paper")
            .map(|paper| reproduce::parking(&paper, self.seed))?;
        folder.picture("fig7", &picture::fig7(&goals, &paper))?;
        for goal in &paper {
            folder.table(&format!("fig7_paper_{}deg.csv", goal.figures.goal[2]), &goal.samples)?;
        }
        for goal in &goals {
            folder.table(&format!("fig7_{}deg.csv", goal.figures.goal[2]), &goal.samples)?;
        }
        let of = |goals: &[Parked]| goals.iter().map(|goal| goal.figures).collect::<Vec<_>>();
        let (figures, compared) = (of(&goals), of(&paper));
        let row = |law: &str, f: &GoalFigures| {
            let [goal, found] =
                parked(f.goal, f.reached, f.final_position_error_m, f.final_heading_error_deg);
            [format!("{goal}{law}"), found]
        };
        let own = figures.iter().map(|f| row("", f));
        Ok(FigureResult {
            json: json!(figures),
            more: Some(("fig7_paper", json!(compared))),
            good: figures.iter().all(|goal| goal.reached),
            rows: own.chain(compared.iter().map(|f| row(", law of the paper", f))).collect(),
        })
    }
}

#[derive(Serialize)]
struct PathSample {
    x_m: f64,
    y_m: f64,
}

fn parked([x, y, heading]: [f64; 3], reached: bool, position_m: f64, heading_deg: f64) -> [String; 2] {
    let fate = if reached { "reached" } else { "not reached" };
    [format!("goal {x}, {y}, {heading}°"), format!("{fate}: {:.2} mm, {heading_deg:.3}°", 1e3 * position_m)]
}
