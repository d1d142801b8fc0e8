//! The filter with its memory: checks, gates, rewinds what comes late, counts what it refuses.

use crate::drive::Wheels;
use crate::scalar::Float;

use super::ekf::{Belief, Ekf, Travel};
use super::gate::Gate;
use super::history::{Entry, Event, History};
use super::measurement::{Measurement, finite};
use super::outcome::{Outcome, Refusal, Tally};
use super::time::{Stamp, Stamped};

/// A belief that is carried through time by odometry and corrected by measurements, late ones included.
///
/// `N` entries of history bound the memory and the work: one call costs at most `N` + 2 filter steps. A
/// measurement that is late is put where it belongs and everything after it is done again; one older than the
/// history is refused as [`Refusal::Stale`].
#[derive(Clone, Copy, Debug)]
pub struct Estimator<S, const N: usize = 64> {
    ekf: Ekf<S>,
    gate: Gate<S>,
    /// How far back the history may reach \[s].
    reach: f64,
    history: History<S, N>,
    tally: Tally,
}

/// The noise of odometry is that of the speeds of so long \[s]: long beside a period, short beside what a robot takes to speed
/// up.
const MEMORY: f64 = 0.5;

impl<S: Float, const N: usize> Estimator<S, N> {
    /// Starts at `stamp` with `belief`; remembers at most `reach` seconds and at most `N` events, at least one.
    ///
    /// A belief that is not finite stays so: it refuses every measurement, and the [supervisor](crate::Supervisor) stops the
    /// robot for it.
    pub fn new(ekf: Ekf<S>, gate: Gate<S>, reach: f64, stamp: Stamp, belief: Belief<S>) -> Self {
        const { assert!(N > 0, "without a history nothing is remembered, not even odometry") };
        Self { ekf, gate, reach, history: History::starting(stamp, belief), tally: Tally::default() }
    }

    /// The newest belief.
    pub fn belief(&self) -> Belief<S> {
        self.history.after(self.history.len()).1
    }

    /// When the newest belief holds.
    pub fn stamp(&self) -> Stamp {
        self.history.after(self.history.len()).0
    }

