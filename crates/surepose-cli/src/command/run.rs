//! `surepose run`: one closed-loop drive of the simulated robot.

use std::path::{Path, PathBuf};

use clap::Args;
use surepose::param;
use surepose_config::Config;
use surepose_figures::{self as picture, Picture};
use surepose_sim::WallSegment;
use surepose_sim::robot::{InsufficientClearance, Scenario};
use surepose_sim::simulation::{Sample, Simulation, SimulationOutcome, SimulationSummary};

use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, object, table, warning};
use crate::output_dir::OutputDir;
use crate::settings::{LawArgs, PoseArg, toml_of, whole};
use crate::{certification, interrupt, progress};

/// Drive the simulated robot, with motors, sensors and estimate, to a pose.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose run                                          the paper's arena, to 2,2,30
  surepose run --goal 2,2,90 --seed 7 --out out         another goal; out/drive.html plays it, with pictures and data
  surepose run --law paper --json                       the paper's own law
  surepose run --scenario open --start 0,0,180 --set law.direction=reverse --json

Exit codes: 0 reached, 1 missed (it rests where it believes the goal to be, and is outside the tolerance in
truth) or time ran out, 2 wrong command line, 4 stopped before a wall or by the supervisor, 130 interrupted
(with what was done until then).")]
pub(crate) struct RunCommand {
    /// Where: paper, open, loop, or a TOML file whose [scenario] says so
    #[arg(long, value_name = "NAME or FILE")]
    scenario: Option<String>,
    /// Where the robot starts: metres, metres, degrees
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<PoseArg>,
    /// Where it shall come to rest
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    goal: Option<PoseArg>,
    /// What all noise is drawn from: the same seed gives the same drive
    #[arg(long, default_value_t = SEED, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// A folder for a page that plays the drive, pictures, time series and summary
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    config: LawArgs,
}

/// The seed unless one is given.
const SEED: u64 = 1;

impl Default for RunCommand {
    fn default() -> Self {
        Self { scenario: None, start: None, goal: None, seed: SEED, out: None, config: LawArgs::default() }
    }
}

impl RunCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        interrupt::listen();
        let scenario = self.scenario()?;
        for said in certification::warnings(&scenario.config) {
            warning(&said);
        }
        if let Some(wall) = scenario.wall_on_straight_path() {
            let WallSegment { start: a, end: b } = wall;
            warning(&format!(
                "the wall from ({}, {}) to ({}, {}) stands between start and goal: the law does not go round obstacles",
                a.x, a.y, b.x, b.y
            ));
        }
        if let Some(said) = cramped(&scenario) {
            warning(&said);
        }
        // A folder that cannot be written to is found before the drive, not after it.
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;

        let bar = progress::bar(output, "driving");
        let mut simulation = Simulation::new(&scenario, self.seed);
        let mut samples = Vec::new();
        while !interrupt::asked() {
            let Some(sample) = simulation.next() else { break };
            samples.push(sample);
            progress::show(&bar, simulation.elapsed());
        }
        bar.finish_and_clear();

        let summary = simulation.summary();
        if summary.walls == 0 && summary.time_s > 1.0 {
            warning(
                "the laser saw no wall that could be used, from the first to the last scan: is it set up as it is meant to be?",
            );
        }
        let mut json = object(&summary);
        if let Some(folder) = &folder {
            write(folder, &scenario, &samples)?;
        }
        interrupt::mark(&mut json);
        if let Some(folder) = &folder {
            folder.summary(&json)?;
        }
        output.result(&json, || {
            let mut table = table(&[]);
            rows(&summary, |name, value| {
                table.add_row([name, value]);
            });
            let (name, value) = match &self.out {
                Some(path) => ("to watch it", path.join("drive.html").display().to_string()),
                None => ("to watch it", "give --out DIR, and open DIR/drive.html in a browser".to_owned()),
            };
            table.add_row([name.to_owned(), value]);
            table
        })?;
        Ok(match summary.outcome {
            _ if interrupt::asked() => Exit::Interrupted,
            SimulationOutcome::Reached => Exit::Done,
            SimulationOutcome::Missed | SimulationOutcome::Timeout => Exit::Negative,
            SimulationOutcome::Stopped => Exit::Stopped,
        })
    }

    fn scenario(&self) -> Result<Scenario, CliError> {
        let mut base = Config::default();
        match self.scenario.as_deref() {
            Some(name) if Scenario::named(name, Config::default()).is_some() => {
                base = base.with_option_of("--scenario", &format!("scenario.arena={name}"))?;
            }
            Some(file) if Path::new(file).extension().is_some() || Path::new(file).exists() => {
                base = base.with_file(Path::new(file))?;
            }
            Some(other) => {
                let what = format!("'{}' is neither a scenario nor a file", other.escape_debug());
                let help = "the scenarios are paper, open and loop".to_owned();
                return Err(CliError::Usage { what, help });
            }
            None => {}
        }
        let mut config = self.config.over(base)?;
        for (section, pose) in [("start", self.start), ("goal", self.goal)] {
            for (key, value) in pose.iter().flat_map(PoseArg::keys) {
                config = config
                    .with_option_of(&format!("--{section}"), &format!("scenario.{section}_{key}={value}"))?;
            }
        }
        let scenario = Scenario::configured(config);
        scenario.check_clearance().map_err(|problem| no_room(&problem, &scenario))?;
        Ok(scenario)
    }
}

