//! Kalman filter with history: checks and gates measurements, rewinds for late ones, and counts rejections.

mod considered_errors;
mod gated_update;
mod odometry_noise;
mod sweep_motion;

use crate::kinematics::WheelPair;
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

use super::considered::{Considered, InnovationSums, Sensitivity, Variances};
use super::ekf::{Belief, Ekf, WheelOdometry};
use super::gate::Gate;
use super::gyroscope::{FilterState, Gyroscope, GyroscopeBias, GyroscopeTurn};
use super::history::{Entry, Event, History, OdometryInterval};
use super::measurement::{Measurement, finite};
use super::outcome::{MeasurementOutcome, MeasurementStats, RejectReason};

use gated_update::correct;

pub use sweep_motion::{SWEEP_KNOTS, SweepMotion};

/// Belief that odometry predicts and measurements correct, including late measurements.
///
/// The history of `N` entries bounds memory and work: one call costs at most `N` + 2 filter steps. A late measurement
/// is inserted at its time, and all later entries are replayed. A measurement older than the history is rejected as
/// [`RejectReason::Stale`].
#[derive(Clone, Copy, Debug)]
///
/// ```
/// use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate, HeadingMeasurement, Measurement, MeasurementOutcome};
/// use surepose::geometry::{Angle, Pose};
/// use surepose::kinematics::{DiffDrive, Integration, WheelPair};
/// use surepose::time::{Stamp, Stamped};
///
/// let ekf = Ekf { drive: DiffDrive::new(0.05, 0.4), delta: 0.0025, integration: Integration::Arc };
/// let belief = Belief::new(Pose::identity(), [0.1, 0.1, 0.1]);
/// let at = Stamp::from_seconds;
/// let mut filter = DelayedEkf::<f64, 64>::new(ekf, Gate::new(0.999), 1.0, at(0.0), belief);
/// for stamp in [at(0.1), at(0.2)] {
///     assert!(filter.predict(stamp, WheelPair::new(0.02, 0.02)).is_ok());
/// }
/// // A heading that was measured before the last odometry arrives late.
/// let heading = HeadingMeasurement { heading: Angle::from_radians(0.05), std: 0.01 };
/// let outcome = filter.update(Stamped::new(at(0.15), Measurement::Heading(heading)));
/// assert!(matches!(outcome, MeasurementOutcome::Accepted { .. }));
/// assert!(filter.belief().covariance.std(2) < 0.011);
/// ```
pub struct DelayedEkf<S, const N: usize = 64> {
    ekf: Ekf<S>,
    gate: Gate<S>,
    gyroscope: Option<Gyroscope<S>>,
    /// Variances of the considered parameters; `None` without any. A measurement of an uncertain wall makes walls considered.
    considered: Option<Variances<S>>,
    /// Innovations of the last seconds; `None` where no parameters were configured.
    sums: Option<InnovationSums<S>>,
    /// Maximum age of an entry of the history \[s].
    history_length: f64,
    history: History<S, N>,
    stats: MeasurementStats,
}

impl<S: Float, const N: usize> DelayedEkf<S, N> {
    /// Starts at `stamp` with `belief`. The history holds at most `history_length` seconds and `N` events, at least
    /// one.
    ///
    /// A belief that is not finite remains so. It rejects every measurement, and the
    /// [supervisor](crate::safety::Supervisor) stops the robot.
    pub fn new(ekf: Ekf<S>, gate: Gate<S>, history_length: f64, stamp: Stamp, belief: Belief<S>) -> Self {
        const { assert!(N > 0, "`N`: history capacity is 0, expected at least 1") };
        Self {
            ekf,
            gate,
            gyroscope: None,
            considered: None,
            sums: None,
            history_length,
            history: History::new(stamp, FilterState::from_belief(belief)),
            stats: MeasurementStats::default(),
        }
    }

    /// The filter with a gyroscope of this noise, which takes effect with its first reading.
    #[must_use]
    pub fn with_gyroscope(self, gyroscope: Gyroscope<S>) -> Self {
        Self { gyroscope: Some(gyroscope), ..self }
    }

