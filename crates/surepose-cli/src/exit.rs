//! Exit codes: part of the contract with scripts.

use std::process::ExitCode;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Goal reached, certificate holds, files written.
    Done = 0,
    /// It ran, but the outcome is negative.
    Negative = 1,
    /// The command line or the configuration is wrong.
    Usage = 2,
    /// Input data cannot be read, or is malformed.
    Data = 3,
    /// The robot was stopped before it did harm.
    Stopped = 4,
    /// The user interrupted; what was finished is kept.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}
