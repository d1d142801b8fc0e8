//! The commands, one file each.

mod config;
mod replay;

use clap::Subcommand;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::Output;

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Check, show or explain the configuration
    Config(config::ConfigCommand),
    /// Run the estimator on a recording, judged against its reference
    Replay(replay::ReplayCommand),
}

impl Command {
    /// Does it.
    pub(crate) fn run(self, output: Output) -> Result<Exit, Failure> {
        match self {
            Self::Config(command) => command.run(output),
            Self::Replay(command) => command.run(output),
        }
    }
}