    /// Newest belief.
    pub fn belief(&self) -> Belief<S> {
        let count = self.history.len();
        self.state().marginal(self.considered_after(count))
    }

    /// Noise of the gyroscope; `None` without one.
    pub fn gyroscope(&self) -> Option<&Gyroscope<S>> {
        self.gyroscope.as_ref()
    }

    /// Newest bias of the gyroscope; `None` before its first reading.
    pub fn gyroscope_bias(&self) -> Option<GyroscopeBias<S>> {
        self.state().bias
    }

    /// Time of the newest belief.
    pub fn stamp(&self) -> Stamp {
        self.history.after(self.history.len()).0
    }

    /// Counts of accepted and rejected measurements.
    pub fn measurement_stats(&self) -> &MeasurementStats {
        &self.stats
    }

    /// Constants of the filter.
    pub fn ekf(&self) -> &Ekf<S> {
        &self.ekf
    }

    /// Belief at `stamp` with the measurements so far; `None` outside the history.
    pub fn belief_at(&self, stamp: Stamp) -> Option<Belief<S>> {
        if stamp > self.stamp() {
            return None;
        }
        let count = self.history.count_until(stamp);
        let (start, state) = self.history.after(count);
        if stamp < start {
            return None;
        }
        match self.history.get(count) {
            Some(&Entry { stamp: end, event: Event::Odometry(odometry), .. }) if stamp > start => {
                let (mut state, mut sensitivity) = (*state, self.sensitivity_after(count));
                let part = odometry.fraction(fraction(start, stamp, end));
                self.advance(&mut state, sensitivity.as_mut(), part, [start, stamp]);
                Some(state.marginal(sensitivity.as_ref().zip(self.considered.as_ref())))
            }
            _ => Some(state.marginal(self.considered_after(count))),
        }
    }

    /// As [`DelayedEkf::belief_at`], for a measurement of that time; counts a rejection.
    ///
    /// # Errors
    /// [`RejectReason::Stale`] or [`RejectReason::Future`].
    pub(crate) fn belief_at_or_reject(&mut self, stamp: Stamp) -> Result<Belief<S>, RejectReason> {
        self.belief_at(stamp).ok_or_else(|| {
            let reason = if stamp > self.stamp() { RejectReason::Future } else { RejectReason::Stale };
            self.reject(reason);
            reason
        })
    }

    /// Clears the history and restarts from a trusted belief. The statistics and the bias of the gyroscope are kept.
    pub fn reset(&mut self, stamp: Stamp, belief: Belief<S>) {
        self.sums = self.sums.map(|_| InnovationSums::new());
        let considered = self.considered_after(self.history.len());
        self.history = History::new(stamp, self.state().with_new_belief(belief, considered));
    }

    /// Restarts from a trusted `belief` at the earlier time `stamp`, and replays the odometry since then.
    ///
    /// All earlier entries are deleted. All measurements since `stamp` are deleted too, because their walls and
    /// landmarks were associated at the discarded belief. Where the history does not contain `stamp`, `belief` holds
    /// for the present time.
    pub fn reset_at(&mut self, stamp: Stamp, belief: Belief<S>) {
        let past = self.history;
        let (oldest, newest) = (past.after(0).0, past.after(past.len()).0);
        if stamp < oldest || stamp > newest {
            return self.reset(newest, belief);
        }
        self.reset(stamp, belief);
        for index in past.count_until(stamp)..past.len() {
            if let Some(&Entry { stamp: end, event: Event::Odometry(odometry), .. }) = past.get(index) {
                // Only the part after `stamp` of the interval that contains it.
                let before = fraction(past.after(index).0.min(stamp), stamp, end);
                let rest = odometry.fraction(S::from_f64(1.0) - before);
                let _checked = self.predict_interval(end, rest.wheels, rest.turn);
            }
        }
    }

