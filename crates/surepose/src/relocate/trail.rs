//! What odometry said since the last scan: scans come late, and the hypotheses stay at the time of the last one.

use crate::drive::Wheels;
use crate::estimate::{Stamp, Travel};
use crate::scalar::Float;

/// The most stretches that are kept apart: over a second at 50 Hz. What comes on top is added to the last one.
pub const MOST_STRETCHES: usize = 64;

/// Stretches of odometry, oldest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trail<S> {
    start: Stamp,
    stretches: [(Stamp, Travel<S>); MOST_STRETCHES],
    len: usize,
}

/// The travels up to a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Travels<S> {
    travels: [Travel<S>; MOST_STRETCHES],
    len: usize,
}

impl<S> Travels<S> {
    pub(super) fn iter(&self) -> impl Iterator<Item = &Travel<S>> {
        self.travels[..self.len].iter()
    }
}

impl<S: Float> Trail<S> {
    pub(super) fn starting(stamp: Stamp) -> Self {
        Self { start: stamp, stretches: [(stamp, none()); MOST_STRETCHES], len: 0 }
    }

    /// When it starts.
    pub(super) fn start(&self) -> Stamp {
        self.start
    }

    /// The robot rolled until `stamp`; what goes back in time or is not finite is left out.
    pub(super) fn push(&mut self, stamp: Stamp, travel: Travel<S>) {
        let end = self.len.checked_sub(1).map_or(self.start, |last| self.stretches[last].0);
        let parts = [travel.rims.right, travel.rims.left, travel.variance.right, travel.variance.left];
        if stamp < end || !parts.iter().all(|part| part.is_finite()) {
            return;
        }
        if let Some(slot) = self.stretches.get_mut(self.len) {
            *slot = (stamp, travel);
            self.len += 1;
        } else if let Some(last) = self.stretches.last_mut() {
            *last = (stamp, sum(last.1, travel));
        }
    }

    /// Takes off what lies before `stamp`, splitting the stretch in which it falls; the trail starts there then.
    pub(super) fn take_until(&mut self, stamp: Stamp) -> Travels<S> {
        let mut taken = Travels { travels: [none(); MOST_STRETCHES], len: 0 };
        let mut begin = self.start;
        let mut kept = 0;
        for i in 0..self.len {
            let (end, travel) = self.stretches[i];
            if end <= stamp {
                taken.travels[taken.len] = travel;
                taken.len += 1;
            } else if begin < stamp {
                let part = S::of(stamp.since(begin) / end.since(begin));
                taken.travels[taken.len] = travel.part(part);
                taken.len += 1;
                self.stretches[kept] = (end, travel.part(S::of(1.0) - part));
                kept += 1;
            } else {
                self.stretches[kept] = (end, travel);
                kept += 1;
            }
            begin = end;
        }
        self.len = kept;
        self.start = stamp;
        taken
    }
}

fn none<S: Float>() -> Travel<S> {
    let zero = Wheels::new(S::of(0.0), S::of(0.0));
    Travel { rims: zero, variance: zero }
}

fn sum<S: Float>(a: Travel<S>, b: Travel<S>) -> Travel<S> {
    let add = |a: Wheels<S>, b: Wheels<S>| Wheels::new(a.right + b.right, a.left + b.left);
    Travel { rims: add(a.rims, b.rims), variance: add(a.variance, b.variance) }
}

#[cfg(test)]
mod tests {
    use super::{MOST_STRETCHES, Trail};
    use crate::{Stamp, Travel, Wheels};

    fn travel(length: f64) -> Travel<f64> {
        Travel { rims: Wheels::new(length, length), variance: Wheels::new(0.0, 0.0) }
    }

    fn at(seconds: f64) -> Stamp {
        Stamp::from_seconds(seconds)
    }

    #[test]
    fn nothing_is_lost_where_a_scan_falls_into_a_stretch() {
        let mut trail = Trail::starting(at(0.0));
        for k in 1..=4 {
            trail.push(at(0.1 * f64::from(k)), travel(1.0));
        }
        let taken: Vec<f64> = trail.take_until(at(0.25)).iter().map(|t| t.rims.right).collect();
        assert_eq!(taken.len(), 3);
        assert!((taken.iter().sum::<f64>() - 2.5).abs() < 1e-9);
        assert_eq!(trail.start(), at(0.25));
        let rest: f64 = trail.take_until(at(0.4)).iter().map(|t| t.rims.right).sum();
        assert!((rest - 1.5).abs() < 1e-9);
    }

    #[test]
    fn full_trail_forgets_no_travel_and_takes_none_that_is_broken() {
        let mut trail = Trail::starting(at(0.0));
        for k in 0..2 * MOST_STRETCHES {
            trail.push(at(0.02 * k as f64), travel(1.0));
        }
        trail.push(at(0.0), travel(1.0));
        trail.push(at(9.0), travel(f64::NAN));
        let all: f64 = trail.take_until(at(10.0)).iter().map(|t| t.rims.left).sum();
        assert!((all - 2.0 * MOST_STRETCHES as f64).abs() < 1e-9, "{all}");
    }

    extern crate std;
    use std::vec::Vec;
}
