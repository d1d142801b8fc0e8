//! The best distinct candidate poses of a scan.

use crate::geometry::{Angle, Body, Map, Pose};
use crate::scalar::Float;

/// Distance \[m] and turn \[rad] below which hypotheses count as one.
pub(super) const MERGE_TOLERANCE: (f64, f64) = (0.2, 0.1);

/// Up to `N` distinct poses, each with its cost.
pub(super) struct TopCandidates<S, const N: usize> {
    slots: [Option<Candidate<S>>; N],
    /// Distance \[m] and turn \[rad] below which two poses count as one.
    separation: (f64, f64),
}

#[derive(Clone, Copy)]
struct Candidate<S> {
    pose: Pose<Map, Body, S>,
    cost: S,
}

impl<S: Float, const N: usize> TopCandidates<S, N> {
    pub(super) fn new() -> Self {
        Self::with_separation(MERGE_TOLERANCE)
    }

    pub(super) fn with_separation(separation: (f64, f64)) -> Self {
        Self { slots: [None; N], separation }
    }

    /// Inserts a candidate if it is among the best; of poses that count as one, the best is kept.
    pub(super) fn insert(&mut self, pose: Pose<Map, Body, S>, cost: S) {
        let separation = self.separation;
        let is_known =
            |slot: &Option<Candidate<S>>| slot.is_some_and(|known| is_near(known.pose, pose, separation));
        let worst = |slots: &[Option<Candidate<S>>]| {
            let ranks = slots.iter().map(|slot| rank(slot.as_ref()));
            ranks.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
        };
        let index = self.slots.iter().position(is_known).or_else(|| worst(&self.slots));
        let slot = index.and_then(|index| self.slots.get_mut(index));
        if let Some(slot) = slot.filter(|slot| slot.is_none_or(|known| cost < known.cost)) {
            *slot = Some(Candidate { pose, cost });
        }
    }

    /// The stored poses, best first.
    pub(super) fn sorted(mut self) -> impl Iterator<Item = Pose<Map, Body, S>> {
        self.slots.sort_unstable_by(|a, b| rank(a.as_ref()).total_cmp(&rank(b.as_ref())));
        self.slots.into_iter().flatten().map(|known| known.pose)
    }

    /// The stored poses, in any order.
    pub(super) fn poses(&self) -> impl Iterator<Item = Pose<Map, Body, S>> + '_ {
        self.slots.iter().flatten().map(|known| known.pose)
    }
}

/// Cost of a slot; a free slot is worse than any candidate.
fn rank<S: Float>(slot: Option<&Candidate<S>>) -> f64 {
    slot.map_or(f64::INFINITY, |known| known.cost.to_f64())
}

/// Whether two poses differ by less than `far` \[m] and `turn` \[rad].
pub(super) fn is_near<S: Float>(
    a: Pose<Map, Body, S>,
    b: Pose<Map, Body, S>,
    (far, turn): (f64, f64),
) -> bool {
    let turned: Angle<S> = a.heading - b.heading;
    a.origin().distance(b.origin()) < S::from_f64(far) && turned.radians().abs() < S::from_f64(turn)
}
