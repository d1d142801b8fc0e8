//! The commands of the program, one file each.

mod calibrate;
mod certify;
mod config;
mod map;
mod replay;
mod reproduce;
mod ros2;
mod run;
mod sweep;
mod trials;
mod tune;

use clap::Subcommand;

use crate::error::CliError;
use crate::exit::Exit;
use crate::output::Output;

/// The command to run.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate one closed-loop run of the robot to a goal pose
    Run(run::RunCommand),
    /// Reproduce the figures of the paper
    Reproduce(reproduce::ReproduceCommand),
    /// Run many closed-loop trials and report success, time and final error
    Sweep(sweep::SweepCommand),
    /// Find certified gains with minimum time to the goal
    Tune(tune::TuneCommand),
    /// Prove that the closed loop reaches the goal, for given gains, period and noise bounds
    Certify(certify::CertifyCommand),
    /// Create a wall map from an occupancy grid or a recording, or show one
    Map(map::MapCommand),
    /// Calibrate the parameters of a robot from a recording
    Calibrate(calibrate::CalibrateCommand),
    /// Check, show or explain the configuration
    Config(config::ConfigCommand),
    /// Run the estimator on a recording and compare it with the reference
    Replay(replay::ReplayCommand),
    /// Run the ROS 2 node, on a robot or with a simulated robot
    Ros2(ros2::Ros2Command),
}

impl Default for Command {
    /// The command of a command line without one: `run` with its default options.
    fn default() -> Self {
        Self::Run(run::RunCommand::default())
    }
}

impl Command {
    /// Runs the command and returns the exit code.
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        match self {
            Self::Run(command) => command.run(output),
            Self::Reproduce(command) => command.run(output),
            Self::Sweep(command) => command.run(output),
            Self::Tune(command) => command.run(output),
            Self::Certify(command) => command.run(output),
            Self::Map(command) => command.run(output),
            Self::Calibrate(command) => command.run(output),
            Self::Config(command) => command.run(output),
            Self::Replay(command) => command.run(output),
            Self::Ros2(command) => command.run(output),
        }
    }
}
