//! Progress on a terminal; nothing where standard error is a file or JSON was asked for.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::CliError;
use crate::interrupt;
use crate::output::Output;

/// Steps of a bar.
const STEPS: u64 = 1000;

/// How often work is looked at; short work sooner, so that nobody waits for the look.
const LOOK: Duration = Duration::from_millis(20);
const FIRST_LOOK: Duration = Duration::from_millis(1);

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

/// Looks at `work` while a thread of its own does it: shows the `part` that is done, and calls `stop` when the user asks for that.
pub(crate) fn attended<T: Send>(
    bar: &ProgressBar,
    part: impl Fn() -> f64,
    stop: impl Fn(),
    work: impl FnOnce() -> T + Send,
) -> Result<T, CliError> {
    interrupt::listen();
    let done = std::thread::scope(|scope| {
        let running = scope.spawn(work);
        let mut pause = FIRST_LOOK;
        while !running.is_finished() {
            if interrupt::asked() {
                stop();
            }
            show(bar, part());
            std::thread::sleep(pause);
            pause = (2 * pause).min(LOOK);
        }
        running.join()
    });
    bar.finish_and_clear();
    // A thread ends early only where the library is at fault; there is then nothing to report.
    done.map_err(|_| CliError::Usage {
        what: "the work ended early".to_owned(),
        help: "this is a mistake of the program".to_owned(),
    })
}

/// Shows the part of the work that is done, in [0, 1].
pub(crate) fn show(bar: &ProgressBar, part: f64) {
    bar.set_position((part * STEPS as f64) as u64);
}
