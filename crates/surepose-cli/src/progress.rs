//! Progress on a terminal; nothing where standard error is a file or JSON was asked for.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use crate::output::Output;

/// Steps of a bar.
const STEPS: u64 = 1000;

/// A bar for work called `name`.
pub(crate) fn bar(output: Output, name: &'static str) -> ProgressBar {
    if output.json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(STEPS).with_message(name);
    // The template is a constant; were it wrong, the library's own would do.
    if let Ok(style) = ProgressStyle::with_template("{msg:>12} {wide_bar} {percent:>3} %") {
        bar.set_style(style);
    }
    bar
}

/// Shows the part of the work that is done, in [0, 1].
pub(crate) fn show(bar: &ProgressBar, part: f64) {
    bar.set_position((part * STEPS as f64) as u64);
}
