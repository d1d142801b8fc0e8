//! The best proposals of a scan.

use crate::geometry::{Body, Map, Pose};
use crate::scalar::Float;

use super::{MERGE_TOLERANCE, is_near};

/// Up to `N` poses that differ, each with its cost.
pub(super) struct TopCandidates<S, const N: usize> {
    slots: [Option<Candidate<S>>; N],
    /// Nearer than this \[m], \[rad] they do not differ.
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

    /// Keeps the best proposals, of those that are the same the best one.
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

    /// The poses that were kept, the best first.
    pub(super) fn sorted(mut self) -> impl Iterator<Item = Pose<Map, Body, S>> {
        self.slots.sort_unstable_by(|a, b| rank(a.as_ref()).total_cmp(&rank(b.as_ref())));
        self.slots.into_iter().flatten().map(|known| known.pose)
    }

    /// The poses that were kept.
    pub(super) fn poses(&self) -> impl Iterator<Item = Pose<Map, Body, S>> + '_ {
        self.slots.iter().flatten().map(|known| known.pose)
    }
}

/// A free slot is worse than any proposal.
fn rank<S: Float>(slot: Option<&Candidate<S>>) -> f64 {
    slot.map_or(f64::INFINITY, |known| known.cost.to_f64())
}
