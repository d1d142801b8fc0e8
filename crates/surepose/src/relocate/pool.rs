//! The best proposals of a scan.

use crate::frame::{Body, Map};
use crate::pose::Pose;
use crate::scalar::Float;

use super::{SAME, is_near};

/// Up to `N` poses that differ, each with its misfit.
pub(super) struct Pool<S, const N: usize> {
    slots: [Option<Proposal<S>>; N],
    /// Nearer than this \[m], \[rad] they do not differ.
    apart: (f64, f64),
}

#[derive(Clone, Copy)]
struct Proposal<S> {
    pose: Pose<Map, Body, S>,
    misfit: S,
}

impl<S: Float, const N: usize> Pool<S, N> {
    pub(super) fn empty() -> Self {
        Self::apart(SAME)
    }

    pub(super) fn apart(apart: (f64, f64)) -> Self {
        Self { slots: [None; N], apart }
    }

    /// Keeps the best proposals, of those that are the same the best one.
    pub(super) fn keep(&mut self, pose: Pose<Map, Body, S>, misfit: S) {
        let apart = self.apart;
        let is_known =
            |slot: &Option<Proposal<S>>| slot.is_some_and(|known| is_near(known.pose, pose, apart));
        let worst = |slots: &[Option<Proposal<S>>]| {
            let ranks = slots.iter().map(|slot| rank(slot.as_ref()));
            ranks.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
        };
        let index = self.slots.iter().position(is_known).or_else(|| worst(&self.slots));
        let slot = index.and_then(|index| self.slots.get_mut(index));
        if let Some(slot) = slot.filter(|slot| slot.is_none_or(|known| misfit < known.misfit)) {
            *slot = Some(Proposal { pose, misfit });
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
fn rank<S: Float>(slot: Option<&Proposal<S>>) -> f64 {
    slot.map_or(f64::INFINITY, |known| known.misfit.to_f64())
}
