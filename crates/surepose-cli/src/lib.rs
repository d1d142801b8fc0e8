//! The commands of `surepose`: simulation, certification, replay, calibration and a ROS 2 node.
//!
//! Each command reads options and files, calls the libraries and prints the result. Each command is one file. [`program`] is
//! the whole program; [`call`] runs one command inside another program and returns its result.

mod call;
mod capture;
mod certification;
mod command;
mod error;
mod exit;
mod explanation;
mod interrupt;
mod interrupt_flags;
mod maps;
mod output;
mod output_dir;
mod parquet;
mod progress;
mod recording;
mod settings;

use std::process::ExitCode;

pub use call::{Answer, CallError, call, cancel_calls, words};
use clap::Parser;
use error::CliError;
use exit::Exit;

/// Drive a differential robot to a pose, and be sure.
#[derive(Debug, Parser)]
#[command(
    // The name of the binary, not of the package.
    name = "surepose",
    version,
    after_help = "Exit codes: 0 done, 1 completed with a negative outcome, 2 usage or configuration error, 3 input data \
                  unreadable or malformed, 4 stopped by the supervisor, 130 interrupted, 143 terminated.",
    after_long_help = EXAMPLES
)]
struct Program {
    #[command(subcommand)]
    command: Option<command::Command>,

    /// Print the result as one JSON object on standard output; messages go to standard error
    #[arg(long, global = true)]
    json: bool,
}

const EXAMPLES: &str = "\
Without a command, `surepose` runs `surepose run`.

Examples:
  surepose run --goal 2,2,90 --out out        simulate one run; write plots and data into out/
  surepose reproduce --out figures            reproduce the figures of the paper
  surepose certify                            prove that the closed loop reaches the goal
  surepose sweep --runs 100000 --noise bench  run many trials and compare with the minimum time
  surepose tune --period 0.05 --out t.toml    find certified gains with minimum time
  surepose replay mrclam MRCLAM_Dataset7      run the estimator on a recording of a real robot
  surepose replay carmen freiburg-101.log.gz  run the estimator on laser scans and a wall map
  surepose map from-grid room.yaml --out room.toml
  surepose calibrate mcap my_bag              calibrate wheels and sensors from a rosbag2 recording
  surepose ros2 --simulate                    run the ROS 2 node with a simulated robot
  surepose config show > robot.toml           write every parameter with its default, for editing
  surepose config check robot.toml            check a configuration file
  surepose config explain capture_radius_m    explain one parameter

Exit codes:
  0    done: goal reached, certificate holds, files written
  1    completed with a negative outcome
  2    usage or configuration error
  3    input data unreadable or malformed; the message names file and line
  4    stopped by the supervisor
  130  interrupted by Ctrl-C; completed results are kept
  143  terminated by SIGTERM; completed results are kept";

/// Runs the command of the command line and returns its exit code.
pub fn program() -> ExitCode {
    error::style_messages();
    let ended = match Program::try_parse() {
        Ok(program) => {
            let output = output::Output { json: program.json };
            interrupt::install(output);
            program.command.unwrap_or_default().run(output)
        }
        Err(problem) => parted(&problem),
    };
    let exit = ended.unwrap_or_else(|failure| {
        let exit = failure.exit();
        output::say(&format_args!("{:?}", miette::Report::new(failure)));
        exit
    });
    interrupt::exit_code(exit).into()
}

/// Prints a command-line error, or the requested help or version.
fn parted(problem: &clap::Error) -> Result<Exit, CliError> {
    let printed = problem.print();
    if problem.use_stderr() {
        return Ok(Exit::Usage);
    }
    output::printed(printed).map(|()| Exit::Done)
}
