//! Odometry since the last scan. Scans arrive late, and the hypotheses hold at the time of the last scan.

use crate::estimation::WheelOdometry;
use crate::kinematics::WheelPair;
use crate::scalar::Float;
use crate::time::Stamp;

/// Maximum number of separate increments: over a second at 50 Hz. Further odometry is added to the last increment.
pub const MAX_ODOMETRY_INCREMENTS: usize = 64;

/// Odometry increments, oldest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct OdometryBuffer<S> {
    start: Stamp,
    increments: [(Stamp, WheelOdometry<S>); MAX_ODOMETRY_INCREMENTS],
    len: usize,
}

/// Increments up to a stamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct OdometryIncrements<S> {
    travels: [WheelOdometry<S>; MAX_ODOMETRY_INCREMENTS],
    len: usize,
}

impl<S> OdometryIncrements<S> {
    pub(super) fn iter(&self) -> impl Iterator<Item = &WheelOdometry<S>> {
        self.travels[..self.len].iter()
    }
}

impl<S: Float> OdometryBuffer<S> {
    pub(super) fn new(stamp: Stamp) -> Self {
        Self { start: stamp, increments: [(stamp, zero()); MAX_ODOMETRY_INCREMENTS], len: 0 }
    }

    /// Start time of the buffer.
    pub(super) fn start(&self) -> Stamp {
        self.start
    }

    /// Adds odometry up to `stamp`; values that go back in time or are not finite are ignored.
    pub(super) fn push(&mut self, stamp: Stamp, travel: WheelOdometry<S>) {
        let end = self.len.checked_sub(1).map_or(self.start, |last| self.increments[last].0);
        let parts = [travel.travel.right, travel.travel.left, travel.variance.right, travel.variance.left];
        if stamp < end || !parts.iter().all(|part| part.is_finite()) {
            return;
        }
        if let Some(slot) = self.increments.get_mut(self.len) {
            *slot = (stamp, travel);
            self.len += 1;
        } else if let Some(last) = self.increments.last_mut() {
            *last = (stamp, sum(last.1, travel));
        }
    }

    /// Removes and returns the odometry before `stamp`, splitting the increment that contains it. The buffer then
    /// starts there.
    pub(super) fn take_until(&mut self, stamp: Stamp) -> OdometryIncrements<S> {
        let mut taken = OdometryIncrements { travels: [zero(); MAX_ODOMETRY_INCREMENTS], len: 0 };
        let mut begin = self.start;
        let mut kept = 0;
        for i in 0..self.len {
            let (end, travel) = self.increments[i];
            if end <= stamp {
                taken.travels[taken.len] = travel;
                taken.len += 1;
            } else if begin < stamp {
                let part = S::from_f64(stamp.since(begin) / end.since(begin));
                taken.travels[taken.len] = travel.fraction(part);
                taken.len += 1;
                self.increments[kept] = (end, travel.fraction(S::from_f64(1.0) - part));
                kept += 1;
            } else {
                self.increments[kept] = (end, travel);
                kept += 1;
            }
            begin = end;
        }
        self.len = kept;
        self.start = stamp;
        taken
    }
}

fn zero<S: Float>() -> WheelOdometry<S> {
    let zero = WheelPair::new(S::from_f64(0.0), S::from_f64(0.0));
    WheelOdometry { travel: zero, variance: zero }
}

fn sum<S: Float>(a: WheelOdometry<S>, b: WheelOdometry<S>) -> WheelOdometry<S> {
    let add = |a: WheelPair<S>, b: WheelPair<S>| WheelPair::new(a.right + b.right, a.left + b.left);
    WheelOdometry { travel: add(a.travel, b.travel), variance: add(a.variance, b.variance) }
}

#[cfg(test)]
mod tests {
    use crate::estimation::WheelOdometry;
    use crate::kinematics::WheelPair;
    use crate::time::Stamp;

    use super::{MAX_ODOMETRY_INCREMENTS, OdometryBuffer};

    fn travel(length: f64) -> WheelOdometry<f64> {
        WheelOdometry { travel: WheelPair::new(length, length), variance: WheelPair::new(0.0, 0.0) }
    }

    fn at(seconds: f64) -> Stamp {
        Stamp::from_seconds(seconds)
    }

    #[test]
    fn splitting_an_increment_preserves_travel() {
        let mut odometry = OdometryBuffer::new(at(0.0));
        for k in 1..=4 {
            odometry.push(at(0.1 * f64::from(k)), travel(1.0));
        }
        let taken: Vec<f64> = odometry.take_until(at(0.25)).iter().map(|t| t.travel.right).collect();
        assert_eq!(taken.len(), 3);
        assert!((taken.iter().sum::<f64>() - 2.5).abs() < 1e-9);
        assert_eq!(odometry.start(), at(0.25));
        let rest: f64 = odometry.take_until(at(0.4)).iter().map(|t| t.travel.right).sum();
        assert!((rest - 1.5).abs() < 1e-9);
    }

    #[test]
    fn full_buffer_preserves_travel_and_rejects_invalid_increments() {
        let mut odometry = OdometryBuffer::new(at(0.0));
        for k in 0..2 * MAX_ODOMETRY_INCREMENTS {
            odometry.push(at(0.02 * k as f64), travel(1.0));
        }
        odometry.push(at(0.0), travel(1.0));
        odometry.push(at(9.0), travel(f64::NAN));
        let all: f64 = odometry.take_until(at(10.0)).iter().map(|t| t.travel.left).sum();
        assert!((all - 2.0 * MAX_ODOMETRY_INCREMENTS as f64).abs() < 1e-9, "{all}");
    }

    extern crate std;
    use std::vec::Vec;
}
