//! Pose estimate with covariance.

use numpy::PyArray2;
use pyo3::prelude::*;
use surepose::estimation::Belief;
use surepose::geometry::Pose;

use crate::checks::{self, PoseArgument};

/// Standard deviations of a start pose that is given without them: x [m], y [m], heading [rad].
const START_STD: [f64; 3] = [0.01, 0.01, 0.01];

/// Pose estimate: position [m] and heading [rad] in the map frame, with covariance.
#[pyclass(name = "Belief", module = "surepose", frozen)]
#[derive(Clone, Copy)]
pub(crate) struct PyBelief {
    pub(crate) belief: Belief<f64>,
}

#[pymethods]
impl PyBelief {
    /// Belief at `pose` (x, y, heading) with independent standard deviations.
    #[new]
    #[pyo3(signature = (pose=(0.0, 0.0, 0.0), std=None))]
    fn new(pose: PoseArgument, std: Option<(f64, f64, f64)>) -> PyResult<Self> {
        let std = std.map_or(Ok(START_STD), |(x, y, heading)| {
            let part = |name: &str, value: f64| checks::standard_deviation(&format!("std.{name}"), value);
            Ok::<_, PyErr>([part("x", x)?, part("y", y)?, part("heading", heading)?])
        })?;
        Ok(Self { belief: Belief::new(checks::pose("pose", pose)?, std) })
    }

    /// Position [m].
    #[getter]
    fn x(&self) -> f64 {
        self.belief.pose.x
    }

    /// Position [m].
    #[getter]
    fn y(&self) -> f64 {
        self.belief.pose.y
    }

    /// Heading [rad], in (−π, π].
    #[getter]
    fn heading(&self) -> f64 {
        self.belief.pose.heading.radians()
    }

    /// (x, y, heading).
    #[getter]
    fn pose(&self) -> PoseArgument {
        tuple(self.belief.pose)
    }

    /// Covariance of (x, y, heading), shape (3, 3).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> = (0..3)
            .map(|row| (0..3).map(|column| self.belief.covariance.entry(row, column)).collect())
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Standard deviations of x [m], y [m] and heading [rad].
    #[getter]
    fn std(&self) -> (f64, f64, f64) {
        let std = |index| self.belief.covariance.std(index);
        (std(0), std(1), std(2))
    }

    /// Normalized estimation error squared for the true pose (x, y, heading); 3 in the mean for a consistent estimate.
    fn nees(&self, truth: PoseArgument) -> PyResult<f64> {
        Ok(self.belief.nees(checks::pose("truth", truth)?))
    }

    fn __repr__(&self) -> String {
        let ((x, y, heading), (sx, sy, sh)) = (self.pose(), self.std());
        format!("Belief(pose=({x:.4}, {y:.4}, {heading:.4}), std=({sx:.2e}, {sy:.2e}, {sh:.2e}))")
    }
}

/// A pose as (x, y, heading).
pub(crate) fn tuple<To, From>(pose: Pose<To, From, f64>) -> PoseArgument {
    (pose.x, pose.y, pose.heading.radians())
}