/// What is to be said of a goal at which a wheel stands in a wall: simulated walls stop the robot's middle only.
fn cramped(scenario: &Scenario) -> Option<String> {
    let (clearance, half) =
        (scenario.arena.clearance(scenario.goal().origin()), 0.5 * scenario.config.drive().wheel_separation);
    (clearance <= half).then(|| {
        format!(
            "the goal is {clearance:.2} m from a wall, and the wheels are {half} m beside the robot's middle: whether there is \
             room to turn is not simulated"
        )
    })
}

/// Which option puts it right, and where else the pose may have come from.
fn no_room(problem: &InsufficientClearance, scenario: &Scenario) -> CliError {
    let (key, parameter) = match problem.end {
        "start" => ("start", &param::START_X),
        _ => ("goal", &param::GOAL_X),
    };
    let [low, high] = scenario.arena.corners();
    let help = format!(
        "give --{key} a place at least {:.2} m from every wall and plate; the arena '{}' \
         reaches from ({}, {}) to ({}, {}); this {key} comes from: {}",
        problem.needed,
        scenario.arena.name(),
        low.0,
        low.1,
        high.0,
        high.1,
        scenario.config.origin(parameter),
    );
    CliError::Usage { what: problem.to_string(), help }
}

/// Writes all but the summary; a Ctrl-C that comes meanwhile leaves out the pictures that are not drawn yet.
fn write(folder: &OutputDir, scenario: &Scenario, samples: &[Sample]) -> Result<(), CliError> {
    let stopped = interrupt::asked();
    let drawn = &picture::downsampled(samples);
    let html_player = picture::html_player(scenario, drawn).map_err(std::io::Error::other);
    folder.text_of("drive.html", html_player)?;
    folder.table("time_series.csv", samples)?;
    folder.text("config.toml", &toml_of(&scenario.config.fitted()))?;
    let pictures: [(&str, &dyn Fn() -> Picture); 5] = [
        ("overview", &|| picture::overview(scenario, drawn)),
        ("trajectory", &|| picture::trajectory(scenario, drawn)),
        ("velocities", &|| picture::velocities(drawn)),
        ("heading_error", &|| picture::heading_error(scenario, drawn)),
        ("lyapunov", &|| picture::lyapunov(drawn)),
    ];
    for (name, picture) in pictures {
        if interrupt::asked() == stopped {
            folder.picture(name, &picture())?;
        }
    }
    Ok(())
}

fn rows(summary: &SimulationSummary, mut row: impl FnMut(String, String)) {
    let outcome = match (summary.outcome, summary.stop_reason) {
        (SimulationOutcome::Reached, _) => "reached".to_owned(),
        (SimulationOutcome::Missed, _) => {
            "missed: it believes it is there, and in truth is outside the tolerance".to_owned()
        }
        (SimulationOutcome::Timeout, _) => "time ran out".to_owned(),
        (SimulationOutcome::Stopped, None) => "stopped".to_owned(),
        (SimulationOutcome::Stopped, Some(reason)) => format!("stopped: {reason}"),
    };
    row("outcome".to_owned(), outcome);
    row("time".to_owned(), format!("{:.1} s (at least {:.1} s)", summary.time_s, summary.optimal_time_s));
    row("way".to_owned(), format!("{:.2} m", summary.path_length_m));
    let (position, heading) = (summary.final_position_error_m, summary.final_heading_error_deg);
    row("final error".to_owned(), format!("{:.1} mm, {heading:.2}°", 1e3 * position));
    if let (Some(position), Some(heading)) = (summary.position_rmse_m, summary.heading_rmse_deg) {
        row("estimate's error (rms)".to_owned(), format!("{:.1} mm, {heading:.3}°", 1e3 * position));
    }
    if let Some(nees) = summary.nees_mean {
        row("NEES (3 is consistent)".to_owned(), format!("{nees:.2}"));
    }
    let SimulationSummary { accepted, walls, rejected, .. } = summary;
    row("measurements".to_owned(), format!("{accepted} used, of them {walls} walls, {rejected} refused"));
    row("seed".to_owned(), summary.seed.to_string());
}
