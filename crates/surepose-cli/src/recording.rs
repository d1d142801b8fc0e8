//! The flight recorder of `run` and `ros2`, and the replay of its recordings.

use std::path::Path;

use surepose::time::Stamp;
use surepose_recorder::replay::{self, BitReplay};
use surepose_recorder::{EventInput, FlightRecorder, Session};
use surepose_sim::robot::{Scenario, wall_map_from_arena};
use surepose_sim::simulation::Simulation;

use crate::error::{CliError, OutputKind};
use crate::exit::Exit;
use crate::output::{Output, object, table, warning};
use crate::settings::ConfigArgs;

/// Starts the recording of a run that has not begun, with its goal.
pub(crate) fn of_run(
    path: &Path,
    scenario: &Scenario,
    simulation: &Simulation,
) -> Result<FlightRecorder, CliError> {
    let map = scenario.map.clone().unwrap_or_else(|| wall_map_from_arena(&scenario.arena));
    let belief = simulation.navigator().localizer().belief();
    let config = scenario.config.clone();
    let session = Session::new(config, scenario.navigator_setup(), Some(map), Stamp::default(), belief);
    let recorder = create(path, &session)?;
    if let Some(goal) = simulation.navigator().goal() {
        recorder.handle().log(Stamp::default(), EventInput::SetGoal(goal));
    }
    Ok(recorder)
}

/// Starts a recording.
pub(crate) fn create(path: &Path, session: &Session) -> Result<FlightRecorder, CliError> {
    FlightRecorder::create(path, session).map_err(|problem| failed(path, problem))
}

/// Ends a recording; names what was dropped.
pub(crate) fn finish(path: Option<&Path>, recorder: FlightRecorder) -> Result<(), CliError> {
    let path = path.unwrap_or(Path::new("."));
    let summary = recorder.finish().map_err(|problem| failed(path, problem))?;
    if summary.dropped > 0 {
        let (dropped, events) = (summary.dropped, summary.events);
        warning(&format!(
            "--record: {dropped} events were dropped ({events} written), because the disk was too slow; the recording cannot \
             be replayed to the bit"
        ));
    }
    Ok(())
}

/// Replays the recording at `path` to the bit, with the settings of `config` on top of its own.
pub(crate) fn replay(
    path: &Path,
    against: Option<&Path>,
    config: &ConfigArgs,
    output: Output,
) -> Result<Exit, CliError> {
    let mut refused = Ok(());
    let configure = |recorded| match config.over(surepose_config::Config::clone(&recorded)) {
        Ok(config) => config,
        Err(error) => {
            refused = Err(error);
            recorded
        }
    };
    let unreadable = |what: String| CliError::Recording { path: path.to_owned(), what };
    let replay = replay::replay(path, against, configure).map_err(|error| unreadable(error.to_string()))?;
    refused?;
    let replay = replay.ok_or_else(|| unreadable("no session of the flight recorder".to_owned()))?;
    if !replay.complete {
        warning("the recording is truncated, as after a power cut; the events before the cut are replayed");
    }
    output.result(&object(&replay), || {
        let mut table = table(&[]);
        for (name, value) in rows(&replay) {
            table.add_row([name.to_owned(), value]);
        }
        table
    })?;
    Ok(if replay.bit_identical { Exit::Done } else { Exit::Negative })
}

fn rows(replay: &BitReplay) -> Vec<(&'static str, String)> {
    let speed = replay.duration_s / replay.wall_s.max(1e-9);
    let mut rows = vec![
        ("steps", replay.steps.to_string()),
        ("identical to the bit", if replay.bit_identical { "yes" } else { "no" }.to_owned()),
        ("duration", format!("{:.1} s ({speed:.0} × real time)", replay.duration_s)),
        ("version", format!("{} (recorded by {})", replay.version, replay.recorded_version)),
    ];
    for setting in &replay.configuration {
        let said = format!("{}: {} instead of {}", setting.key, setting.replayed, setting.recorded);
        rows.push(("changed setting", said));
    }
    if let Some(first) = &replay.first_difference {
        rows.extend([
            ("first difference", format!("step {} at {} s: {}", first.step, first.stamp_s, first.field)),
            ("recorded", first.recorded.clone()),
            ("replayed", first.replayed.clone()),
            ("input of that step", first.input.clone()),
        ]);
    }
    rows
}

fn failed(path: &Path, problem: std::io::Error) -> CliError {
    CliError::Output { path: path.to_owned(), problem: problem.into(), wanted: OutputKind::Recording }
}
