//! The filter with its memory: checks, gates, rewinds what comes late, counts what it rejects.

use crate::kinematics::WheelPair;
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};

use super::ekf::{Belief, Ekf, WheelOdometry};
use super::gate::Gate;
use super::history::{Entry, Event, History};
use super::measurement::{Measurement, finite};
use super::outcome::{MeasurementOutcome, MeasurementStats, RejectReason};

/// A belief that is carried through time by odometry and corrected by measurements, late ones included.
///
/// `N` entries of history bound the memory and the work: one call costs at most `N` + 2 filter steps. A
/// measurement that is late is put where it belongs and everything after it is done again; one older than the
/// history is rejected as [`RejectReason::Stale`].
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
    /// How far back the history may reach \[s].
    history_length: f64,
    history: History<S, N>,
    stats: MeasurementStats,
}

/// The noise of odometry is that of the speeds of so long \[s]: long beside a period, short beside what a robot takes to speed
/// up.
const ODOMETRY_NOISE_WINDOW: f64 = 0.5;

impl<S: Float, const N: usize> DelayedEkf<S, N> {
    /// Starts at `stamp` with `belief`; remembers at most `history_length` seconds and at most `N` events, at least one.
    ///
    /// A belief that is not finite stays so: it rejects every measurement, and the [supervisor](crate::safety::Supervisor) stops the
    /// robot for it.
    pub fn new(ekf: Ekf<S>, gate: Gate<S>, history_length: f64, stamp: Stamp, belief: Belief<S>) -> Self {
        const { assert!(N > 0, "without a history nothing is remembered, not even odometry") };
        Self {
            ekf,
            gate,
            history_length,
            history: History::new(stamp, belief),
            stats: MeasurementStats::default(),
        }
    }

    /// The newest belief.
    pub fn belief(&self) -> Belief<S> {
        self.history.after(self.history.len()).1
    }

    /// When the newest belief holds.
    pub fn stamp(&self) -> Stamp {
        self.history.after(self.history.len()).0
    }

    /// What was accepted and what was rejected so far.
    pub fn measurement_stats(&self) -> &MeasurementStats {
        &self.stats
    }

    /// The filter's constants.
    pub fn ekf(&self) -> &Ekf<S> {
        &self.ekf
    }

    /// The belief at `stamp`, as far as it is known now; `None` where the history does not reach.
    pub fn belief_at(&self, stamp: Stamp) -> Option<Belief<S>> {
        if stamp > self.stamp() {
            return None;
        }
        let count = self.history.count_until(stamp);
        let (start, belief) = self.history.after(count);
        if stamp < start {
            return None;
        }
        match self.history.get(count) {
            Some(Entry { stamp: end, event: Event::Odometry(odometry), .. }) if stamp > start => {
                Some(self.ekf.predict(belief, odometry.fraction(fraction(start, stamp, end))))
            }
            _ => Some(belief),
        }
    }

    /// As [`DelayedEkf::belief_at`], for something measured then: that it comes too late or too early is counted.
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

    /// Forgets everything and starts anew, from a pose that somebody is sure of. The statistics are kept.
    pub fn reset(&mut self, stamp: Stamp, belief: Belief<S>) {
        self.history = History::new(stamp, belief);
    }

    /// The robot was at `belief` at `stamp`, somebody is sure, and has rolled on since: everything before is forgotten, and
    /// so is what was measured since, for walls and landmarks were told apart by where the robot was believed to be.
    ///
    /// Where the history does not reach to `stamp`, `belief` is taken for where the robot is now.
    pub fn reset_at(&mut self, stamp: Stamp, belief: Belief<S>) {
        let past = self.history;
        let (oldest, newest) = (past.after(0).0, past.after(past.len()).0);
        if stamp < oldest || stamp > newest {
            return self.reset(newest, belief);
        }
        self.reset(stamp, belief);
        for index in past.count_until(stamp)..past.len() {
            if let Some(Entry { stamp: end, event: Event::Odometry(odometry), .. }) = past.get(index) {
                // Of the stretch in which `stamp` lies, only what comes after it.
                let before = fraction(past.after(index).0.min(stamp), stamp, end);
                let _checked = self.predict_with(end, odometry.fraction(S::from_f64(1.0) - before));
            }
        }
    }

