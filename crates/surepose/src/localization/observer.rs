//! Observers of a step: recorders, judges, pictures. They see everything and change nothing.

use crate::estimation::{Measurement, MeasurementOutcome, OdometryOutcome, WheelOdometry};
use crate::lidar::ScanEvent;
use crate::time::{Stamp, Stamped};

/// Receives every input of a step and its outcome. Each method does nothing unless it is implemented.
pub trait LoopObserver<S> {
    /// Receives the odometry in use up to `stamp` and the outcome of the reported one. Where that was rejected or missing,
    /// `odometry` is what the wheels were commanded.
    fn on_odometry(&mut self, stamp: Stamp, odometry: &WheelOdometry<S>, outcome: OdometryOutcome) {
        let _ = (stamp, odometry, outcome);
    }

    /// Receives a measurement, of a sensor or of a wall in a scan, and its outcome.
    fn on_measurement(&mut self, measurement: &Stamped<Measurement<S>>, outcome: MeasurementOutcome) {
        let _ = (measurement, outcome);
    }

    /// Receives a scan after it corrected the estimate.
    fn on_scan(&mut self, event: &ScanEvent<'_, S>) {
        let _ = event;
    }
}

impl<S> LoopObserver<S> for () {}
