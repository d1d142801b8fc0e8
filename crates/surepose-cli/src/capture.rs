//! Results and messages of a command that another program calls: kept instead of printed.

use std::cell::RefCell;
use std::fmt::Display;

use surepose_montecarlo::sweep::Trial;
use surepose_sim::simulation::Sample;

thread_local! {
    /// Output of the command on this thread; `None` prints it on the standard streams.
    static CAPTURED: RefCell<Option<Captured>> = const { RefCell::new(None) };
}

/// Output of a command.
#[derive(Debug, Default)]
pub(crate) struct Captured {
    /// Text for standard output.
    pub(crate) result: String,
    /// Lines for standard error.
    pub(crate) messages: Vec<String>,
    /// Time series of `run`.
    pub(crate) samples: Vec<Sample>,
    /// Trials of `sweep`.
    pub(crate) trials: Vec<Trial>,
}

/// Runs `work` and returns what it printed on this thread.
pub(crate) fn captured<T>(work: impl FnOnce() -> T) -> (T, Captured) {
    CAPTURED.set(Some(Captured::default()));
    let value = work();
    (value, CAPTURED.take().unwrap_or_default())
}

/// Keeps text for standard output; `false` if it is to be printed.
pub(crate) fn result(text: &str) -> bool {
    with(|captured| captured.result.push_str(text))
}

/// Keeps a line for standard error; `false` if it is to be printed.
pub(crate) fn message(line: &dyn Display) -> bool {
    with(|captured| captured.messages.push(line.to_string()))
}

/// Keeps a time series for the caller; a program without a caller does not need it.
pub(crate) fn samples(samples: &[Sample]) {
    with(|captured| captured.samples = samples.to_vec());
}

/// Keeps trials for the caller; a program without a caller does not need them.
pub(crate) fn trials(trials: &[Trial]) {
    with(|captured| captured.trials = trials.to_vec());
}

fn with(keep: impl FnOnce(&mut Captured)) -> bool {
    CAPTURED.with_borrow_mut(|captured| captured.as_mut().map(keep).is_some())
}
