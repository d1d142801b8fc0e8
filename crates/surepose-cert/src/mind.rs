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
    /// Which way it last travelled: −1, 1, or 0 where it has not.
    pub travel: i8,
}

impl Mind {
    /// Nothing decided yet: as the law starts.
    pub(crate) const FRESH: Self = Self { near: false, reverse: false, side: 0, travel: 0 };

    /// Every mind there is.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let signs = || [-1, 0, 1].into_iter();
        signs().flat_map(move |travel| {
            signs().flat_map(move |side| {
                (0..4).map(move |k| Self { near: k & 1 == 1, reverse: k & 2 == 2, side, travel })
            })
        })
    }

    /// Position in the order of [`Mind::all`].
    pub(crate) fn index(self) -> usize {
        usize::from(self.near)
            + 2 * usize::from(self.reverse)
            + 4 * usize::from((self.side + 1).unsigned_abs())
            + 12 * usize::from((self.travel + 1).unsigned_abs())
    }

    /// The memory of the law that this is, having trimmed its heading for `trims` ticks.
    pub fn memory<S: Scalar>(self, trims: S) -> Memory<S> {
        Memory {
            near: S::Mask::splat(self.near),
            reverse: S::Mask::splat(self.reverse),
            side: S::of(f64::from(self.side)),
            trims,
            travel: S::of(f64::from(self.travel)),
        }
    }

    /// Every memory of the law that this is.
    pub(crate) fn memories(self) -> Memory<Interval> {
        self.memory(Interval::new(0.0, f64::MAX))
    }

    /// The mind of a memory, where the intervals leave no doubt.
    pub(crate) fn of(memory: &Memory<Interval>) -> Option<Self> {
        let is_known = |mask: Verdict| mask.certain() != (!mask).certain();
        let sign = |x: Interval| {
            let is_one = x.lo().total_cmp(&x.hi()).is_eq() && [-1.0, 0.0, 1.0].contains(&x.lo());
            is_one.then(|| x.lo() as i8)
        };
        let (near, reverse) = (memory.near, memory.reverse);
        let (side, travel) = (sign(memory.side)?, sign(memory.travel)?);
        (is_known(near) && is_known(reverse)).then(|| Self {
            near: near.certain(),
            reverse: reverse.certain(),
            side,
            travel,
        })
    }

    /// Whether W is the same function for both: it depends on the end that goes first and on the side it turns to.
    pub(crate) fn weighs_as(self, other: Self) -> bool {
        self.reverse == other.reverse && self.side == other.side
    }

    /// The minds that a memory known only as intervals can be. A side that is not known is taken for decided.
    pub(crate) fn possible(memory: &Memory<Interval>) -> impl Iterator<Item = Self> + use<> {
        let Memory { near, reverse, side, travel, .. } = *memory;
        let is_zero = |x: Interval| x.lo() >= 0.0 && x.hi() <= 0.0;
        let undecided = is_zero(side);
        Self::all().filter(move |mind| {
            let may = |is: bool, mask: Verdict| if is { mask.possible() } else { (!mask).possible() };
            may(mind.near, near)
                && may(mind.reverse, reverse)
                && side.contains(f64::from(mind.side))
                && (mind.side != 0 || undecided)
                && travel.contains(f64::from(mind.travel))
        })
    }

    /// The mind of a memory of floats.
    pub(crate) fn of_float(memory: &Memory<f64>) -> Self {
        let sign = |x: f64| Scalar::clamp(x, -1.0, 1.0) as i8;
        let (side, travel) = (sign(memory.side), sign(memory.travel));
        Self { near: memory.near, reverse: memory.reverse, side, travel }
    }
}
