//! Adapter that forwards localizer events to the obstacle monitor and the observer of the caller.

use crate::estimation::{Measurement, MeasurementOutcome, OdometryOutcome, WheelOdometry};
use crate::lidar::ScanEvent;
use crate::localization::LoopObserver;
use crate::safety::ObstacleMonitor;
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

/// Obstacle monitor combined with the observer of the caller.
pub(super) struct Observers<'a, S, O, const BEAMS: usize> {
    /// Monitor that receives each scan.
    pub(super) obstacles: &'a mut ObstacleMonitor<S, BEAMS>,
    /// Observer that receives each event.
    pub(super) observer: &'a mut O,
}

impl<S: Float, O: LoopObserver<S>, const BEAMS: usize> LoopObserver<S> for Observers<'_, S, O, BEAMS> {
    fn on_odometry(&mut self, stamp: Stamp, odometry: &WheelOdometry<S>, outcome: OdometryOutcome) {
        self.observer.on_odometry(stamp, odometry, outcome);
    }

    fn on_measurement(&mut self, measurement: &Stamped<Measurement<S>>, outcome: MeasurementOutcome) {
        self.observer.on_measurement(measurement, outcome);
    }

    fn on_scan(&mut self, event: &ScanEvent<'_, S>) {
        self.obstacles.on_scan(event);
        self.observer.on_scan(event);
    }
}
