//! Process-wide flags of the interrupt handler: whether a command polls them, and when the user first asked to stop.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static LISTENS: AtomicBool = AtomicBool::new(false);
static ASKED: OnceLock<Instant> = OnceLock::new();

/// Declares that a command polls [`asked`]: from now on the first Ctrl-C does not end the program.
pub(crate) fn listen() {
    LISTENS.store(true, Ordering::Relaxed);
}

/// Whether a command polls [`asked`].
pub(crate) fn listens() -> bool {
    LISTENS.load(Ordering::Relaxed)
}

/// Notes a request to stop and returns the time since the first one.
pub(crate) fn ask() -> Duration {
    ASKED.get_or_init(Instant::now).elapsed()
}

/// Whether the user asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.get().is_some()
}
