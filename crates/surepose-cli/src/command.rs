//! The commands, one file each.

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

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drive the simulated robot to a pose
    Run(run::RunCommand),
    /// Reproduce the figures of the paper
    Reproduce(reproduce::ReproduceCommand),
    /// Run many closed-loop trials at once
    Sweep(sweep::SweepCommand),
    /// Find gains that take least time, always arrive, and are certified
    Tune(tune::TuneCommand),
    /// Certify that the robot arrives, for these gains, period and noise
    Certify(certify::CertifyCommand),
    /// Make a wall map from a grid or a recording, or show one
    Map(map::MapCommand),
    /// Fit the robot's parameters to a recording
    Calibrate(calibrate::CalibrateCommand),
    /// Check, show or explain the configuration
    Config(config::ConfigCommand),
    /// Run the estimator on a recording, judged against its reference
    Replay(replay::ReplayCommand),
    /// Run as a ROS 2 node, on a robot or with a simulated one
    Ros2(ros2::Ros2Command),
}

impl Default for Command {
    /// The robot drives.
    fn default() -> Self {
        Self::Run(run::RunCommand::default())
    }
}

impl Command {
    /// Does it.
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
