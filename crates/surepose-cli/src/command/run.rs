//! `surepose run`: simulates one closed-loop run.

use std::path::{Path, PathBuf};

use clap::Args;
use surepose::localization::SensorInput;
use surepose::navigator::StepReport;
use surepose::param::{self, ArenaName, Choice};
use surepose_config::{Config, describe_abort};
use surepose_figures::{self as picture, Picture};
use surepose_recorder::FlightRecorder;
use surepose_sim::robot::{InvalidEnd, Scenario, ScenarioEnd};
use surepose_sim::simulation::{Sample, Simulation, SimulationOutcome, SimulationSummary};
use surepose_sim::world_parameters::world_parameters;
use surepose_sim::{Arena, WallSegment, WorldSettings};

use crate::error::CliError;
use crate::exit::Exit;
use crate::explanation;
use crate::maps::{walls_in, walls_to_read};
use crate::output::{Output, object, table, text, warning};
use crate::output_dir::OutputDir;
use crate::settings::{LawArgs, PoseArg, toml_of, whole};
use crate::{capture, certification, interrupt, progress, recording};

/// Simulate one closed-loop run of the robot, with motors, sensors and estimator, to a goal pose
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose run                                          the arena of the paper, goal 2,2,30
  surepose run --goal 2,2,90 --seed 7 --out out         another goal; writes plots, data and out/drive.html
  surepose run --law paper --json                       the control law of the paper
  surepose run --scenario open --start 0,0,180 --set law.direction=reverse --json
  surepose run --world robot.track_m=0.57               the true track differs from the configured one
  surepose run --world robot.min_speed_m_s=0.03 --world robot.motor_time_constant_s=0.3
  surepose run --world fault.laser=frozen --world fault.laser_from_s=5
  surepose run --map walls.toml --start 1,1,0 --goal 3,2,90     the walls of a file
  surepose run --map traced.toml --world map=true.toml          the robot has a map with errors
  surepose run --record drive                           records the drive; `surepose replay mcap drive` repeats it to the bit
  surepose run --world help                             list every property of the world

With --world, only the world changes; with --set and --map, the robot and, unless --world differs, the world.

Exit codes: 0 goal reached; 1 missed (at rest by the estimate, but the true pose is outside the tolerance) or
timeout; 2 usage or configuration error; 4 stopped before a wall or by the supervisor; 130 interrupted,
143 terminated (the results up to then are kept).")]
pub(crate) struct RunCommand {
    /// The environment: paper, open, loop, or a TOML file with a [scenario] section
    #[arg(long, value_name = "NAME or FILE")]
    scenario: Option<String>,
    /// The start pose, in meters, meters and degrees
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<PoseArg>,
    /// The goal pose, in meters, meters and degrees
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    goal: Option<PoseArg>,
    /// The seed of the random generator; the same seed gives the same result
    #[arg(long, default_value_t = SEED, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// The map of the robot: a wall map (.toml), or an occupancy grid from which walls are extracted (.yaml). Default: the walls of the scenario
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Make the world differ from the robot's configuration: robot.track_m=0.57, or map=FILE for its walls. `help` lists the keys. May be repeated
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    world: Vec<String>,
    /// A directory for plots, time series, the summary, and an HTML page that plays the run
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// A directory for a recording of every input, belief and command of the navigator (MCAP of rosbag2), which `surepose replay mcap DIR` repeats to the bit
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
    #[command(flatten)]
    config: LawArgs,
}

/// The default seed.
const SEED: u64 = 1;

impl Default for RunCommand {
    fn default() -> Self {
        Self {
            scenario: None,
            start: None,
            goal: None,
            seed: SEED,
            map: None,
            world: Vec::new(),
            out: None,
            record: None,
            config: LawArgs::default(),
        }
    }
}

