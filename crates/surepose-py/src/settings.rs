//! The configuration of a robot.

use std::path::PathBuf;

use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use surepose::param::{self, Kind, Parameter};
use surepose_config::{Config, ConfigError, Value};

/// Configuration: a value for every parameter, in the units of the keys.
///
/// ``Config({"robot.track_m": 0.4}, file="robot.toml")`` reads the file first; without arguments every parameter has its default.
/// ``config["law.k_v"]`` returns a value. Iteration yields the names.
#[pyclass(name = "Config", module = "surepose", frozen)]
#[derive(Clone)]
pub(crate) struct PyConfig {
    pub(crate) config: Config,
}

#[pymethods]
impl PyConfig {
    #[new]
    #[pyo3(signature = (settings=None, *, file=None))]
    fn new(settings: Option<Bound<'_, PyDict>>, file: Option<PathBuf>) -> PyResult<Self> {
        let mut config = Config::default();
        if let Some(file) = file {
            config = config.with_file(&file).map_err(invalid)?;
        }
        for (name, value) in settings.iter().flatten() {
            let text = value_text(&value)?;
            config = config.with_option_of("Config", &format!("{name}={text}")).map_err(invalid)?;
        }
        Ok(Self { config })
    }

    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let setting = self.config.settings().iter().find(|setting| full_name(setting.parameter) == name);
        let setting = setting.ok_or_else(|| {
            PyKeyError::new_err(format!("{name}: no such parameter; Config() lists the names by iteration"))
        })?;
        value_object(py, &setting.value)
    }

    fn __len__(&self) -> usize {
        self.config.settings().len()
    }

    fn __iter__(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let names: Vec<String> =
            self.config.settings().iter().map(|setting| full_name(setting.parameter)).collect();
        Ok(names.into_pyobject(py)?.call_method0("__iter__")?.unbind())
    }

    fn __repr__(&self) -> String {
        let default = Config::default();
        let changed = self.config.settings().iter().zip(default.settings());
        let changed = changed.filter(|(set, default)| set.value != default.value);
        let shown: Vec<String> =
            changed.map(|(set, _)| format!("'{}': {}", full_name(set.parameter), set.value)).collect();
        format!("Config({{{}}})", shown.join(", "))
    }

    /// Returns the description of a parameter: meaning, unit, default and bounds.
    #[staticmethod]
    fn explain(name: &str) -> PyResult<String> {
        let parameter = surepose_config::parameter(name).map_err(PyKeyError::new_err)?;
        let bounds = match parameter.kind {
            Kind::Number { range, .. } | Kind::Integer { range, .. } => format!(" in {range}"),
            Kind::Choice { .. } | Kind::Polygon { .. } => String::new(),
        };
        let default = Value::default_of(parameter);
        Ok(format!("{}{bounds}, default {default}: {}", full_name(parameter), parameter.meaning))
    }

    /// Distance between the wheels \[m].
    #[getter]
    fn wheel_separation(&self) -> f64 {
        self.config.number(&param::WHEEL_SEPARATION)
    }

    /// Control period \[s].
    #[getter]
    fn period(&self) -> f64 {
        self.config.number(&param::PERIOD)
    }
}

/// The configuration of an argument; `None` gives the defaults.
pub(crate) fn config_of(config: Option<&PyConfig>) -> Config {
    config.map_or_else(Config::default, |config| config.config.clone())
}

/// Converts a configuration error with the words of the program.
pub(crate) fn invalid(error: ConfigError) -> PyErr {
    PyValueError::new_err(surepose_cli::words(&error))
}

/// Text of a value as on the command line.
pub(crate) fn value_text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().to_string());
    }
    Ok(value.str()?.to_string())
}

fn full_name(parameter: &Parameter) -> String {
    format!("{}.{}", parameter.section, parameter.key)
}

fn value_object(py: Python<'_>, value: &Value) -> PyResult<Py<PyAny>> {
    Ok(match value {
        Value::Number(number) => number.into_pyobject(py)?.into_any().unbind(),
        other => other.to_string().into_pyobject(py)?.into_any().unbind(),
    })
}
