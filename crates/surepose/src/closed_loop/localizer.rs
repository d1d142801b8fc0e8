//! The first half of a tick: from what is sensed to where the robot is.

use crate::estimate::{Belief, DelayedEkf, RejectReason, Stamp, Stamped, WheelOdometry};
use crate::laser::{Scan, ScanProcessor, Wall};
use crate::scalar::Float;

use super::{LoopObserver, ScanEvent, SensorInput, SensorReading};

/// The filter with its history, and the processor that reads scans for it.
///
/// A robot without a laser has a [disabled](ScanProcessor::disabled) one.
#[derive(Clone, Debug)]
pub struct Localizer<S, const N: usize, const BEAMS: usize> {
    /// The filter.
    pub estimator: DelayedEkf<S, N>,
    /// What reads scans.
    pub scan_processor: ScanProcessor<S, BEAMS>,
}

impl<S: Float, const N: usize, const BEAMS: usize> Localizer<S, N, BEAMS> {
    /// Where am I? Odometry predicts; each measurement and each wall seen, gated, corrects.
    ///
    /// `commanded` is how far the rims were told to roll since the last tick, in case the encoders say nothing usable: a
    /// [guess](WheelOdometry::from_command), unless somebody knows better.
    ///
    /// The work is bounded: one filter step for odometry, and for each measurement and each wall at most `N` + 2; for
    /// each scan, one extraction and one matching.
    pub fn update(
        &mut self,
        input: &SensorInput<'_, S>,
        commanded: WheelOdometry<S>,
        walls: &[Wall<S>],
        observer: &mut impl LoopObserver<S, N>,
    ) -> Belief<S> {
        self.predict(input.stamp, input.travel, commanded, observer);
        for reading in input.readings {
            self.process(reading, walls, observer);
        }
        self.estimator.belief()
    }

    /// Corrects by what a sensor says, where it does not come together with odometry.
    pub fn process(
        &mut self,
        reading: &Stamped<SensorReading<'_, S>>,
        walls: &[Wall<S>],
        observer: &mut impl LoopObserver<S, N>,
    ) {
        match &reading.value {
            SensorReading::Measurement(measurement) => {
                let measurement = Stamped::new(reading.stamp, *measurement);
                observer.on_measurement(&measurement, self.estimator.update(measurement));
            }
            SensorReading::Scan(scan) => self.process_scan(reading.stamp, scan, walls, observer),
        }
    }

    /// Predicts by odometry; where that is refused, by what the wheels were told.
    fn predict(
        &mut self,
        stamp: Stamp,
        travel: WheelOdometry<S>,
        commanded: WheelOdometry<S>,
        observer: &mut impl LoopObserver<S, N>,
    ) {
        let outcome = self.estimator.predict_with(stamp, travel);
        if outcome.is_err() {
            let _counted = self.estimator.predict_with(stamp, commanded);
        }
        let travel = if outcome.is_ok() { travel } else { commanded };
        observer.on_odometry(stamp, commanded.travel, travel, outcome);
    }

    /// Finds the walls of a scan on the map, from where the robot is believed to have been when it was taken, and
    /// corrects by them.
    fn process_scan(
        &mut self,
        stamp: Stamp,
        scan: &Scan<'_, S>,
        walls: &[Wall<S>],
        observer: &mut impl LoopObserver<S, N>,
    ) {
        let Self { estimator, scan_processor } = self;
        // A scan from before the history cannot be matched. That is counted, as is one that cannot be read.
        let Ok(belief) = estimator.belief_at_or_reject(stamp) else { return };
        let laser = scan_processor.laser;
        let Ok(observation) = scan_processor.process(estimator.ekf(), &belief, scan, walls) else {
            return estimator.reject(RejectReason::UnreadableScan);
        };
        for measurement in observation.measurements() {
            let measurement = Stamped::new(stamp, measurement);
            observer.on_measurement(&measurement, estimator.update(measurement));
        }
        observer
            .on_scan(estimator, &ScanEvent { stamp, laser: &laser, scan, observation: &observation, walls });
    }
}
