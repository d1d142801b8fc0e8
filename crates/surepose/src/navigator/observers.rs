//! The observers of a step: the obstacle monitor and the caller's.

use crate::estimation::{Measurement, MeasurementOutcome, OdometryOutcome, WheelOdometry};
use crate::lidar::ScanEvent;
use crate::localization::LoopObserver;
use crate::safety::ObstacleMonitor;
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

/// The obstacle monitor beside the caller's observer.
pub(super) struct Observers<'a, S, O, const BEAMS: usize> {
    pub(super) obstacles: &'a mut ObstacleMonitor<S, BEAMS>,
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