    /// What was accepted and what was refused so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
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
            Some(Entry { stamp: end, event: Event::Travel(travel), .. }) if stamp > start => {
                Some(self.ekf.predict(belief, travel.part(fraction(start, stamp, end))))
            }
            _ => Some(belief),
        }
    }

    /// As [`Estimator::belief_at`], for something measured then: that it comes too late or too early is counted.
    ///
    /// # Errors
    /// [`Refusal::Stale`] or [`Refusal::Future`].
    pub(crate) fn recall(&mut self, stamp: Stamp) -> Result<Belief<S>, Refusal> {
        self.belief_at(stamp).ok_or_else(|| {
            let reason = if stamp > self.stamp() { Refusal::Future } else { Refusal::Stale };
            self.refuse(reason);
            reason
        })
    }

    /// Forgets everything and starts anew, from a pose that somebody is sure of. The tally is kept.
    pub fn restart(&mut self, stamp: Stamp, belief: Belief<S>) {
        self.history = History::starting(stamp, belief);
    }

    /// The robot was at `belief` at `stamp`, somebody is sure, and has rolled on since: everything before is forgotten, and
    /// so is what was measured since, for walls and landmarks were told apart by where the robot was believed to be.
    ///
    /// Where the history does not reach to `stamp`, `belief` is taken for where the robot is now.
    pub fn resume(&mut self, stamp: Stamp, belief: Belief<S>) {
        let past = self.history;
        let (oldest, newest) = (past.after(0).0, past.after(past.len()).0);
        if stamp < oldest || stamp > newest {
            return self.restart(newest, belief);
        }
        self.restart(stamp, belief);
        for index in past.count_until(stamp)..past.len() {
            if let Some(Entry { stamp: end, event: Event::Travel(travel), .. }) = past.get(index) {
                // Of the stretch in which `stamp` lies, only what comes after it.
                let before = fraction(past.after(index).0.min(stamp), stamp, end);
                let _checked = self.roll_by(end, travel.part(S::of(1.0) - before));
            }
        }
    }

    /// The robot rolled by `rims` \[m] since the last call and it is now `stamp`.
    ///
    /// It rolled, whatever the clock says: a `stamp` before that of the newest belief means that the clock was set back. Time
    /// then starts anew at `stamp`, without a history, which the tally counts; what was measured by the old clock is refused.
    ///
    /// # Errors
    /// [`Refusal::NotFinite`] for a broken travel; the belief then stays as it was.
    pub fn roll(&mut self, stamp: Stamp, rims: Wheels<S>) -> Result<(), Refusal> {
        self.roll_by(stamp, self.travel(stamp, rims))
    }

    /// What it says of the way since the last call that the rims rolled by `rims` \[m] and it is now `stamp`.
    ///
    /// # Departure
    /// (15) of [Tran2012] takes the variance from the speed that was measured, δω², and so a wheel that was measured too fast
    /// for less certain than one that was measured too slow. A heading that comes with it then moves the robot by the
    /// product of the two, which is not 0 in the mean: with noise of 20 % on the wheels by a thirtieth of the way. Here the
    /// square is the mean one of the last half second, of which this stretch is a small part.
    /// Tested by `odometry::noisy_wheels_and_a_heading_leave_no_bias`.
    pub fn travel(&self, stamp: Stamp, rims: Wheels<S>) -> Travel<S> {
        let own = stamp.since(self.stamp());
        if own.is_nan() || own <= 0.0 {
            return self.ekf.travel(rims);
        }
        let recent = || core::iter::once((own, rims)).chain(self.rolled_since(stamp.after(-MEMORY)));
        let (count, whole) = recent().fold((0.0, 0.0), |(count, whole), (dt, _)| (count + 1.0, whole + dt));
        // Stamps that jitter make a stretch of no time: nobody rolled so far in that. A measurement that is late splits one, and
        // its parts are as short as they say.
        let time = |dt: f64| S::of(dt.max(0.25 * whole / count));
        let (mut all, mut sum) = (S::of(0.0), Wheels::rest());
        for (dt, rims) in recent() {
            let (dt, speeds) = (time(dt), rims.scaled(S::of(1.0) / time(dt)));
            all = all + dt;
            sum = Wheels::new(sum.right + speeds.right.squared() * dt, sum.left + speeds.left.squared() * dt);
        }
        Travel { rims, variance: sum.scaled(time(own).squared() / all * self.ekf.delta) }
    }

    /// The stretches that ended after `since`, the newest first: how long each was \[s], and how far the rims rolled \[m].
    fn rolled_since(&self, since: Stamp) -> impl Iterator<Item = (f64, Wheels<S>)> + '_ {
        let stamp = |count: usize| self.history.after(count).0;
        let newest_first = (0..self.history.len()).rev().take_while(move |index| stamp(index + 1) > since);
        newest_first.filter_map(move |index| match self.history.get(index)?.event {
            Event::Travel(travel) => Some((stamp(index + 1).since(stamp(index)), travel.rims)),
            Event::Measurement(_) => None,
        })
    }

    /// As [`Estimator::roll`], where the variance of the travel is known better than by δ.
    ///
    /// # Errors
    /// As [`Estimator::roll`], and [`Refusal::BadVariance`] for a negative variance.
    pub fn roll_by(&mut self, stamp: Stamp, travel: Travel<S>) -> Result<(), Refusal> {
        if let Err(reason) = check_travel(&travel) {
            self.refuse(reason);
            return Err(reason);
        }
        if stamp < self.stamp() {
            self.tally.clock_set_back = self.tally.clock_set_back.saturating_add(1);
            self.restart(stamp, self.belief());
        }
        let after = self.ekf.predict(self.belief(), travel);
        self.history.insert(self.history.len(), Entry { stamp, event: Event::Travel(travel), after });
        self.history.forget_before(stamp.after(-self.reach));
        Ok(())
    }

    /// Corrects the belief by a measurement, at the time when it was taken.
    ///
    /// What was measured later is judged again: of two that contradict each other the earlier counts, whichever came first,
    /// and one that was accepted may be left out for it.
    pub fn measure(&mut self, measured: Stamped<Measurement<S>>) -> Outcome {
        let outcome = match self.check_measurement(&measured) {
            Err(reason) => Outcome::Refused(reason),
            Ok(()) => self.apply(measured),
        };
        self.tally.count(outcome);
        outcome
    }

    /// Counts something that is not used.
    pub(crate) fn refuse(&mut self, reason: Refusal) {
        self.tally.count(Outcome::Refused(reason));
    }

    fn check_measurement(&self, measured: &Stamped<Measurement<S>>) -> Result<(), Refusal> {
        measured.value.check()?;
        if measured.stamp > self.stamp() {
            Err(Refusal::Future)
        } else if measured.stamp < self.history.after(0).0 || self.history.has_no_room_at(measured.stamp) {
            Err(Refusal::Stale)
        } else {
            Ok(())
        }
    }

    /// Rewinds to the measurement's time, applies it, and does again what came after.
    fn apply(&mut self, measured: Stamped<Measurement<S>>) -> Outcome {
        let Stamped { stamp, value: measurement } = measured;
        let count = self.history.count_until(stamp);
        let (start, mut belief) = self.history.after(count);
        // The robot may have been rolling: the measurement then splits a stretch.
        let split = match self.history.get(count) {
            Some(Entry { stamp: end, event: Event::Travel(travel), after }) if stamp > start => {
                let part = fraction(start, stamp, end);
                let (first, rest) = (travel.part(part), travel.part(S::of(1.0) - part));
                belief = self.ekf.predict(belief, first);
                let rest = Entry { stamp: end, event: Event::Travel(rest), after };
                Some((Entry { stamp, event: Event::Travel(first), after: belief }, rest))
            }
            _ => None,
        };
        let (after, nis, accepted) = self.correct(belief, &measurement);
        if !accepted {
            return Outcome::Refused(Refusal::Outlier);
        }
        let mut index = Some(count);
        if let Some((first, rest)) = split {
            self.history.set(count, rest);
            index = self.history.insert(count, first).map(|index| index + 1);
        }
        let entry = Entry { stamp, event: Event::Measurement(measurement), after };
        let index = self.history.insert(index.unwrap_or(0), entry);
        self.redo(index.map_or(0, |index| index + 1), after);
        Outcome::Accepted { nis: nis.to_f64() }
    }

    /// Applies the entries from `index` on to `belief`.
    fn redo(&mut self, index: usize, mut belief: Belief<S>) {
        for i in index..self.history.len() {
            if let Some(mut entry) = self.history.get(i) {
                belief = match &entry.event {
                    Event::Travel(travel) => self.ekf.predict(belief, *travel),
                    Event::Measurement(measurement) => self.correct(belief, measurement).0,
                };
                entry.after = belief;
                self.history.set(i, entry);
            }
        }
    }

    fn correct(&self, belief: Belief<S>, measurement: &Measurement<S>) -> (Belief<S>, S, bool) {
        let threshold = self.gate.threshold(measurement.rows());
        let ekf = &self.ekf;
        let correction = match measurement {
            Measurement::Compass(compass) => ekf.correct(belief, &compass.innovation(&belief), threshold),
            Measurement::Wall(wall) => ekf.correct(belief, &wall.innovation(&belief), threshold),
            Measurement::Landmark(landmark) => ekf.correct(belief, &landmark.innovation(&belief), threshold),
            Measurement::Position(position) => ekf.correct(belief, &position.innovation(&belief), threshold),
            Measurement::Pose(pose) => ekf.correct(belief, &pose.innovation(&belief), threshold),
        };
        (correction.belief, correction.nis, correction.accepted)
    }
}

/// Whether a robot can have rolled so, and somebody know it so well.
fn check_travel<S: Float>(travel: &Travel<S>) -> Result<(), Refusal> {
    finite(&[travel.rims.right, travel.rims.left])?;
    let variances = [travel.variance.right, travel.variance.left];
    finite(&variances).map_err(|_| Refusal::BadVariance)?;
    if variances.iter().all(|variance| *variance >= S::of(0.0)) { Ok(()) } else { Err(Refusal::BadVariance) }
}

/// Which part of the time from `start` to `end` lies before `at`.
fn fraction<S: Float>(start: Stamp, at: Stamp, end: Stamp) -> S {
    let whole = end.since(start);
    if whole > 0.0 { S::of((at.since(start) / whole).clamp(0.0, 1.0)) } else { S::of(1.0) }
}
