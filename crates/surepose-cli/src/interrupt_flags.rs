//! Process-wide flags of the interrupt handler: whether a command polls them, and when the user first asked to stop.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

static LISTENS: AtomicBool = AtomicBool::new(false);
static TERMINATED: AtomicBool = AtomicBool::new(false);
static ASKED: Mutex<Option<Instant>> = Mutex::new(None);

/// Declares that a command polls [`asked`]: from now on the first Ctrl-C does not end the program.
pub(crate) fn listen() {
    LISTENS.store(true, Ordering::Relaxed);
}

/// Whether a command polls [`asked`].
pub(crate) fn listens() -> bool {
    LISTENS.load(Ordering::Relaxed)
}

/// Notes a request to stop and returns the time since the first one; the first one decides the exit code.
pub(crate) fn ask(terminates: bool) -> Duration {
    let mut asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    if asked.is_none() {
        TERMINATED.store(terminates, Ordering::Relaxed);
    }
    asked.get_or_insert_with(Instant::now).elapsed()
}

/// Whether the first request to stop was a termination instead of Ctrl-C.
pub(crate) fn terminated() -> bool {
    TERMINATED.load(Ordering::Relaxed)
}

/// Whether the user asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.lock().unwrap_or_else(PoisonError::into_inner).is_some()
}

/// Forgets all requests to stop.
pub(crate) fn reset() {
    *ASKED.lock().unwrap_or_else(PoisonError::into_inner) = None;
}
