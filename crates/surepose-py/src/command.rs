//! Commands of the program, called in this process: the same words, options, numbers and seeds.

use std::time::Duration;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use surepose_cli::{Answer, CallError};
use surepose_sim::simulation::ControlMode;

pyo3::create_exception!(
    surepose,
    CommandError,
    pyo3::exceptions::PyValueError,
    "A command failed; the message is that of the program. The second argument is the exit code: 2 for a usage or configuration error, 3 for unreadable input."
);

/// Interval at which Ctrl-C is looked for.
const POLL: Duration = Duration::from_millis(20);

/// Runs a command and returns (JSON text, exit code, warnings, columns): the columns are numpy arrays of the time series of `run` or
/// the trials of `sweep`, by name.
///
/// Other Python threads run meanwhile. Ctrl-C cancels the command and raises KeyboardInterrupt.
#[pyfunction]
pub(crate) fn call(
    py: Python<'_>,
    arguments: Vec<String>,
) -> PyResult<(String, u8, Vec<String>, Bound<'_, PyDict>)> {
    let answer = attended(py, &arguments)?;
    let answer = answer.map_err(|CallError { message, exit }| CommandError::new_err((message, exit)))?;
    let columns = columns(py, &answer)?;
    Ok((answer.json, answer.exit, answer.messages, columns))
}

/// Runs the command on a thread, without the interpreter lock, and handles signals until it ends.
fn attended(py: Python<'_>, arguments: &[String]) -> PyResult<Result<Answer, CallError>> {
    std::thread::scope(|scope| {
        let (sender, receiver) = std::sync::mpsc::channel();
        scope.spawn(move || sender.send(surepose_cli::call(arguments)));
        let mut interrupt = None;
        let receiver = std::sync::Mutex::new(receiver);
        loop {
            let ended = py.detach(|| {
                let receiver = receiver.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                receiver.recv_timeout(POLL)
            });
            match ended {
                Ok(answer) => return interrupt.map_or(Ok(answer), Err),
                Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {}
                Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => {
                    let message =
                        "internal error: the computation ended early; report this as a bug".to_owned();
                    return Ok(Err(CallError { message, exit: 2 }));
                }
            }
            if interrupt.is_none()
                && let Err(signal) = py.check_signals()
            {
                surepose_cli::cancel_calls();
                interrupt = Some(signal);
            }
        }
    })
}

/// The columns of a time series or of trials.
fn columns<'py>(py: Python<'py>, answer: &Answer) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    macro_rules! numbers {
        ($rows:expr; $($field:ident),+) => {
            $(columns.set_item(stringify!($field), PyArray1::from_iter(py, $rows.iter().map(|row| row.$field)))?;)+
        };
    }
    macro_rules! optional_numbers {
        ($rows:expr; $($field:ident),+) => {
            $(if $rows.iter().any(|row| row.$field.is_some()) {
                let values = $rows.iter().map(|row| row.$field.unwrap_or(f64::NAN));
                columns.set_item(stringify!($field), PyArray1::from_iter(py, values))?;
            })+
        };
    }
    let (samples, trials) = (&answer.samples, &answer.trials);
    if !samples.is_empty() {
        numbers!(samples; time_s, x_m, y_m, heading_deg, estimated_x_m, estimated_y_m, estimated_heading_deg, variance_x_m2,
            variance_y_m2, covariance_xy_m2, heading_std_deg, nees, v_m_s, omega_deg_s, commanded_v_m_s,
            commanded_omega_deg_s, goal_distance_m, heading_error_deg, lyapunov, local, reverse);
        let holding = samples.iter().map(|sample| sample.mode == ControlMode::Holding);
        columns.set_item("holding", PyArray1::from_iter(py, holding))?;
    }
    if !trials.is_empty() {
        numbers!(trials; start_x_m, start_y_m, start_heading_deg, success, steps, optimal_time_s, final_position_error_m,
            final_heading_error_deg);
        optional_numbers!(trials; time_s, path_m, cusps, nees_mean, position_rmse_m, heading_rmse_deg, refused_part);
    }
    Ok(columns)
}
