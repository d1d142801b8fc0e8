//! Handles Ctrl-C and SIGTERM.
//!
//! A command that keeps partial results is asked to stop; a second signal ends it at once. Other commands end at once.
//! The exit code is 130 after Ctrl-C, and 143 after SIGTERM or SIGHUP.

use std::io::Write;
use std::time::Duration;

use serde_json::{Map, Value, json};

use crate::error::CliError;
use crate::exit::Exit;
use crate::interrupt_flags::{self, listens};
use crate::output::{Output, text, warning};

pub(crate) use crate::interrupt_flags::{asked, listen};

/// The JSON key of an interrupted result.
const INTERRUPTED: &str = "interrupted";

/// The message of a command without a partial result.
const NOTHING: &str = "interrupted: nothing was completed";

/// Signals within this time count as one Ctrl-C: parent programs signal the process and its process group.
const SAME: Duration = Duration::from_millis(300);

/// Installs the signal handler.
///
/// Until a command calls [`listen`], a signal ends the program with the exit code of the signal and, with `--json`, an empty
/// result.
pub(crate) fn install(output: Output) {
    let installed = on_signal(move |terminates| {
        let asks_again = interrupt_flags::ask(terminates) > SAME;
        if !listens() {
            warning(NOTHING);
            // The lock is held until exit, so that only one result is printed.
            let mut out = std::io::stdout().lock();
            if output.json && !listens() {
                // If standard output fails, the exit code still reports the interrupt.
                drop(out.write_all(empty().as_bytes()));
            }
            std::process::exit(exit_code(Exit::Interrupted) as i32);
        }
        if asks_again {
            std::process::exit(exit_code(Exit::Interrupted) as i32);
        }
    });
    // Where there is no such signal, Ctrl-C ends the program as it always did.
    drop(installed);
}

/// Returns the exit code: that of the signal for an interrupted command.
pub(crate) fn exit_code(exit: Exit) -> Exit {
    match exit {
        Exit::Interrupted if interrupt_flags::terminated() => Exit::Terminated,
        other => other,
    }
}

/// Calls `handle` on a thread for every signal, with whether it is a termination instead of Ctrl-C.
#[cfg(unix)]
fn on_signal(mut handle: impl FnMut(bool) + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            handle(signal != SIGINT);
        }
    })?;
    Ok(())
}

#[cfg(not(unix))]
fn on_signal(mut handle: impl FnMut(bool) + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || handle(false))
}

/// Reports an interrupted command without a partial result.
///
/// # Errors
/// [`CliError::Print`] if standard output is not writable.
pub(crate) fn nothing(output: Output) -> Result<Exit, CliError> {
    warning(NOTHING);
    if output.json {
        text(&empty())?;
    }
    Ok(Exit::Interrupted)
}

/// The JSON result without any other key.
fn empty() -> String {
    format!("{}\n", json!({ INTERRUPTED: true }))
}

/// Marks a result as partial if the user interrupted the command.
pub(crate) fn mark(json: &mut Map<String, Value>) {
    if asked() {
        json.insert(INTERRUPTED.to_owned(), Value::Bool(true));
        warning("interrupted: the result covers only the work completed until then");
    }
}
