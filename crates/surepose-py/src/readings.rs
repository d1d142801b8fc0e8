//! Readings of sensors: scans, yaw rates, and measurements of the pose by any sensor.

use numpy::PyArray1;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use surepose::estimation::{
    HeadingMeasurement, LineMeasurement, Measurement, PoseMeasurement, PositionMeasurement,
    RangeBearingMeasurement,
};
use surepose::geometry::{Angle, Line, Point};
use surepose::lidar::Scan;
use surepose::linalg::Matrix;
use surepose::localization::SensorReading;
use surepose::time::{Stamp, Stamped};

use crate::checks::{self, PoseArgument, type_name};

/// A laser scan: range of each beam [m], counter-clockwise from `angle_min` [rad] by `angle_increment` [rad].
///
/// NaN, infinite and zero ranges are beams without a return. `stamp` is the time of the first beam, in seconds (float) or nanoseconds
/// (int); `None` is that of the step. `time_increment` is the time from one beam to the next [s].
#[pyclass(name = "Scan", module = "surepose", frozen)]
pub(crate) struct PyScan {
    ranges: Vec<f64>,
    angle_min: Angle<f64>,
    angle_increment: f64,
    time_increment: f64,
    stamp: Option<Stamp>,
}

#[pymethods]
impl PyScan {
    #[new]
    #[pyo3(signature = (ranges, angle_min, angle_increment, *, stamp=None, time_increment=0.0))]
    fn new(
        ranges: &Bound<'_, PyAny>,
        angle_min: f64,
        angle_increment: f64,
        stamp: Option<&Bound<'_, PyAny>>,
        time_increment: f64,
    ) -> PyResult<Self> {
        let ranges = checks::vector("ranges", ranges)?;
        if ranges.is_empty() {
            return Err(PyValueError::new_err("ranges: empty (expected one range per beam)"));
        }
        Ok(Self {
            ranges,
            angle_min: Angle::from_radians(checks::finite("angle_min", angle_min)?),
            angle_increment: checks::finite("angle_increment", angle_increment)?,
            time_increment: checks::finite("time_increment", time_increment)?,
            stamp: stamp.map(|stamp| checks::stamp("stamp", stamp)).transpose()?,
        })
    }

    /// Range of each beam [m].
    #[getter]
    fn ranges<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.ranges)
    }

    /// Direction of the first beam from the x axis of the laser [rad].
    #[getter]
    fn angle_min(&self) -> f64 {
        self.angle_min.radians()
    }

    /// Angle from one beam to the next [rad].
    #[getter]
    fn angle_increment(&self) -> f64 {
        self.angle_increment
    }

    /// Time of the first beam [s]; `None` is that of the step.
    #[getter]
    fn stamp(&self) -> Option<f64> {
        self.stamp.map(Stamp::seconds)
    }

    fn __len__(&self) -> usize {
        self.ranges.len()
    }

    fn __repr__(&self) -> String {
        format!("Scan({} beams, stamp={:?})", self.ranges.len(), self.stamp())
    }
}

impl PyScan {
    /// A simulated scan.
    pub(crate) fn simulated(stamp: Stamp, scan: Scan<'_, f64>) -> Self {
        Self {
            ranges: scan.ranges.to_vec(),
            angle_min: scan.angle_min,
            angle_increment: scan.angle_increment,
            time_increment: scan.time_increment,
            stamp: Some(stamp),
        }
    }

    fn scan(&self) -> Scan<'_, f64> {
        Scan::new(self.angle_min, self.angle_increment, &self.ranges).with_time_increment(self.time_increment)
    }
}

/// Mean yaw rate of a gyroscope [rad/s], counter-clockwise, with its bias.
#[pyclass(name = "YawRate", module = "surepose", frozen)]
pub(crate) struct PyYawRate {
    rate: f64,
    stamp: Option<Stamp>,
}

#[pymethods]
impl PyYawRate {
    #[new]
    #[pyo3(signature = (rate, *, stamp=None))]
    fn new(rate: f64, stamp: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self { rate, stamp: stamp.map(|stamp| checks::stamp("stamp", stamp)).transpose()? })
    }

    /// Yaw rate [rad/s].
    #[getter]
    fn rate(&self) -> f64 {
        self.rate
    }
}

impl PyYawRate {
    pub(crate) fn simulated(stamp: Stamp, rate: f64) -> Self {
        Self { rate, stamp: Some(stamp) }
    }
}

/// A measurement of the pose by any sensor; the static methods build one for each kind.
///
/// A NaN or an outlier is no error: the filter rejects and counts it.
#[pyclass(name = "Measurement", module = "surepose", frozen)]
#[derive(Clone, Copy)]
pub(crate) struct PyMeasurement {
    pub(crate) measurement: Measurement<f64>,
    pub(crate) stamp: Option<Stamp>,
}

#[pymethods]
impl PyMeasurement {
    /// Absolute heading in the map frame [rad], as of a compass.
    #[staticmethod]
    #[pyo3(signature = (heading, std, *, stamp=None))]
    fn heading(heading: f64, std: f64, stamp: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let heading = Angle::from_radians(heading);
        let std = checks::standard_deviation("std", std)?;
        Self::of(Measurement::Heading(HeadingMeasurement { heading, std }), stamp)
    }

