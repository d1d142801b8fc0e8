//! Shows progress on a terminal; hidden if standard error is not a terminal or `--json` is set.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::CliError;
use crate::interrupt;
use crate::output::Output;

/// Resolution of a progress bar \[steps].
const STEPS: u64 = 1000;

/// Maximum polling interval of [`attended`].
const LOOK: Duration = Duration::from_millis(20);
/// Initial polling interval; it doubles up to [`LOOK`], so that short work is not delayed.
const FIRST_LOOK: Duration = Duration::from_millis(1);

/// Creates a progress bar with the label `name`.
pub(crate) fn bar(output: Output, name: &'static str) -> ProgressBar {
    if output.json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(STEPS).with_message(name);
    // The template is constant and valid; otherwise the default style remains.
    if let Ok(style) = ProgressStyle::with_template("{msg:>12} {wide_bar} {percent:>3} %") {
        bar.set_style(style);
    }
    bar
}

/// Runs `work` on a thread, shows its progress `part` in \[0, 1], and calls `stop` after Ctrl-C.
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
    // The thread panics only through a bug in a library; then there is no result.
    done.map_err(|_| CliError::Usage {
        what: "internal error: the computation ended early".to_owned(),
        help: "report this as a bug".to_owned(),
    })
}

/// Shows the progress `part`, in \[0, 1].
pub(crate) fn show(bar: &ProgressBar, part: f64) {
    bar.set_position((part * STEPS as f64) as u64);
}
