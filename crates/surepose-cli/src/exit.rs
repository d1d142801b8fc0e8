//! Exit codes, on which scripts rely.

use std::process::ExitCode;

/// The exit code of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Goal reached, certificate holds, files written.
    Done = 0,
    /// Completed with a negative outcome.
    Negative = 1,
    /// Invalid command line or configuration.
    Usage = 2,
    /// Input data unreadable or malformed.
    Data = 3,
    /// The supervisor stopped the robot.
    Stopped = 4,
    /// Interrupted by the user; completed results are kept.
    Interrupted = 130,
    /// Interrupted by SIGTERM or SIGHUP; completed results are kept.
    Terminated = 143,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}
