//! Ctrl-C, and a request to terminate: a command that keeps what was done is asked to stop, and a second Ctrl-C ends it at once; any other ends.

use std::io::Write;
use std::time::Duration;

use serde_json::{Map, Value, json};

use crate::error::CliError;
use crate::exit::Exit;
use crate::interrupt_flags::{self, listens};
use crate::output::{Output, text, warning};

pub(crate) use crate::interrupt_flags::{asked, listen};

/// The key that says so in a result.
const INTERRUPTED: &str = "interrupted";

/// What is said where nothing else is.
const NOTHING: &str = "interrupted: nothing was done that could be kept";

/// What comes sooner after the first is the same Ctrl-C: programs that start others send it to the program *and* to its group.
const SAME: Duration = Duration::from_millis(300);

/// From now on Ctrl-C ends the program with the exit code that says so, and with a result in which nothing else is, until a command
/// listens.
pub(crate) fn install(output: Output) {
    let installed = ctrlc::set_handler(move || {
        let asks_again = interrupt_flags::ask() > SAME;
        if !listens() {
            warning(NOTHING);
            // Held until the end: there is one result.
            let mut out = std::io::stdout().lock();
            if output.json && !listens() {
                // Whoever cannot be told so has the exit code.
                drop(out.write_all(empty().as_bytes()));
            }
            std::process::exit(Exit::Interrupted as i32);
        }
        if asks_again {
            std::process::exit(Exit::Interrupted as i32);
        }
    });
    // Where there is no such signal, Ctrl-C ends the program as it always did.
    drop(installed);
}

/// Ends a command that stopped when it was asked to, with nothing to keep.
///
/// # Errors
/// Those of standard output.
pub(crate) fn nothing(output: Output) -> Result<Exit, CliError> {
    warning(NOTHING);
    if output.json {
        text(&empty())?;
    }
    Ok(Exit::Interrupted)
}

/// The result in which nothing else is.
fn empty() -> String {
    format!("{}\n", json!({ INTERRUPTED: true }))
}

/// Says in a result that it is only of what was done when the user asked to stop.
pub(crate) fn mark(json: &mut Map<String, Value>) {
    if asked() {
        json.insert(INTERRUPTED.to_owned(), Value::Bool(true));
        warning("interrupted: the result is only of what was done until then");
    }
}
