//! `surepose`: drives a simulated robot to a pose, replays recordings, reproduces the paper's figures.
//!
//! The program is thin: it reads options and files, calls the libraries, and prints. One file per command.

mod certification;
mod command;
mod error;
mod exit;
mod interrupt;
mod interrupt_flags;
mod maps;
mod output;
mod output_dir;
mod parquet;
mod progress;
mod settings;

use std::process::ExitCode;

use clap::Parser;
use error::CliError;
use exit::Exit;

/// Drive a differential robot to a pose, and be sure.
#[derive(Debug, Parser)]
#[command(
    // What is typed, not what the package is called.
    name = "surepose",
    version,
    after_help = "Exit codes: 0 done, 1 ran but the outcome is negative, 2 usage or configuration error, 3 input data \
                  unreadable or malformed, 4 stopped by the supervisor, 130 interrupted.",
    after_long_help = EXAMPLES
)]
struct Program {
    #[command(subcommand)]
    command: Option<command::Command>,

    /// Print one JSON object on standard output, and nothing else there
    #[arg(long, global = true)]
    json: bool,
}

const EXAMPLES: &str = "\
Without a command, the robot drives: `surepose` is `surepose run`.

Examples:
  surepose run --goal 2,2,90 --out out        drive the simulated robot; pictures and data into out/
  surepose reproduce --out figures            the figures of the paper
  surepose certify                            whether the robot is sure to arrive
  surepose sweep --runs 100000 --noise bench  many trials, against the least possible time
  surepose tune --period 0.05 --out t.toml    certified gains that take least time
  surepose replay mrclam MRCLAM_Dataset7      the estimator on a real robot's recording
  surepose replay carmen freiburg-101.log.gz  the same on walls, seen by a laser
  surepose map from-grid room.yaml --out room.toml
  surepose calibrate mcap my_bag              your robot's wheels, track, sensors, from a rosbag2 recording
  surepose ros2 --simulate                    a ROS 2 node with a simulated robot; without it, on yours
  surepose config show > robot.toml           every parameter with its default, to edit
  surepose config check robot.toml            whether a configuration can be used
  surepose config explain capture_radius_m    what one parameter does

Exit codes:
  0    done: goal reached, certificate holds, files written
  1    ran, but the outcome is negative
  2    usage or configuration error
  3    input data unreadable or malformed; the message names file and line
  4    stopped by the supervisor
  130  interrupted; what was finished is kept";

fn main() -> ExitCode {
    error::style_messages();
    let ended = match Program::try_parse() {
        Ok(program) => {
            let output = output::Output { json: program.json };
            interrupt::install(output);
            program.command.unwrap_or_default().run(output)
        }
        Err(problem) => parted(&problem),
    };
    ended
        .unwrap_or_else(|failure| {
            let exit = failure.exit();
            output::say(&format_args!("{:?}", miette::Report::new(failure)));
            exit
        })
        .into()
}

/// Says what is wrong with the command line, or prints the help or the version that was asked for.
fn parted(problem: &clap::Error) -> Result<Exit, CliError> {
    let printed = problem.print();
    if problem.use_stderr() {
        return Ok(Exit::Usage);
    }
    output::printed(printed).map(|()| Exit::Done)
}
