//! The simulated world, driven from Python: for custom sensors and custom control laws.

use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::kinematics::{DiffDrive, Twist};
use surepose::time::Stamped;
use surepose_config::{CompassParameters, Config};
use surepose_sim::robot::{Scenario, scan_view};
use surepose_sim::{Seed, SensorOutput, World, WorldSettings};

use crate::belief::tuple;
use crate::checks::{self, PoseArgument};
use crate::readings::{PyMeasurement, PyScan, PyYawRate};
use crate::settings::{PyConfig, config_of, invalid, value_text};

/// A robot in its arena, with motors, encoders, compass and laser.
///
/// `world` makes the world differ from `config`, as `surepose run --world`: ``{"robot.track_m": 0.57}``.
#[pyclass(name = "Simulator", module = "surepose")]
pub(crate) struct PySimulator {
    world: World,
    /// Geometry that the robot assumes.
    drive: DiffDrive<f64>,
    compass: CompassParameters,
    period: f64,
    goal: PoseArgument,
}

#[pymethods]
impl PySimulator {
    #[new]
    #[pyo3(signature = (config=None, *, world=None, seed=1))]
    fn new(
        config: Option<PyRef<'_, PyConfig>>,
        world: Option<Bound<'_, PyDict>>,
        seed: u64,
    ) -> PyResult<Self> {
        let scenario = scenario(config_of(config.as_deref()), world)?;
        scenario.check_clearance().map_err(|problem| PyValueError::new_err(problem.to_string()))?;
        Ok(Self {
            world: World::new(scenario.world(), scenario.true_start(), Seed(seed)),
            drive: scenario.config.drive(),
            compass: scenario.config.compass(),
            period: scenario.config.controller().period,
            goal: tuple(scenario.goal()),
        })
    }

    /// Drives with speed `v` [m/s] and turn rate `omega` [rad/s] for one period; `duration` [s] replaces the period.
    #[pyo3(signature = (v, omega, *, duration=None))]
    fn step(&mut self, py: Python<'_>, v: f64, omega: f64, duration: Option<f64>) -> PyResult<PySensorFrame> {
        let duration = duration.unwrap_or(self.period);
        if !(1e-4..=10.0).contains(&duration) {
            return Err(PyValueError::new_err(format!("duration: expected 0.0001 to 10 s (got {duration})")));
        }
        let twist = Twist::new(checks::finite("v", v)?, checks::finite("omega", omega)?);
        let output = self.world.step(self.drive.wheel_rates_from_twist(twist), duration);
        PySensorFrame::new(py, &output, &self.compass)
    }

    /// True pose (x, y, heading) [m, m, rad].
    #[getter]
    fn pose(&self) -> PoseArgument {
        tuple(self.world.pose())
    }

    /// True speed [m/s] and turn rate [rad/s].
    #[getter]
    fn twist(&self) -> (f64, f64) {
        let twist = self.world.twist();
        (twist.v, twist.omega)
    }

    /// Configured goal (x, y, heading) [m, m, rad].
    #[getter]
    fn goal(&self) -> PoseArgument {
        self.goal
    }

    /// Time since the start [s].
    #[getter]
    fn time(&self) -> f64 {
        self.world.now().seconds()
    }

    /// Control period [s].
    #[getter]
    fn period(&self) -> f64 {
        self.period
    }

    /// Walls of the arena, one row x0, y0, x1, y1 [m] each.
    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let walls = self.world.model().arena.walls().iter();
        let rows: Vec<Vec<f64>> =
            walls.map(|wall| vec![wall.start.x, wall.start.y, wall.end.x, wall.end.y]).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }
}

/// The scenario of a configuration, in a world that may differ from it.
fn scenario(config: Config, world: Option<Bound<'_, PyDict>>) -> PyResult<Scenario> {
    let mut options = Vec::new();
    for (name, value) in world.iter().flatten() {
        options.push(format!("{name}={}", value_text(&value)?));
    }
    let world_settings = WorldSettings::from_options(options.iter().map(String::as_str)).map_err(invalid)?;
    Ok(Scenario { world_settings, ..Scenario::configured(config) })
}

/// Readings of the sensors during one period, ready for `Navigator.step`.
#[pyclass(name = "SensorFrame", module = "surepose", frozen, get_all)]
pub(crate) struct PySensorFrame {
    /// Time of the step [s].
    stamp: f64,
    /// Travel of the right and the left wheel by the encoders [m].
    wheel_travel: (f64, f64),
    /// Scans, headings and yaw rates that arrived, each with its time.
    readings: Py<PyList>,
}

impl PySensorFrame {
    fn new(py: Python<'_>, output: &SensorOutput, compass: &CompassParameters) -> PyResult<Self> {
        let readings = PyList::empty(py);
        if let Some(rate) = output.yaw_rate {
            readings.append(Py::new(py, PyYawRate::simulated(output.stamp, rate))?)?;
        }
        for &Stamped { stamp, value } in &output.headings {
            let heading = HeadingMeasurement { heading: value - compass.offset, std: compass.std };
            readings.append(Py::new(py, PyMeasurement::simulated(stamp, Measurement::Heading(heading)))?)?;
        }
        for Stamped { stamp, value } in &output.scans {
            readings.append(Py::new(py, PyScan::simulated(*stamp, scan_view(value)))?)?;
        }
        Ok(Self {
            stamp: output.stamp.seconds(),
            wheel_travel: (output.rims.right, output.rims.left),
            readings: readings.unbind(),
        })
    }
}
