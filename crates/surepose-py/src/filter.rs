//! The extended Kalman filter alone.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use surepose::estimation::{Belief, DelayedEkf, MeasurementOutcome};
use surepose::geometry::Pose;
use surepose::kinematics::WheelPair;
use surepose::time::{Stamp, Stamped};
use surepose_config::HISTORY;

use crate::belief::PyBelief;
use crate::checks;
use crate::readings::PyMeasurement;
use crate::settings::{PyConfig, config_of};

/// Extended Kalman filter over odometry and measurements, with late measurements and gates.
///
/// `belief` is the start at time 0; `None` is the origin.
#[pyclass(name = "Ekf", module = "surepose")]
pub(crate) struct PyEkf {
    filter: Box<DelayedEkf<f64, HISTORY>>,
}

#[pymethods]
impl PyEkf {
    #[new]
    #[pyo3(signature = (config=None, belief=None, *, stamp=None))]
    fn new(
        config: Option<PyRef<'_, PyConfig>>,
        belief: Option<PyRef<'_, PyBelief>>,
        stamp: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let stamp = stamp.map_or(Ok(Stamp::default()), |stamp| checks::stamp("stamp", stamp))?;
        let origin = Belief::new(Pose::identity(), [1e-3; 3]);
        let belief = belief.map_or(origin, |belief| belief.belief);
        Ok(Self { filter: Box::new(config_of(config.as_deref()).estimator(stamp, belief)) })
    }

    /// Predicts by the travel of the right and the left wheel [m] since the last call, up to `stamp`: [Tran2012] Eq. (11), (12).
    fn predict(&mut self, stamp: &Bound<'_, PyAny>, right: f64, left: f64) -> PyResult<()> {
        let predicted = self.filter.predict(checks::stamp("stamp", stamp)?, WheelPair::new(right, left));
        predicted.map_err(|reason| {
            PyValueError::new_err(format!("right, left: rejected as {} (got {right}, {left})", reason.name()))
        })
    }

    /// Corrects the belief by a measurement at its time: [Tran2012] Eq. (16)–(18).
    ///
    /// Returns the normalized innovation squared of an accepted measurement, or the name of the reason for a rejection.
    fn update(&mut self, py: Python<'_>, measurement: PyRef<'_, PyMeasurement>) -> PyResult<Py<PyAny>> {
        let stamp = measurement.stamp.unwrap_or(self.filter.stamp());
        Ok(match self.filter.update(Stamped::new(stamp, measurement.measurement)) {
            MeasurementOutcome::Accepted { nis } => nis.into_pyobject(py)?.into_any().unbind(),
            MeasurementOutcome::Rejected(reason) => reason.name().into_pyobject(py)?.into_any().unbind(),
        })
    }

    /// Newest belief.
    #[getter]
    fn belief(&self) -> PyBelief {
        PyBelief { belief: self.filter.belief() }
    }

    /// Time of the newest belief [s].
    #[getter]
    fn stamp(&self) -> f64 {
        self.filter.stamp().seconds()
    }

    /// Belief at an earlier time; `None` outside the history.
    fn belief_at(&self, stamp: &Bound<'_, PyAny>) -> PyResult<Option<PyBelief>> {
        let belief = self.filter.belief_at(checks::stamp("stamp", stamp)?);
        Ok(belief.map(|belief| PyBelief { belief }))
    }
}