    /// Predicts with a travel of `travel` \[m] since the last call and it is now `stamp`.
    ///
    /// It rolled, whatever the clock says: a `stamp` before that of the newest belief means that the clock was set back. Time
    /// then starts anew at `stamp`, without a history, which the statistics count; what was measured by the old clock is rejected.
    ///
    /// # Errors
    /// [`RejectReason::NotFinite`] for a broken travel; the belief then stays as it was.
    pub fn predict(&mut self, stamp: Stamp, travel: WheelPair<S>) -> Result<(), RejectReason> {
        self.predict_with(stamp, self.wheel_odometry(stamp, travel))
    }

    /// What it says of the way since the last call that the wheels rolled by `travel` \[m] and it is now `stamp`.
    ///
    /// # Departure
    /// (15) of [Tran2012] takes the variance from the speed that was measured, δω², and so a wheel that was measured too fast
    /// for less certain than one that was measured too slow. A heading that comes with it then moves the robot by the
    /// product of the two, which is not 0 in the mean: with noise of 20 % on the wheels by a thirtieth of the way. Here the
    /// square is the mean one of the last half second, of which this stretch is a small part.
    /// Tested by `odometry::noisy_odometry_with_heading_updates_is_unbiased`.
    pub fn wheel_odometry(&self, stamp: Stamp, travel: WheelPair<S>) -> WheelOdometry<S> {
        let own = stamp.since(self.stamp());
        if own.is_nan() || own <= 0.0 {
            return self.ekf.wheel_odometry(travel);
        }
        let recent = || {
            core::iter::once((own, travel)).chain(self.odometry_since(stamp.after(-ODOMETRY_NOISE_WINDOW)))
        };
        let (count, whole) = recent().fold((0.0, 0.0), |(count, whole), (dt, _)| (count + 1.0, whole + dt));
        // Stamps that jitter make a stretch of no time: nobody rolled so far in that. A measurement that is late splits one, and
        // its parts are as short as they say.
        let time = |dt: f64| S::from_f64(dt.max(0.25 * whole / count));
        let (mut all, mut sum) = (S::from_f64(0.0), WheelPair::zero());
        for (dt, travel) in recent() {
            let (dt, speeds) = (time(dt), travel.scaled(S::from_f64(1.0) / time(dt)));
            all = all + dt;
            sum = WheelPair::new(
                sum.right + speeds.right.squared() * dt,
                sum.left + speeds.left.squared() * dt,
            );
        }
        WheelOdometry { travel, variance: sum.scaled(time(own).squared() / all * self.ekf.delta) }
    }