impl RunCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        if self.world.iter().any(|option| option == "help") {
            text(&explanation::world_help(&world_parameters(), output.json))?;
            return Ok(Exit::Done);
        }
        interrupt::listen();
        let scenario = self.scenario()?;
        for said in certification::warnings(&scenario.config) {
            warning(&said);
        }
        for said in scenario.config.stall_warnings(&scenario.world_settings.over(&scenario.config)) {
            warning(&said);
        }
        if let Some(wall) = scenario.wall_on_straight_path() {
            let WallSegment { start: a, end: b } = wall;
            warning(&format!(
                "scenario: the wall from ({}, {}) to ({}, {}) crosses the straight line to the goal; the law does not plan around obstacles",
                a.x, a.y, b.x, b.y
            ));
        }
        // Checked before the run: an output directory that is not writable must not discard a finished run.
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;

        let bar = progress::bar(output, "driving");
        let mut simulation = Simulation::new(&scenario, self.seed);
        let mut samples = Vec::new();
        let recorder = self.record.as_deref().map(|path| recording::of_run(path, &scenario, &simulation));
        let recorder = recorder.transpose()?;
        let recorded = recorder.as_ref().map(FlightRecorder::handle);
        let watch = |input: &SensorInput<'_, f64>, report: &StepReport<f64>| {
            if let Some(recorded) = &recorded {
                recorded.log_simulated_step(input, report);
            }
        };
        while !interrupt::asked() {
            let Some(sample) = simulation.next_watched(watch) else { break };
            samples.push(sample);
            progress::show(&bar, simulation.elapsed());
        }
        bar.finish_and_clear();

        capture::samples(&samples);
        let summary = simulation.summary();
        if summary.walls == 0 && summary.time_s > 1.0 {
            warning("laser: no wall was observed in any scan; check the [laser] parameters");
        }
        if let Some(reason) = simulation.abort_reason() {
            warning(&format!("goal aborted: {}", describe_abort(reason)));
        }
        let mut json = object(&summary);
        let different = scenario.world_settings.settings();
        let world_map = self.world.iter().find_map(|option| map_in(option));
        if !different.is_empty() || world_map.is_some() {
            let mut world = explanation::settings_as_json(different);
            if let (Some(file), Some(entries)) = (world_map, world.as_object_mut()) {
                entries.insert("map".to_owned(), file.into());
            }
            json.insert("world".to_owned(), world);
        }
        // A result is printed even if its files cannot be written.
        let finish = |recorder| recording::finish(self.record.as_deref(), recorder);
        let recorded = recorder.map_or(Ok(()), finish);
        let written = folder.as_ref().map_or(Ok(()), |folder| write(folder, &scenario, &samples));
        let written = recorded.and(written);
        interrupt::mark(&mut json);
        let written = written.and_then(|()| folder.map_or(Ok(()), |folder| folder.summary(&json)));
        output.result(&json, || {
            let mut table = table(&[]);
            rows(&summary, |name, value| {
                table.add_row([name, value]);
            });
            let (name, value) = match &self.out {
                Some(path) => ("playback", path.join("drive.html").display().to_string()),
                None => ("playback", "use --out DIR, then open DIR/drive.html in a browser".to_owned()),
            };
            table.add_row([name.to_owned(), value]);
            table
        })?;
        written?;
        Ok(match summary.outcome {
            _ if interrupt::asked() => Exit::Interrupted,
            SimulationOutcome::Reached => Exit::Done,
            SimulationOutcome::Missed | SimulationOutcome::Timeout => Exit::Negative,
            SimulationOutcome::Stopped => Exit::Stopped,
            SimulationOutcome::Interrupted => Exit::Interrupted,
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
                let what =
                    format!("--scenario: neither a scenario nor a file (got '{}')", other.escape_debug());
                let help = format!("use {}, or the path of a TOML file", ArenaName::NAMES.join(", "));
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
        let mut scenario = Scenario::configured(config);
        if let Some(file) = &self.map {
            let (map, scan_method) = walls_to_read(file)?;
            scenario = Scenario { scan_method, ..scenario.with_map(map) };
        }
        let (maps, settings): (Vec<&str>, Vec<&str>) =
            self.world.iter().map(String::as_str).partition(|option| map_in(option).is_some());
        scenario.world_settings = WorldSettings::from_options(settings)?;
        let arena = scenario.world_settings.is_given(&param::ARENA).then_some("scenario.arena");
        match (maps.as_slice(), arena) {
            ([], _) => {}
            ([map], None) => {
                let walls = walls_in(Path::new(map_in(map).unwrap_or_default()))?;
                scenario.world_arena = Some(Arena::from_wall_map(&walls));
            }
            ([first, ..], other) => {
                let other = other.or(maps.get(1).copied()).unwrap_or_default();
                let what = format!("--world: two sources of the walls (got {first} and {other})");
                return Err(CliError::Usage { what, help: "leave out one of the two options".to_owned() });
            }
        }
        scenario.check_clearance().map_err(|problem| invalid_end(&problem, &scenario))?;
        Ok(scenario)
    }
}

/// Returns the file of a `--world` option that sets the walls of the world; `None` for another option.
fn map_in(option: &str) -> Option<&str> {
    let (key, file) = option.split_once('=')?;
    (key.trim() == "map").then_some(file.trim())
}

/// Builds the usage error of an invalid pose: names the option to change and the origin of the pose.
fn invalid_end(problem: &InvalidEnd, scenario: &Scenario) -> CliError {
    let key = problem.end.name();
    let parameter = match problem.end {
        ScenarioEnd::Start => &param::START_X,
        ScenarioEnd::Goal => &param::GOAL_X,
    };
    let [low, high] = scenario.arena.corners();
    let help = format!(
        "set --{key} to a pose with room for the robot (robot.footprint_radius_m or robot.footprint_m, safety.wall_clearance_m); \
         the arena '{}' extends from ({}, {}) to ({}, {}); this {key} comes from: {}",
        scenario.arena.name(),
        low.0,
        low.1,
        high.0,
        high.1,
        scenario.config.origin(parameter),
    );
    CliError::Usage { what: problem.to_string(), help }
}

/// Writes all output files except the summary. Ctrl-C skips the plots that are not yet drawn.
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
            "missed: at rest by the estimate, but the true pose is outside the tolerance".to_owned()
        }
        (SimulationOutcome::Timeout, _) => "timeout".to_owned(),
        (SimulationOutcome::Interrupted, _) => "interrupted".to_owned(),
        (SimulationOutcome::Stopped, None) => "stopped".to_owned(),
        (SimulationOutcome::Stopped, Some(reason)) => format!("stopped: {reason}"),
    };
    row("outcome".to_owned(), outcome);
    row("time".to_owned(), format!("{:.1} s (minimum {:.1} s)", summary.time_s, summary.optimal_time_s));
    row("path length".to_owned(), format!("{:.2} m", summary.path_length_m));
    let (position, heading) = (summary.final_position_error_m, summary.final_heading_error_deg);
    row("final error".to_owned(), format!("{:.1} mm, {heading:.2}°", 1e3 * position));
    if let (Some(position), Some(heading)) = (summary.position_rmse_m, summary.heading_rmse_deg) {
        row("estimation error (RMS)".to_owned(), format!("{:.1} mm, {heading:.3}°", 1e3 * position));
    }
    if let Some(nees) = summary.nees_mean {
        row("NEES (3 if consistent)".to_owned(), format!("{nees:.2}"));
    }
    let SimulationSummary { accepted, walls, rejected, .. } = summary;
    let rejected = rejected.total();
    row("measurements".to_owned(), format!("{accepted} accepted ({walls} walls), {rejected} rejected"));
    row("seed".to_owned(), summary.seed.to_string());
}
