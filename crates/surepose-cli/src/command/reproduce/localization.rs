//! `surepose reproduce fig4 fig5`: one experiment, shown in two figures.

use std::ops::Range;

use serde::Serialize;
use serde_json::{Map, Value as Json, json};
use surepose_config::Config;
use surepose_experiments::picture::{self, LocalizationRun};
use surepose_experiments::reproduce::{
    Accuracy, Comparison, Configuration, DeviationSample, Extraction, LoopWorld, comparison, deviations,
    localization,
};
use surepose_sim::{CancelToken, Clutter, Seed};

use crate::error::CliError;
use crate::output::Output;
use crate::output_dir::OutputDir;
use crate::progress;

use super::figure_result::FigureResult;

/// The experiment: one run for the pictures, many for the figures.
pub(super) struct LocalizationRuns {
    runs: Vec<LocalizationRun>,
    json: Map<String, Json>,
    rows: Vec<[String; 2]>,
}

impl LocalizationRuns {
    /// Runs `count` simulations per set of sensors, with seeds from `seed` on; Ctrl-C ends the series early.
    pub(super) fn run(config: &Config, count: u64, seed: u64, output: Output) -> Result<Self, CliError> {
        let world = LoopWorld::new(config, Clutter::default()).map_err(|error| CliError::Usage {
            what: error.to_string(),
            help: "report this as a bug".to_owned(),
        })?;
        let considered = world.clone().with_model_errors(config);
        let (cancel, bar) = (CancelToken::default(), progress::bar(output, "localizing"));
        let part = || cancel.completed() as f64 / count as f64;
        let work = || Self::drive([&world, &considered], seed..seed.saturating_add(count), &cancel);
        progress::attended(&bar, part, || cancel.cancel(), work)
    }

    /// Runs the series in the `world`, and all sensors once more with a filter that considers model errors.
    fn drive([world, considered]: [&LoopWorld; 2], seeds: Range<u64>, cancel: &CancelToken) -> Self {
        let first = Seed(seeds.start);
        let runs =
            Configuration::ALL.map(|configuration| (configuration, deviations(world, configuration, first)));
        let mut result = Self { runs: runs.into(), json: Map::new(), rows: Vec::new() };
        if let Some(Comparison { accuracies, extraction }) = comparison(world, seeds.clone(), cancel) {
            for (configuration, accuracy) in accuracies {
                result.json.insert(configuration.name().to_owned(), json!(Figures::of(accuracy)));
                result.rows.push([configuration.name().to_owned(), shown(&accuracy)]);
            }
            if let Some(accuracy) = localization(considered, Configuration::Both, seeds, cancel) {
                result.rows.push(["… with considered errors".to_owned(), shown(&accuracy)]);
            }
            let lines = LineFigures::of(&extraction);
            result.rows.push(["lines".to_owned(), lines.shown()]);
            result.json.insert("extraction".to_owned(), json!(lines));
        }
        result
    }

    pub(super) fn fig4(&self, folder: &OutputDir) -> Result<FigureResult, CliError> {
        folder.picture("fig4", &picture::fig4(&self.runs))?;
        self.data("fig4", folder)?;
        Ok(self.outcome())
    }

    pub(super) fn fig5(&self, folder: &OutputDir) -> Result<FigureResult, CliError> {
        folder.picture("fig5", &picture::fig5(&self.runs))?;
        self.data("fig5", folder)?;
        Ok(self.outcome())
    }

    fn outcome(&self) -> FigureResult {
        FigureResult { json: json!(self.json), more: None, good: true, rows: self.rows.clone() }
    }

    fn data(&self, figure: &str, folder: &OutputDir) -> Result<(), CliError> {
        for (configuration, moments) in &self.runs {
            let name = configuration.name().replace('+', "_");
            folder.table(&format!("{figure}_{name}.csv"), moments.iter().map(Row::of))?;
        }
        Ok(())
    }
}

/// The statistics under the documented JSON keys.
#[derive(Serialize)]
struct Figures {
    runs: usize,
    position_rmse_m: f64,
    heading_rmse_deg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    position_rmse_std_error_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    heading_rmse_std_error_deg: Option<f64>,
    nees_mean: f64,
    max_deviation_x_m: f64,
    max_deviation_y_m: f64,
}

impl Figures {
    fn of(accuracy: Accuracy) -> Self {
        Self {
            runs: accuracy.runs,
            position_rmse_m: accuracy.position_rmse,
            heading_rmse_deg: accuracy.heading_rmse.to_degrees(),
            position_rmse_std_error_m: accuracy.position_rmse_std_error,
            heading_rmse_std_error_deg: accuracy.heading_rmse_std_error.map(f64::to_degrees),
            nees_mean: accuracy.nees_mean,
            max_deviation_x_m: accuracy.max_deviation_x,
            max_deviation_y_m: accuracy.max_deviation_y,
        }
    }
}

/// Statistics of line extraction and association, compared with the true walls.
#[derive(Serialize)]
struct LineFigures {
    walls_visible: u64,
    walls_found_share: Option<f64>,
    lines: u64,
    line_nees_mean: Option<f64>,
    spurious_lines: u64,
    lines_matched: u64,
    wrong_match_share: Option<f64>,
}

impl LineFigures {
    fn of(extraction: &Extraction) -> Self {
        Self {
            walls_visible: extraction.visible,
            walls_found_share: extraction.walls_found_share(),
            lines: extraction.lines,
            line_nees_mean: extraction.line_nees_mean(),
            spurious_lines: extraction.spurious,
            lines_matched: extraction.matched,
            wrong_match_share: extraction.wrong_match_share(),
        }
    }

    fn shown(&self) -> String {
        let number = |value: Option<f64>, scale: f64, digits: usize| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{:.digits$}", scale * value))
        };
        format!(
            "{} % of the visible walls found, NEES {}, {} % wrong matches",
            number(self.walls_found_share, 100.0, 2),
            number(self.line_nees_mean, 1.0, 2),
            number(self.wrong_match_share, 100.0, 3)
        )
    }
}

/// One sample of the plotted run.
#[derive(Serialize)]
struct Row {
    time_s: f64,
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
    estimated_x_m: f64,
    estimated_y_m: f64,
    estimated_heading_deg: f64,
    deviation_x_m: f64,
    deviation_y_m: f64,
    deviation_heading_deg: f64,
}

impl Row {
    fn of(moment: &DeviationSample) -> Self {
        let (truth, pose) = (moment.truth, moment.belief.pose);
        let [x, y, heading] = moment.belief.error(truth);
        Self {
            time_s: moment.time,
            x_m: truth.x,
            y_m: truth.y,
            heading_deg: truth.heading.degrees(),
            estimated_x_m: pose.x,
            estimated_y_m: pose.y,
            estimated_heading_deg: pose.heading.degrees(),
            deviation_x_m: x,
            deviation_y_m: y,
            deviation_heading_deg: heading.to_degrees(),
        }
    }
}

fn shown(accuracy: &Accuracy) -> String {
    let (position, heading) = (1e3 * accuracy.position_rmse, accuracy.heading_rmse.to_degrees());
    let give_or_take = |error: Option<f64>, scale: f64, digits: usize| {
        error.map_or_else(String::new, |error| format!(" ± {:.digits$}", scale * error))
    };
    format!(
        "{position:.2}{} mm, {heading:.4}{}° (RMS), NEES {:.2}",
        give_or_take(accuracy.position_rmse_std_error, 1e3, 2),
        give_or_take(accuracy.heading_rmse_std_error, 1f64.to_degrees(), 4),
        accuracy.nees_mean
    )
}
