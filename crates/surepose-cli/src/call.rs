//! Commands inside another program, such as the Python package: their result is returned, not printed.

use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Parser;
use miette::Diagnostic;
use surepose_montecarlo::sweep::Trial;
use surepose_sim::simulation::Sample;

use crate::capture::{self, Captured};
use crate::output::Output;
use crate::{Program, interrupt_flags};

/// Result of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The JSON object that `--json` prints.
    pub json: String,
    /// The exit code of the program: 0 for done, 1 for a negative outcome, 4 for a robot that was stopped, 130 for a canceled command.
    pub exit: u8,
    /// Warnings, one per element.
    pub messages: Vec<String>,
    /// Time series of `run`, one sample per period; empty for other commands.
    pub samples: Vec<Sample>,
    /// Trials of `sweep`, ordered by start; empty for other commands.
    pub trials: Vec<Trial>,
}

/// Reason why a command has no result, in the words of the program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct CallError {
    /// Problem and remedy.
    pub message: String,
    /// The exit code of the program: 2 for a usage or configuration error, 3 for unreadable input.
    pub exit: u8,
}

/// Number of calls under way.
static CALLS: AtomicUsize = AtomicUsize::new(0);

/// Runs the command of `arguments`, such as `["sweep", "--runs", "1000"]`, as the program does with `--json`.
///
/// Several threads may call at the same time. No signal handler is installed.
///
/// # Errors
/// [`CallError`] where the program prints an error and no result.
pub fn call(arguments: &[String]) -> Result<Answer, CallError> {
    let line = ["surepose", "--json"].into_iter().map(str::to_owned).chain(arguments.iter().cloned());
    let program = Program::try_parse_from(line)
        .map_err(|problem| CallError { message: problem.to_string().trim_end().to_owned(), exit: 2 })?;
    let command = program.command.unwrap_or_default();
    if CALLS.fetch_add(1, Ordering::AcqRel) == 0 {
        // A cancellation ends the calls that are under way, not later ones.
        interrupt_flags::reset();
    }
    let (ended, printed) = capture::captured(|| command.run(Output { json: true }));
    CALLS.fetch_sub(1, Ordering::AcqRel);
    let exit = ended.map_err(|error| CallError { message: words(&error), exit: error.exit() as u8 })?;
    let Captured { result: json, messages, samples, trials } = printed;
    let messages = messages.iter().map(|line| line.trim_start_matches("warning: ").to_owned());
    Ok(Answer { json, exit: exit as u8, messages: messages.collect(), samples, trials })
}

/// Cancels all calls that are under way, as Ctrl-C does: a command keeps its completed results.
pub fn cancel_calls() {
    interrupt_flags::ask(false);
}

/// The error with its remedy and all related errors, without colors and frames.
pub fn words(error: &dyn Diagnostic) -> String {
    let mut lines = Vec::new();
    describe(error, &mut lines);
    lines.join("\n")
}

fn describe(error: &dyn Diagnostic, lines: &mut Vec<String>) {
    lines.push(error.to_string());
    lines.extend(error.help().map(|help| help.to_string()));
    for related in error.related().into_iter().flatten() {
        describe(related, lines);
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, call};

    fn arguments(line: &str) -> Vec<String> {
        line.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn call_returns_the_object_that_the_program_prints() {
        let Answer { json, exit, .. } = call(&arguments("sweep --runs 10")).expect("valid");
        let json: serde_json::Value = serde_json::from_str(&json).expect("one object");
        assert_eq!((json["runs"].as_u64(), json["success_rate"].as_f64(), exit), (Some(10), Some(1.0), 0));
    }

    #[test]
    fn errors_name_value_and_remedy() {
        let error = call(&arguments("sweep --set law.k_v=-1")).expect_err("invalid");
        assert!(error.exit == 2 && error.message.contains("`k_v`: negative value (got -1 1/s)"), "{error:?}");
        let error = call(&arguments("replay carmen nothing.log")).expect_err("missing");
        assert!(error.exit == 3 && error.message.contains("nothing.log"), "{error:?}");
        assert_eq!(call(&arguments("swep")).expect_err("unknown").exit, 2);
    }
}
