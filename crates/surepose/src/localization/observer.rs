//! Observers of a step, for recorders, evaluations and plots. They receive all data and change nothing.

use crate::estimation::{Measurement, MeasurementOutcome, OdometryOutcome, WheelOdometry};
use crate::lidar::ScanEvent;
use crate::time::{Stamp, Stamped};

/// Receives every input of a step and its outcome. The default methods do nothing.
pub trait LoopObserver<S> {
    /// Receives the odometry in use up to `stamp` and the outcome of the measured odometry. Where that was rejected or
    /// missing, `odometry` is the commanded travel.
    fn on_odometry(&mut self, stamp: Stamp, odometry: &WheelOdometry<S>, outcome: OdometryOutcome) {
        let _ = (stamp, odometry, outcome);
    }

    /// Receives a measurement, from a sensor or from a wall in a scan, and its outcome.
    fn on_measurement(&mut self, measurement: &Stamped<Measurement<S>>, outcome: MeasurementOutcome) {
        let _ = (measurement, outcome);
    }

    /// Receives a scan after it has corrected the estimate.
    fn on_scan(&mut self, event: &ScanEvent<'_, S>) {
        let _ = event;
    }
}

impl<S> LoopObserver<S> for () {}
