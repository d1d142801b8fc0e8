//! The best proposals of a scan.

use crate::frame::{Body, Map};
use crate::pose::Pose;
use crate::scalar::Float;

use super::is_same;

/// Up to `N` poses that differ, each with its misfit.
pub(super) struct Pool<S, const N: usize> {
    slots: [Option<Proposal<S>>; N],
}

#[derive(Clone, Copy)]
struct Proposal<S> {
    pose: Pose<Map, Body, S>,
    misfit: S,
}

impl<S: Float, const N: usize> Pool<S, N> {
    pub(super) fn empty() -> Self {
        Self { slots: [None; N] }
    }

    /// Keeps the best proposals, of those that are the same the best one.
    pub(super) fn keep(&mut self, pose: Pose<Map, Body, S>, misfit: S) {
        let is_known = |slot: &Option<Proposal<S>>| slot.is_some_and(|known| is_same(known.pose, pose));
        let worst = |slots: &[Option<Proposal<S>>]| {
            let ranks = slots.iter().map(|slot| slot.map_or(f64::INFINITY, |known| known.misfit.to_f64()));
            ranks.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
        };
        let index = self.slots.iter().position(is_known).or_else(|| worst(&self.slots));
        if let Some(slot) = index.and_then(|index| self.slots.get_mut(index))
            && slot.is_none_or(|known| misfit < known.misfit)
        {
            *slot = Some(Proposal { pose, misfit });
        }
    }

    /// The poses that were kept.
    pub(super) fn poses(&self) -> impl Iterator<Item = Pose<Map, Body, S>> + '_ {
        self.slots.iter().flatten().map(|known| known.pose)
    }
}
