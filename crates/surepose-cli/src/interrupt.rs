//! Ctrl-C, and a request to terminate: a command that keeps what was done is asked to stop, and a second Ctrl-C ends it at once; any other ends.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Map, Value};

use crate::exit::Exit;
use crate::output::warning;

static LISTENS: AtomicBool = AtomicBool::new(false);
static ASKED: OnceLock<Instant> = OnceLock::new();

/// What comes sooner after the first is the same Ctrl-C: programs that start others send it to the program *and* to its group.
const SAME: Duration = Duration::from_millis(300);

/// From now on Ctrl-C ends the program with the exit code that says so, until a command listens.
pub(crate) fn install() {
    let heard = ctrlc::set_handler(|| {
        let asks_again = ASKED.get_or_init(Instant::now).elapsed() > SAME;
        if asks_again || !LISTENS.load(Ordering::Relaxed) {
            std::process::exit(Exit::Interrupted as i32);
        }
    });
    // Where there is no such signal, Ctrl-C ends the program as it always did.
    drop(heard);
}

/// From now on the first Ctrl-C only asks.
pub(crate) fn listen() {
    LISTENS.store(true, Ordering::Relaxed);
}

/// Whether the user asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.get().is_some()
}

/// Says in a result that it is only of what was done when the user asked to stop.
pub(crate) fn mark(json: &mut Map<String, Value>) {
    if asked() {
        json.insert("interrupted".to_owned(), Value::Bool(true));
        warning("interrupted: the result is only of what was done until then");
    }
}
