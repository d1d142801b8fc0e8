//! Bounded history of filter events in order of time, for rewind and replay.

use crate::scalar::Float;
use crate::time::Stamp;

use super::considered::Sensitivity;
use super::ekf::WheelOdometry;
use super::gyroscope::{FilterState, GyroscopeTurn};
use super::measurement::Measurement;

/// An event that changed the belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event<S> {
    /// Odometry from the previous entry to this one.
    Odometry(OdometryInterval<S>),
    /// A measurement, accepted or not.
    Measurement(Measurement<S>),
}

/// Odometry of an interval, and the turn that the gyroscope measured in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OdometryInterval<S> {
    pub wheels: WheelOdometry<S>,
    pub turn: Option<GyroscopeTurn<S>>,
}

impl<S: Float> OdometryInterval<S> {
    /// Fraction ∈ [0, 1] of the interval.
    pub(super) fn fraction(self, fraction: S) -> Self {
        Self { wheels: self.wheels.fraction(fraction), turn: self.turn.map(|turn| turn.fraction(fraction)) }
    }
}

/// An event, its time, and the state after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry<S> {
    pub stamp: Stamp,
    pub event: Event<S>,
    pub after: FilterState<S>,
}

/// The last `N` entries, oldest first, and the state before the oldest entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct History<S, const N: usize> {
    /// Time and state before the oldest entry.
    base: (Stamp, FilterState<S>),
    /// Ring buffer: entry `i` is at `(first + i) % N`; slots outside `len` are empty.
    ring: [Option<Entry<S>>; N],
    first: usize,
    len: usize,
    /// Sensitivity to the considered parameters before the oldest entry, and after each, in the slots of the ring; apart
    /// from the entries, which are copied at each step. Unused without considered parameters.
    base_sensitivity: Sensitivity<S>,
    sensitivities: [Sensitivity<S>; N],
    has_sensitivities: bool,
}

impl<S: Float, const N: usize> History<S, N> {
    pub(super) fn new(stamp: Stamp, state: FilterState<S>) -> Self {
        Self {
            base: (stamp, state),
            ring: [None; N],
            first: 0,
            len: 0,
            base_sensitivity: Sensitivity::new(),
            sensitivities: [Sensitivity::new(); N],
            has_sensitivities: false,
        }
    }

    /// Sensitivity to the considered parameters after the first `count` entries.
    pub(super) fn sensitivity_after(&self, count: usize) -> &Sensitivity<S> {
        match count.checked_sub(1) {
            Some(index) if index < self.len => &self.sensitivities[self.slot(index)],
            _ => &self.base_sensitivity,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Time and state after the first `count` entries.
    pub(super) fn after(&self, count: usize) -> (Stamp, &FilterState<S>) {
        match count.checked_sub(1).and_then(|i| self.get(i)) {
            Some(entry) => (entry.stamp, &entry.after),
            None => (self.base.0, &self.base.1),
        }
    }

    pub(super) fn get(&self, index: usize) -> Option<&Entry<S>> {
        if index < self.len { self.ring[self.slot(index)].as_ref() } else { None }
    }

    pub(super) fn set(&mut self, index: usize, entry: Entry<S>, sensitivity: Option<&Sensitivity<S>>) {
        if index < self.len {
            self.ring[self.slot(index)] = Some(entry);
            self.set_sensitivity(index, sensitivity);
        }
    }

    fn set_sensitivity(&mut self, index: usize, sensitivity: Option<&Sensitivity<S>>) {
        if let Some(sensitivity) = sensitivity {
            self.sensitivities[self.slot(index)] = *sensitivity;
            self.has_sensitivities = true;
        }
    }

    /// Number of entries not later than `stamp`. The search starts at the newest entry, since most delays are short.
    pub(super) fn count_until(&self, stamp: Stamp) -> usize {
        let mut count = self.len;
        while count > 0 && self.get(count - 1).is_some_and(|entry| entry.stamp > stamp) {
            count -= 1;
        }
        count
    }

    /// Whether the history is full of entries later than `stamp`. An entry inserted before all of them would be dropped
    /// first.
    pub(super) fn is_full_before(&self, stamp: Stamp) -> bool {
        self.len == N && self.get(0).is_some_and(|oldest| oldest.stamp > stamp)
    }

    /// Inserts `entry` after the first `index` entries and returns its position; a full history first drops its oldest.
    ///
    /// An entry is not stored if the history [`is_full_before`](History::is_full_before) its time. The sensitivities of later
    /// entries do not move with them; a replay sets them.
    pub(super) fn insert(
        &mut self,
        index: usize,
        entry: Entry<S>,
        sensitivity: Option<&Sensitivity<S>>,
    ) -> Option<usize> {
        let mut index = index.min(self.len);
        if self.len == N {
            self.drop_oldest();
            index = index.checked_sub(1)?;
        }
        self.len += 1;
        if index + 1 == self.len {
            let slot = self.slot(index);
            self.ring[slot] = Some(entry);
            self.set_sensitivity(index, sensitivity);
            return Some(index);
        }
        let mut moved = entry;
        for i in index..self.len {
            let slot = self.slot(i);
            let previous = self.ring[slot].replace(moved);
            match previous {
                Some(later) => moved = later,
                None => break,
            }
        }
        self.set_sensitivity(index, sensitivity);
        Some(index)
    }

    /// Drops the entries older than `stamp`.
    pub(super) fn drop_before(&mut self, stamp: Stamp) {
        while self.get(0).is_some_and(|oldest| oldest.stamp < stamp) {
            self.drop_oldest();
        }
    }

    fn drop_oldest(&mut self) {
        let slot = self.slot(0);
        if let Some(oldest) = &self.ring[slot] {
            self.base = (oldest.stamp, oldest.after);
            if self.has_sensitivities {
                self.base_sensitivity = self.sensitivities[slot];
            }
            self.ring[slot] = None;
            self.first = (self.first + 1) % N;
            self.len -= 1;
        }
    }

    fn slot(&self, index: usize) -> usize {
        (self.first + index) % N
    }
}