    /// Predicts by the wheel travel `travel` \[m] since the last call, up to the time `stamp`.
    ///
    /// A `stamp` before the newest belief means that the clock was set back; the travel is used nevertheless. The
    /// filter then restarts at `stamp` without history and counts a clock reset. Measurements with stamps of the old
    /// clock are rejected.
    ///
    /// # Errors
    /// [`RejectReason::NotFinite`] for an invalid travel; the belief is then unchanged.
    pub fn predict(&mut self, stamp: Stamp, travel: WheelPair<S>) -> Result<(), RejectReason> {
        self.predict_with(stamp, self.wheel_odometry(stamp, travel))
    }

    /// As [`DelayedEkf::predict`], with a variance that replaces the model of δ.
    ///
    /// # Errors
    /// As [`DelayedEkf::predict`], and [`RejectReason::BadVariance`] for a negative variance.
    pub fn predict_with(&mut self, stamp: Stamp, odometry: WheelOdometry<S>) -> Result<(), RejectReason> {
        self.predict_interval(stamp, odometry, None)
    }

    /// As [`DelayedEkf::predict_with`], with the turn that a gyroscope measured since the last call.
    ///
    /// # Errors
    /// As [`DelayedEkf::predict_with`].
    pub fn predict_interval(
        &mut self,
        stamp: Stamp,
        odometry: WheelOdometry<S>,
        turn: Option<GyroscopeTurn<S>>,
    ) -> Result<(), RejectReason> {
        if let Err(reason) = check_odometry(&odometry) {
            self.reject(reason);
            return Err(reason);
        }
        if stamp < self.stamp() {
            self.stats.clock_resets = self.stats.clock_resets.saturating_add(1);
            self.reset(stamp, self.belief());
        }
        let interval = OdometryInterval { wheels: odometry, turn };
        let count = self.history.len();
        let (mut after, mut sensitivity) = (*self.state(), self.sensitivity_after(count));
        self.advance(&mut after, sensitivity.as_mut(), interval, [self.stamp(), stamp]);
        let entry = Entry { stamp, event: Event::Odometry(interval), after };
        self.history.insert(count, entry, sensitivity.as_ref());
        self.history.drop_before(stamp.after(-self.history_length));
        Ok(())
    }

    /// Corrects the belief by a measurement, at the time of the measurement.
    ///
    /// Later measurements are gated again. Of two contradictory measurements the earlier stamp wins, whichever arrived
    /// first; an accepted measurement may thus be excluded afterwards.
    pub fn update(&mut self, measured: Stamped<Measurement<S>>) -> MeasurementOutcome {
        let outcome = match self.check_measurement(&measured) {
            Err(reason) => MeasurementOutcome::Rejected(reason),
            Ok(()) => self.apply(measured),
        };
        self.stats.count(outcome);
        outcome
    }

    fn state(&self) -> &FilterState<S> {
        self.history.after(self.history.len()).1
    }

    /// Advances the state by an interval between two stamps.
    fn advance(
        &self,
        state: &mut FilterState<S>,
        sensitivity: Option<&mut Sensitivity<S>>,
        interval: OdometryInterval<S>,
        [from, to]: [Stamp; 2],
    ) {
        let OdometryInterval { wheels, turn } = interval;
        let duration = S::from_f64(to.since(from).max(0.0));
        let considered = Considered::join(sensitivity, self.considered.as_ref());
        match &self.gyroscope {
            None => self.ekf.predict_considered(state, wheels, duration, considered),
            Some(gyroscope) => {
                self.ekf.predict_with_gyroscope(gyroscope, state, wheels, turn, duration, considered);
            }
        }
    }

    /// Counts a rejected measurement or scan.
    pub(crate) fn reject(&mut self, reason: RejectReason) {
        self.stats.count(MeasurementOutcome::Rejected(reason));
    }

    fn check_measurement(&self, measured: &Stamped<Measurement<S>>) -> Result<(), RejectReason> {
        measured.value.check()?;
        if measured.stamp > self.stamp() {
            Err(RejectReason::Future)
        } else if measured.stamp < self.history.after(0).0 || self.history.is_full_before(measured.stamp) {
            Err(RejectReason::Stale)
        } else {
            Ok(())
        }
    }