    /// Position of the body in the map frame [m], with the standard deviation of each coordinate.
    #[staticmethod]
    #[pyo3(signature = (x, y, std, *, stamp=None))]
    fn position(x: f64, y: f64, std: f64, stamp: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let variance = checks::standard_deviation("std", std)?.powi(2);
        let position = PositionMeasurement {
            position: Point::new(x, y),
            x_variance: variance,
            y_variance: variance,
            covariance: 0.0,
        };
        Self::of(Measurement::Position(position), stamp)
    }

    /// Pose (x, y, heading) with independent standard deviations; infinity for an unknown coordinate.
    #[staticmethod]
    #[pyo3(signature = (pose, std, *, stamp=None))]
    fn pose(pose: PoseArgument, std: (f64, f64, f64), stamp: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        if [std.0, std.1, std.2].iter().any(|std| std.is_nan() || *std <= 0.0) {
            let message =
                format!("std: standard deviations must be positive (got {}, {}, {})", std.0, std.1, std.2);
            return Err(PyValueError::new_err(message));
        }
        let information = [std.0, std.1, std.2].map(|std| 1.0 / (std * std));
        let mut matrix = Matrix([[0.0; 3]; 3]);
        for (axis, information) in information.into_iter().enumerate() {
            matrix[(axis, axis)] = information;
        }
        let pose = PoseMeasurement { pose: checks::pose("pose", pose)?, information: matrix };
        Self::of(Measurement::Pose(pose), stamp)
    }

    /// Range [m] and bearing [rad] of a landmark at a known position (x, y) [m].
    #[staticmethod]
    #[pyo3(signature = (landmark, range, bearing, range_std, bearing_std, *, stamp=None))]
    fn range_bearing(
        landmark: (f64, f64),
        range: f64,
        bearing: f64,
        range_std: f64,
        bearing_std: f64,
        stamp: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let landmark = Point::new(landmark.0, landmark.1);
        let range_std = checks::standard_deviation("range_std", range_std)?;
        let bearing_std = checks::standard_deviation("bearing_std", bearing_std)?;
        let bearing = Angle::from_radians(bearing);
        let measured = RangeBearingMeasurement { landmark, range, bearing, range_std, bearing_std };
        Self::of(Measurement::RangeBearing(measured), stamp)
    }

    /// A wall of the map, (distance [m], direction [rad]) of its normal form, seen at (distance, direction) in the body frame.
    #[staticmethod]
    #[pyo3(signature = (wall, seen, distance_std, direction_std, *, stamp=None))]
    fn line(
        wall: (f64, f64),
        seen: (f64, f64),
        distance_std: f64,
        direction_std: f64,
        stamp: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let measured = LineMeasurement {
            wall: Line::new(wall.0, Angle::from_radians(wall.1)),
            seen: Line::new(seen.0, Angle::from_radians(seen.1)),
            distance_variance: checks::standard_deviation("distance_std", distance_std)?.powi(2),
            direction_variance: checks::standard_deviation("direction_std", direction_std)?.powi(2),
            covariance: 0.0,
            wall_variance: 0.0,
        };
        Self::of(Measurement::Line(measured), stamp)
    }

    fn __repr__(&self) -> String {
        format!("{:?}", self.measurement)
    }
}

impl PyMeasurement {
    fn of(measurement: Measurement<f64>, stamp: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let stamp = stamp.map(|stamp| checks::stamp("stamp", stamp)).transpose()?;
        Ok(Self { measurement, stamp })
    }

    pub(crate) fn simulated(stamp: Stamp, measurement: Measurement<f64>) -> Self {
        Self { measurement, stamp: Some(stamp) }
    }
}

/// Any reading, borrowed from Python.
pub(crate) enum Reading<'py> {
    Scan(PyRef<'py, PyScan>),
    Measurement(PyRef<'py, PyMeasurement>),
    YawRate(PyRef<'py, PyYawRate>),
}

impl Reading<'_> {
    /// The reading for a step at `now`.
    pub(crate) fn at(&self, now: Stamp) -> Stamped<SensorReading<'_, f64>> {
        let (stamp, value) = match self {
            Self::Scan(scan) => (scan.stamp, SensorReading::Scan(scan.scan())),
            Self::Measurement(measured) => (measured.stamp, SensorReading::Measurement(measured.measurement)),
            Self::YawRate(measured) => (measured.stamp, SensorReading::YawRate(measured.rate)),
        };
        Stamped::new(stamp.unwrap_or(now), value)
    }
}

/// The readings of a sequence, or one reading; `None` gives none.
pub(crate) fn readings<'py>(value: Option<&Bound<'py, PyAny>>) -> PyResult<Vec<Reading<'py>>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    if let Some(reading) = reading(value) {
        return Ok(vec![reading]);
    }
    let wrong = |got: &Bound<'_, PyAny>| {
        let got = type_name(got);
        PyTypeError::new_err(format!(
            "readings: expected Scan, Measurement or YawRate, or a sequence of them, got {got}"
        ))
    };
    let mut readings = Vec::new();
    for element in value.try_iter().map_err(|_| wrong(value))? {
        let element = element?;
        readings.push(reading(&element).ok_or_else(|| wrong(&element))?);
    }
    Ok(readings)
}

fn reading<'py>(value: &Bound<'py, PyAny>) -> Option<Reading<'py>> {
    if let Ok(scan) = value.cast::<PyScan>() {
        return Some(Reading::Scan(scan.borrow()));
    }
    if let Ok(measured) = value.cast::<PyMeasurement>() {
        return Some(Reading::Measurement(measured.borrow()));
    }
    value.cast::<PyYawRate>().ok().map(|measured| Reading::YawRate(measured.borrow()))
}
