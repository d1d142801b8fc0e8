//! Commands of the program, called in this process: the same words, options, numbers and seeds.

use std::time::Duration;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use surepose_cli::{Answer, CallError};
use surepose_montecarlo::sweep::{SweepReport, Trial};
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
        for (name, ratio) in
            [("time_ratio", Trial::time_ratio as fn(&Trial) -> _), ("path_ratio", Trial::path_ratio)]
        {
            let values = trials.iter().map(|trial| ratio(trial).unwrap_or(f64::NAN));
            columns.set_item(name, PyArray1::from_iter(py, values))?;
        }
        numbers!(trials; start_x_m, start_y_m, start_heading_deg, success, steps, optimal_time_s, final_position_error_m,
            final_heading_error_deg);
        optional_numbers!(trials; time_s, path_m, cusps, nees_mean, position_rmse_m, heading_rmse_deg, refused_part);
    }
    Ok(columns)
}

/// Returns the figures of trials in JSON, as `sweep` prints them; the columns are those of [`call`].
#[pyfunction]
pub(crate) fn sweep_figures(columns: &Bound<'_, PyDict>, seed: u64) -> PyResult<String> {
    let numbers = |name: &str| -> PyResult<Option<Vec<f64>>> {
        let column = columns.get_item(name)?;
        column.map(|column| crate::checks::vector(name, &column)).transpose()
    };
    let required = |name: &str| {
        numbers(name)?.ok_or_else(|| PyValueError::new_err(format!("columns: {name} is missing")))
    };
    let missing = |name: &str| PyValueError::new_err(format!("columns: {name} is missing"));
    let success = columns.get_item("success")?.ok_or_else(|| missing("success"))?;
    let success: Vec<bool> = success.cast_into::<PyArray1<bool>>()?.readonly().as_array().to_vec();
    let steps = columns.get_item("steps")?.ok_or_else(|| missing("steps"))?;
    let steps: Vec<u64> = steps.cast_into::<PyArray1<u64>>()?.readonly().as_array().to_vec();
    let [x, y, heading, optimal, position_error, heading_error] = [
        required("start_x_m")?,
        required("start_y_m")?,
        required("start_heading_deg")?,
        required("optimal_time_s")?,
        required("final_position_error_m")?,
        required("final_heading_error_deg")?,
    ];
    let optional =
        ["time_s", "path_m", "cusps", "nees_mean", "position_rmse_m", "heading_rmse_deg", "refused_part"];
    let optional = optional.into_iter().map(numbers).collect::<PyResult<Vec<_>>>()?;
    let value = |column: usize, row: usize| {
        let value = optional.get(column)?.as_ref()?.get(row).copied()?;
        (!value.is_nan()).then_some(value)
    };
    let at = |column: &[f64], row: usize| column.get(row).copied().unwrap_or(f64::NAN);
    let trials = success.into_iter().zip(steps).enumerate().map(|(row, (success, steps))| Trial {
        start_x_m: at(&x, row),
        start_y_m: at(&y, row),
        start_heading_deg: at(&heading, row),
        success,
        steps,
        time_s: value(0, row),
        optimal_time_s: at(&optimal, row),
        path_m: value(1, row),
        cusps: value(2, row),
        final_position_error_m: at(&position_error, row),
        final_heading_error_deg: at(&heading_error, row),
        nees_mean: value(3, row),
        position_rmse_m: value(4, row),
        heading_rmse_deg: value(5, row),
        refused_part: value(6, row),
    });
    let report = SweepReport::from_trials(trials.collect(), 0.0, seed);
    serde_json::to_string(&report).map_err(|error| PyValueError::new_err(error.to_string()))
}
