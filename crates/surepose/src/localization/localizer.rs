//! Estimation half of a step: sensor input to a supervised belief.

use crate::estimation::{
    Belief, DelayedEkf, DisagreeingSensor, GyroscopeTurn, Measurement, MeasurementOutcome, MeasurementStats,
    OdometryOutcome, RejectReason, WheelOdometry,
};
use crate::lidar::{Deskewer, Scan, ScanEvent, ScanProcessor};
use crate::map::MapView;
use crate::safety::{FaultReason, Health, SafetyAction};
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

use super::input::{Odometry, SensorInput, SensorReading};
use super::monitor::{LocalizationMonitor, MonitorConfig};
use super::observer::LoopObserver;

/// No robot turns as fast as this \[rad/s].
const MAX_YAW_RATE: f64 = 100.0;
/// Longest interval over which the mean of the readings is the mean yaw rate \[s].
const MAX_TURN_INTERVAL: f64 = 0.5;

/// Filter with history, scan processor and localization monitor.
///
/// | capacity | meaning |
/// |---|---|
/// | `HISTORY` | events that the filter can rewind over |
/// | `BEAMS` | beams of a scan; 0 for a robot without a laser, whose processor is [disabled](ScanProcessor::disabled) |
/// | `HYPOTHESES`, `KEYFRAMES` | poses and scans that the global search keeps |
#[derive(Clone, Debug)]
///
/// ```
/// # use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate};
/// # use surepose::geometry::{Angle, Pose};
/// # use surepose::kinematics::{DiffDrive, Integration};
/// # use surepose::time::Stamp;
/// # let ekf = Ekf { drive: DiffDrive::new(0.05, 0.4), delta: 0.0025, integration: Integration::Arc };
/// # let belief = Belief::new(Pose::new(1.0, 1.0, Angle::zero()), [0.05, 0.05, 0.02]);
/// # let filter = DelayedEkf::<f64, 64>::new(ekf, Gate::new(0.999), 1.0, Stamp::from_seconds(0.0), belief);
/// use surepose::estimation::WheelOdometry;
/// use surepose::kinematics::WheelPair;
/// use surepose::lidar::ScanProcessor;
/// use surepose::localization::{Localizer, MonitorConfig, Odometry, SensorInput};
/// use surepose::map::MapView;
/// use surepose::safety::Health;
///
/// let mut localizer = Localizer::<f64, 64, 0>::new(filter, ScanProcessor::disabled(), MonitorConfig::default());
/// let travel = WheelPair::new(0.02, 0.02);
/// let stamp = Stamp::from_seconds(0.1);
/// let input = SensorInput { stamp, odometry: Odometry::WheelTravel(travel), readings: &[] };
/// let belief = localizer.update(&input, WheelOdometry::from_command(travel), &MapView::empty(), &mut ());
/// assert!((belief.pose.x - 1.02).abs() < 1e-9);
/// localizer.mark_lost();
/// assert_eq!(localizer.health(), Health::Lost);
/// ```
pub struct Localizer<
    S,
    const HISTORY: usize,
    const BEAMS: usize,
    const HYPOTHESES: usize = 24,
    const KEYFRAMES: usize = 24,
> {
    estimator: DelayedEkf<S, HISTORY>,
    scan_processor: ScanProcessor<S, BEAMS>,
    deskewer: Deskewer<S, BEAMS>,
    /// Whether scans are rejected unread, because the laser is faulty.
    ignores_scans: bool,
    /// `None` disables supervision and relocalization.
    monitor: Option<LocalizationMonitor<S, HYPOTHESES, KEYFRAMES>>,
}