    /// The stretches that ended after `since`, the newest first: how long each was \[s], and how far the wheels rolled \[m].
    fn odometry_since(&self, since: Stamp) -> impl Iterator<Item = (f64, WheelPair<S>)> + '_ {
        let stamp = |count: usize| self.history.after(count).0;
        let newest_first = (0..self.history.len()).rev().take_while(move |index| stamp(index + 1) > since);
        newest_first.filter_map(move |index| match self.history.get(index)?.event {
            Event::Odometry(odometry) => Some((stamp(index + 1).since(stamp(index)), odometry.travel)),
            Event::Measurement(_) => None,
        })
    }

    /// As [`DelayedEkf::predict`], where the variance of the travel is known better than by δ.
    ///
    /// # Errors
    /// As [`DelayedEkf::predict`], and [`RejectReason::BadVariance`] for a negative variance.
    pub fn predict_with(&mut self, stamp: Stamp, odometry: WheelOdometry<S>) -> Result<(), RejectReason> {
        if let Err(reason) = check_odometry(&odometry) {
            self.reject(reason);
            return Err(reason);
        }
        if stamp < self.stamp() {
            self.stats.clock_resets = self.stats.clock_resets.saturating_add(1);
            self.reset(stamp, self.belief());
        }
        let after = self.ekf.predict(self.belief(), odometry);
        self.history.insert(self.history.len(), Entry { stamp, event: Event::Odometry(odometry), after });
        self.history.drop_before(stamp.after(-self.history_length));
        Ok(())
    }

    /// Corrects the belief by a measurement, at the time when it was taken.
    ///
    /// What was measured later is judged again: of two that contradict each other the earlier counts, whichever came first,
    /// and one that was accepted may be left out for it.
    pub fn update(&mut self, measured: Stamped<Measurement<S>>) -> MeasurementOutcome {
        let outcome = match self.check_measurement(&measured) {
            Err(reason) => MeasurementOutcome::Rejected(reason),
            Ok(()) => self.apply(measured),
        };
        self.stats.count(outcome);
        outcome
    }

    /// Counts something that is not used.
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

    /// Rewinds to the measurement's time, applies it, and does again what came after.
    fn apply(&mut self, measured: Stamped<Measurement<S>>) -> MeasurementOutcome {
        let Stamped { stamp, value: measurement } = measured;
        let count = self.history.count_until(stamp);
        let (start, mut belief) = self.history.after(count);
        // The robot may have been rolling: the measurement then splits a stretch.
        let split = match self.history.get(count) {
            Some(Entry { stamp: end, event: Event::Odometry(odometry), after }) if stamp > start => {
                let part = fraction(start, stamp, end);
                let (first, rest) = (odometry.fraction(part), odometry.fraction(S::from_f64(1.0) - part));
                belief = self.ekf.predict(belief, first);
                let rest = Entry { stamp: end, event: Event::Odometry(rest), after };
                Some((Entry { stamp, event: Event::Odometry(first), after: belief }, rest))
            }
            _ => None,
        };
        let (after, nis, accepted) = self.correct(belief, &measurement);
        if !accepted {
            return MeasurementOutcome::Rejected(RejectReason::Outlier);
        }
        let mut index = Some(count);
        if let Some((first, rest)) = split {
            self.history.set(count, rest);
            index = self.history.insert(count, first).map(|index| index + 1);
        }
        let entry = Entry { stamp, event: Event::Measurement(measurement), after };
        let index = self.history.insert(index.unwrap_or(0), entry);
        self.replay(index.map_or(0, |index| index + 1), after);
        MeasurementOutcome::Accepted { nis: nis.to_f64() }
    }

    /// Applies the entries from `index` on to `belief`.
    fn replay(&mut self, index: usize, mut belief: Belief<S>) {
        for i in index..self.history.len() {
            if let Some(mut entry) = self.history.get(i) {
                belief = match &entry.event {
                    Event::Odometry(odometry) => self.ekf.predict(belief, *odometry),
                    Event::Measurement(measurement) => self.correct(belief, measurement).0,
                };
                entry.after = belief;
                self.history.set(i, entry);
            }
        }
    }

    fn correct(&self, belief: Belief<S>, measurement: &Measurement<S>) -> (Belief<S>, S, bool) {
        let threshold = self.gate.threshold(measurement.dimension());
        let ekf = &self.ekf;
        let correction = match measurement {
            Measurement::Heading(compass) => ekf.correct(belief, &compass.innovation(&belief), threshold),
            Measurement::Line(wall) => ekf.correct(belief, &wall.innovation(&belief), threshold),
            Measurement::RangeBearing(landmark) => {
                ekf.correct(belief, &landmark.innovation(&belief), threshold)
            }
            Measurement::Position(position) => ekf.correct(belief, &position.innovation(&belief), threshold),
            Measurement::Pose(pose) => ekf.correct(belief, &pose.innovation(&belief), threshold),
        };
        (correction.belief, correction.nis, correction.accepted)
    }
}

/// Whether a robot can have rolled so, and somebody know it so well.
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

/// Which part of the time from `start` to `end` lies before `at`.
fn fraction<S: Float>(start: Stamp, at: Stamp, end: Stamp) -> S {
    let whole = end.since(start);
    if whole > 0.0 { S::from_f64((at.since(start) / whole).clamp(0.0, 1.0)) } else { S::from_f64(1.0) }
}
