//! The law's memory as the certificate sees it: one of finitely many minds, each considered.

use surepose::{Mask, Memory, Scalar};

use crate::interval::Interval;
use crate::verdict::Verdict;

/// A value of the law's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mind {
    /// The local law is in charge.
    pub near: bool,
    /// The robot drives tail first.
    pub reverse: bool,
    /// The side it turns to: −1, 1, or 0 where nothing is decided.
    pub side: i8,
}

impl Mind {
    /// Nothing decided yet: as the law starts.
    pub(crate) const FRESH: Self = Self { near: false, reverse: false, side: 0 };

    /// Every mind there is.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        [-1, 0, 1]
            .into_iter()
            .flat_map(|side| (0..4).map(move |k| Self { near: k & 1 == 1, reverse: k & 2 == 2, side }))
    }

    /// Position in the order of [`Mind::all`].
    pub(crate) fn index(self) -> usize {
        usize::from(self.near)
            + 2 * usize::from(self.reverse)
            + 4 * usize::from((self.side + 1).unsigned_abs())
    }

    /// The memory of the law that this is.
    pub fn memory<S: Scalar>(self) -> Memory<S> {
        Memory {
            near: S::Mask::splat(self.near),
            reverse: S::Mask::splat(self.reverse),
            side: S::of(f64::from(self.side)),
        }
    }

    /// The mind of a memory, where the intervals leave no doubt.
    pub(crate) fn of(memory: &Memory<Interval>) -> Option<Self> {
        let side = memory.side;
        let known = memory.near.certain() != (!memory.near).certain()
            && memory.reverse.certain() != (!memory.reverse).certain()
            && side.lo().total_cmp(&side.hi()).is_eq()
            && [-1.0, 0.0, 1.0].contains(&side.lo());
        known.then(|| Self {
            near: memory.near.certain(),
            reverse: memory.reverse.certain(),
            side: side.lo() as i8,
        })
    }

    /// The minds that a memory known only as intervals can be. A side that is not known is taken for decided.
    pub(crate) fn possible(memory: &Memory<Interval>) -> impl Iterator<Item = Self> + use<> {
        let Memory { near, reverse, side } = *memory;
        let undecided = side.lo() >= 0.0 && side.hi() <= 0.0;
        Self::all().filter(move |mind| {
            let may = |is: bool, mask: Verdict| if is { mask.possible() } else { (!mask).possible() };
            may(mind.near, near)
                && may(mind.reverse, reverse)
                && side.contains(f64::from(mind.side))
                && (mind.side != 0 || undecided)
        })
    }

    /// The mind of a memory of floats.
    pub(crate) fn of_float(memory: &Memory<f64>) -> Self {
        Self { near: memory.near, reverse: memory.reverse, side: Scalar::clamp(memory.side, -1.0, 1.0) as i8 }
    }
}