    /// Rewinds to the time of the measurement, applies it, and replays the later entries.
    fn apply(&mut self, measured: Stamped<Measurement<S>>) -> MeasurementOutcome {
        let Stamped { stamp, value: measurement } = measured;
        if self.considered.is_none() && measurement.wall_variance() > S::from_f64(0.0) {
            self.considered = Some(Variances::walls_only());
        }
        let count = self.history.count_until(stamp);
        let (start, state) = self.history.after(count);
        let (mut after, mut sensitivity) = (*state, self.sensitivity_after(count));
        // A measurement inside an odometry interval splits the interval.
        let split = match self.history.get(count) {
            Some(&Entry { stamp: end, event: Event::Odometry(odometry), after: later }) if stamp > start => {
                let part = fraction(start, stamp, end);
                let (first, rest) = (odometry.fraction(part), odometry.fraction(S::from_f64(1.0) - part));
                self.advance(&mut after, sensitivity.as_mut(), first, [start, stamp]);
                let rest = Entry { stamp: end, event: Event::Odometry(rest), after: later };
                Some((Entry { stamp, event: Event::Odometry(first), after }, rest, sensitivity))
            }
            _ => None,
        };
        let Self { ekf, gate, sums, .. } = self;
        let considered = Considered::join(sensitivity.as_mut(), self.considered.as_ref());
        let sums = sums.as_mut().map(|sums| (stamp, sums));
        let (nis, accepted) = correct((ekf, gate), &mut after, considered, &measurement, sums);
        if !accepted {
            return MeasurementOutcome::Rejected(RejectReason::Outlier);
        }
        let mut index = Some(count);
        if let Some((first, rest, sensitivity)) = split {
            self.history.set(count, rest, None);
            index = self.history.insert(count, first, sensitivity.as_ref()).map(|index| index + 1);
        }
        let entry = Entry { stamp, event: Event::Measurement(measurement), after };
        let index = self.history.insert(index.unwrap_or(0), entry, sensitivity.as_ref());
        let next = index.map_or(0, |index| index + 1);
        if next < self.history.len() {
            self.replay(next, after, sensitivity);
        }
        MeasurementOutcome::Accepted { nis: nis.to_f64() }
    }

    /// Applies the entries from `index` on to a state and its sensitivity.
    fn replay(&mut self, index: usize, mut state: FilterState<S>, mut sensitivity: Option<Sensitivity<S>>) {
        for i in index..self.history.len() {
            if let Some(mut entry) = self.history.get(i).copied() {
                match &entry.event {
                    Event::Odometry(odometry) => {
                        let stamps = [self.history.after(i).0, entry.stamp];
                        self.advance(&mut state, sensitivity.as_mut(), *odometry, stamps);
                    }
                    Event::Measurement(measurement) => {
                        let considered = Considered::join(sensitivity.as_mut(), self.considered.as_ref());
                        let constants = (&self.ekf, &self.gate);
                        let _gated_again = correct(constants, &mut state, considered, measurement, None);
                    }
                }
                entry.after = state;
                self.history.set(i, entry, sensitivity.as_ref());
            }
        }
    }
}

/// Checks travel and variance of odometry for plausibility.
fn check_odometry<S: Float>(odometry: &WheelOdometry<S>) -> Result<(), RejectReason> {
    finite(&[odometry.travel.right, odometry.travel.left])?;
    let variances = [odometry.variance.right, odometry.variance.left];
    finite(&variances).map_err(|_| RejectReason::BadVariance)?;
    if variances.iter().all(|variance| *variance >= S::from_f64(0.0)) {
        Ok(())
    } else {
        Err(RejectReason::BadVariance)
    }
}

/// Fraction of the time from `start` to `end` that lies before `at`.
fn fraction<S: Float>(start: Stamp, at: Stamp, end: Stamp) -> S {
    let whole = end.since(start);
    if whole > 0.0 { S::from_f64((at.since(start) / whole).clamp(0.0, 1.0)) } else { S::from_f64(1.0) }
}
