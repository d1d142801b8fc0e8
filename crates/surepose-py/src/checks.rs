//! Conversion and checks of arguments: errors name the argument, what was given and what is expected.

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use surepose::geometry::{Angle, Frame, Pose};
use surepose::time::Stamp;

/// A pose argument: x \[m], y \[m], heading \[rad].
pub(crate) type PoseArgument = (f64, f64, f64);

/// Returns `value` if it is finite.
pub(crate) fn finite(name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!("{name}: not a finite number (got {value})")))
}

/// Returns a standard deviation, which is positive and finite.
pub(crate) fn standard_deviation(name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "{name}: a standard deviation must be positive and finite (got {value})"
    )))
}

/// Converts a pose.
pub(crate) fn pose<To: Frame, From: Frame>(
    name: &str,
    (x, y, heading): PoseArgument,
) -> PyResult<Pose<To, From, f64>> {
    for (part, value) in [("x", x), ("y", y), ("heading", heading)] {
        finite(&format!("{name}.{part}"), value)?;
    }
    Ok(Pose::new(x, y, Angle::from_radians(heading)))
}

/// Converts a time: float seconds, or int nanoseconds.
pub(crate) fn stamp(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Stamp> {
    if let Ok(seconds) = value.cast::<pyo3::types::PyFloat>() {
        return finite(name, seconds.value()).map(Stamp::from_seconds);
    }
    if let Ok(nanoseconds) = value.extract::<i64>() {
        return Ok(Stamp::from_nanoseconds(nanoseconds));
    }
    let seconds = value.extract::<f64>().map_err(|_| {
        PyTypeError::new_err(format!(
            "{name}: expected seconds (float) or nanoseconds (int), got {}",
            type_name(value)
        ))
    })?;
    finite(name, seconds).map(Stamp::from_seconds)
}

/// Copies a one-dimensional array of float32 or float64, also a strided or read-only one.
pub(crate) fn vector(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let wrong = |got: String| {
        PyTypeError::new_err(format!(
            "{name}: expected a one-dimensional array of float32 or float64, got {got}"
        ))
    };
    let untyped = value.cast::<PyUntypedArray>().map_err(|_| wrong(type_name(value)))?;
    if untyped.ndim() != 1 {
        let got = format!("shape {:?}", untyped.shape());
        return Err(PyValueError::new_err(format!("{name}: expected a one-dimensional array, got {got}")));
    }
    if let Ok(array) = value.cast::<PyArrayDyn<f32>>() {
        return Ok(array.readonly().as_array().iter().map(|value| f64::from(*value)).collect());
    }
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>() {
        return Ok(array.readonly().as_array().iter().copied().collect());
    }
    Err(wrong(format!("dtype {}", untyped.dtype())))
}

/// Copies an array of float64 with shape (n, `columns`).
pub(crate) fn rows(name: &str, value: &Bound<'_, PyAny>, columns: usize) -> PyResult<Vec<Vec<f64>>> {
    let untyped = value.cast::<PyUntypedArray>().map_err(|_| {
        PyTypeError::new_err(format!("{name}: expected an array of float64, got {}", type_name(value)))
    })?;
    if untyped.ndim() != 2 || untyped.shape().get(1) != Some(&columns) {
        return Err(PyValueError::new_err(format!(
            "{name}: expected shape (n, {columns}), got {:?}",
            untyped.shape()
        )));
    }
    let array = value.cast::<PyArrayDyn<f64>>().map_err(|_| {
        PyTypeError::new_err(format!("{name}: expected dtype float64, got dtype {}", untyped.dtype()))
    })?;
    let values: Vec<f64> = array.readonly().as_array().iter().copied().collect();
    Ok(values.chunks(columns).map(<[f64]>::to_vec).collect())
}

/// Name of the type of `value`, for messages.
pub(crate) fn type_name(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "an unknown type".to_owned(), |name| name.to_string())
}