impl<S: Float, const HISTORY: usize, const BEAMS: usize, const HYPOTHESES: usize, const KEYFRAMES: usize>
    Localizer<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES>
{
    /// Localizer with supervision and relocalization.
    pub fn new(
        estimator: DelayedEkf<S, HISTORY>,
        scan_processor: ScanProcessor<S, BEAMS>,
        monitor: MonitorConfig<S>,
    ) -> Self {
        let monitor = LocalizationMonitor::new(monitor, *estimator.ekf(), estimator.stamp());
        Self { monitor: Some(monitor), ..Self::unsupervised(estimator, scan_processor) }
    }

    /// Localizer without supervision, for recordings that are evaluated against a reference.
    pub fn unsupervised(estimator: DelayedEkf<S, HISTORY>, scan_processor: ScanProcessor<S, BEAMS>) -> Self {
        let deskewer = Deskewer::default();
        Self { estimator, scan_processor, deskewer, ignores_scans: false, monitor: None }
    }

    /// The filter.
    pub fn estimator(&self) -> &DelayedEkf<S, HISTORY> {
        &self.estimator
    }

    /// The scan processor.
    pub fn scan_processor(&self) -> &ScanProcessor<S, BEAMS> {
        &self.scan_processor
    }

    /// The scan processor, for a laser whose noise or mounting changes.
    pub fn scan_processor_mut(&mut self) -> &mut ScanProcessor<S, BEAMS> {
        &mut self.scan_processor
    }

    /// Sets whether scans are rejected unread, because the laser is faulty.
    pub fn set_scans_ignored(&mut self, ignored: bool) {
        self.ignores_scans = ignored;
    }

    /// Newest belief; meaningless while [`Localizer::health`] is [`Health::Lost`].
    pub fn belief(&self) -> Belief<S> {
        self.estimator.belief()
    }

    /// Time of the newest belief.
    pub fn stamp(&self) -> Stamp {
        self.estimator.stamp()
    }

    /// Counts of accepted and rejected measurements.
    pub fn measurement_stats(&self) -> &MeasurementStats {
        self.estimator.measurement_stats()
    }

    /// Present quality of the belief.
    pub fn health(&self) -> Health {
        self.judge().0
    }

    /// Present safety action for the wheels.
    pub fn action(&self) -> SafetyAction {
        self.judge().1
    }

    /// Present quality of the belief and safety action for the wheels, from one evaluation.
    pub fn judge(&self) -> (Health, SafetyAction) {
        let Some(monitor) = &self.monitor else { return (Health::Healthy, SafetyAction::Proceed) };
        match monitor.judge(self.stamp(), &self.belief()) {
            stopped @ (_, SafetyAction::Stop(_)) => stopped,
            _ if self.disagreement().is_some() => {
                (Health::Degraded, SafetyAction::Slowdown(FaultReason::Inconsistent))
            }
            judged => judged,
        }
    }

    /// Sensor that disagrees with the others; see [`DelayedEkf::disagreement`].
    pub fn disagreement(&self) -> Option<DisagreeingSensor> {
        self.estimator.disagreement()
    }

    /// Monitor; `None` for an unsupervised localizer.
    pub fn monitor(&self) -> Option<&LocalizationMonitor<S, HYPOTHESES, KEYFRAMES>> {
        self.monitor.as_ref()
    }

    /// Restarts at `stamp` with a trusted belief.
    pub fn reset(&mut self, stamp: Stamp, belief: Belief<S>) {
        self.estimator.reset(stamp, belief);
        if let Some(monitor) = &mut self.monitor {
            monitor.reset(stamp);
        }
    }

    /// Restarts from a trusted belief of an earlier time and replays the odometry since then. A stamp outside the
    /// history counts as the present time.
    pub fn reset_at(&mut self, stamp: Stamp, belief: Belief<S>) {
        self.estimator.reset_at(stamp, belief);
        let now = self.stamp();
        if let Some(monitor) = &mut self.monitor {
            monitor.reset(now);
        }
    }

    /// Declares the pose unknown and starts the global search.
    pub fn mark_lost(&mut self) {
        let now = self.stamp();
        if let Some(monitor) = &mut self.monitor {
            monitor.mark_lost(now);
        }
    }

    /// Advances the belief to `input.stamp`: odometry predicts; each measurement and each scan, gated, corrects.
    ///
    /// `commanded` replaces missing or rejected odometry; [`WheelOdometry::from_command`] computes it from a command.
    ///
    /// The work is bounded. It is one filter step for odometry, and at most `HISTORY` + 2 for each measurement and each
    /// wall in a scan. Each scan adds one extraction, one association and one comparison with the map.
    pub fn update(
        &mut self,
        input: &SensorInput<'_, S>,
        commanded: WheelOdometry<S>,
        map: &MapView<'_, S>,
        observer: &mut impl LoopObserver<S>,
    ) -> Belief<S> {
        let turn = self.measured_turn(input);
        self.predict(input, commanded, turn, observer);
        for reading in input.readings {
            self.process(reading, map, observer);
        }
        self.belief()
    }

    /// Corrects the belief by one reading.
    pub fn process(
        &mut self,
        reading: &Stamped<SensorReading<'_, S>>,
        map: &MapView<'_, S>,
        observer: &mut impl LoopObserver<S>,
    ) {
        match &reading.value {
            SensorReading::Measurement(measurement) => {
                let measurement = Stamped::new(reading.stamp, *measurement);
                let outcome = self.estimator.update(measurement);
                self.note_measurement(&measurement, outcome, observer);
            }
            SensorReading::Scan(scan) => self.process_scan(reading.stamp, scan, map, observer),
            // Part of the prediction.
            SensorReading::YawRate(_) => {}
        }
    }

    /// The turn since the previous step by the mean of the gyroscope's readings; `None` without a reading or gyroscope.
    fn measured_turn(&mut self, input: &SensorInput<'_, S>) -> Option<GyroscopeTurn<S>> {
        let gyroscope = *self.estimator.gyroscope()?;
        let elapsed = input.stamp.since(self.stamp());
        let (mut count, mut sum) = (0.0, S::from_f64(0.0));
        for reading in input.readings {
            let SensorReading::YawRate(rate) = reading.value else { continue };
            let is_plausible = rate.abs() < S::from_f64(MAX_YAW_RATE);
            if !is_plausible {
                self.estimator.reject(RejectReason::NotFinite);
            } else if reading.stamp > input.stamp {
                self.estimator.reject(RejectReason::Future);
            } else if input.stamp.since(reading.stamp) < elapsed {
                count += 1.0;
                sum = sum + rate;
            }
        }
        let is_measured = count > 0.0 && elapsed <= MAX_TURN_INTERVAL;
        is_measured.then(|| {
            let (count, duration) = (S::from_f64(count), S::from_f64(elapsed));
            let std = gyroscope.std * duration;
            GyroscopeTurn { turn: sum / count * duration, variance: std.squared() / count, duration }
        })
    }

    /// Predicts by odometry, or by the command where odometry is missing or rejected.
    fn predict(
        &mut self,
        input: &SensorInput<'_, S>,
        commanded: WheelOdometry<S>,
        turn: Option<GyroscopeTurn<S>>,
        observer: &mut impl LoopObserver<S>,
    ) {
        let SensorInput { stamp, odometry, .. } = *input;
        let elapsed = stamp.since(self.stamp());
        let reported = match odometry {
            Odometry::WheelTravel(travel) => Some(self.estimator.wheel_odometry(stamp, travel)),
            Odometry::WithVariance(odometry) => Some(odometry),
            Odometry::Missing => None,
        };
        let slip = self.monitor.as_ref().map_or(S::from_f64(0.0), |monitor| monitor.slip_std(stamp));
        let reported = reported.map(|odometry| odometry.with_slip(slip));
        let outcome = match reported.map(|odometry| self.estimator.predict_interval(stamp, odometry, turn)) {
            Some(Ok(())) => OdometryOutcome::Used,
            Some(Err(reason)) => OdometryOutcome::Rejected(reason),
            None => OdometryOutcome::Missing,
        };
        let reported = reported.filter(|_| outcome == OdometryOutcome::Used);
        if reported.is_none() {
            // A rejection is counted.
            let _counted = self.estimator.predict_interval(stamp, commanded, turn);
        }
        let used = reported.unwrap_or(commanded);
        if let Some(monitor) = &mut self.monitor {
            monitor.on_odometry(stamp, elapsed, commanded.travel, used, outcome);
        }
        observer.on_odometry(stamp, &used, outcome);
    }

    /// Associates a scan with the map from the belief at its time, and corrects the belief by the walls.
    fn process_scan(
        &mut self,
        stamp: Stamp,
        scan: &Scan<'_, S>,
        map: &MapView<'_, S>,
        observer: &mut impl LoopObserver<S>,
    ) {
        let Self { estimator, scan_processor, deskewer, monitor, ignores_scans } = self;
        if *ignores_scans {
            return estimator.reject(RejectReason::UnreadableScan);
        }
        let laser = scan_processor.laser_of(scan);
        // A scan older than the history cannot be used. Such a scan is counted, as is an invalid one.
        let (stamp, scan) = if scan.sweep_duration() > 0.0 {
            let motion = match estimator.motion_during(stamp, scan.sweep_duration()) {
                Ok(motion) => motion,
                Err(reason) => return estimator.reject(reason),
            };
            match deskewer.deskew(&laser, scan, &motion) {
                Ok(scan) => (motion.reference, scan),
                Err(_) => return estimator.reject(RejectReason::UnreadableScan),
            }
        } else {
            (stamp, *scan)
        };
        let scan = &scan;
        let Ok(belief) = estimator.belief_at_or_reject(stamp) else { return };
        let Ok(observation) = scan_processor.process(estimator.ekf(), &belief, scan, map.walls) else {
            return estimator.reject(RejectReason::UnreadableScan);
        };
        for measurement in observation.measurements() {
            let measurement = Stamped::new(stamp, measurement);
            let outcome = estimator.update(measurement);
            if let Some(monitor) = monitor.as_mut() {
                monitor.on_measurement(&measurement, outcome);
            }
            observer.on_measurement(&measurement, outcome);
        }
        let Some(belief) = estimator.belief_at(stamp) else { return };
        let event = ScanEvent { stamp, laser: &laser, scan, observation: &observation, belief, map };
        if let Some(monitor) = monitor.as_mut() {
            monitor.on_scan(estimator, &event);
        }
        // A relocalization changes the belief at the time of the scan.
        let belief = estimator.belief_at(stamp).unwrap_or(belief);
        observer.on_scan(&ScanEvent { belief, ..event });
    }

    fn note_measurement(
        &mut self,
        measurement: &Stamped<Measurement<S>>,
        outcome: MeasurementOutcome,
        observer: &mut impl LoopObserver<S>,
    ) {
        if let Some(monitor) = &mut self.monitor {
            monitor.on_measurement(measurement, outcome);
        }
        observer.on_measurement(measurement, outcome);
    }
}
