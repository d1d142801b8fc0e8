//! Intervals as a scalar of the core: its law, limits and motion take them as they take floats.

use core::f64::consts::{PI, TAU};

use surepose::{Angle, Scalar};

use crate::fork::choose;
use crate::interval::Interval;
use crate::verdict::Verdict;

impl Scalar for Interval {
    type Mask = Verdict;

    /// The float `value`, which is what the program has: π, for one, is the `f64` π.
    #[inline]
    fn of(value: f64) -> Self {
        Self::point(value)
    }
    #[inline]
    fn lt(self, other: Self) -> Verdict {
        if self.hi < other.lo {
            Verdict::Yes
        } else if self.lo >= other.hi {
            Verdict::No
        } else {
            match choose(2) {
                Some(0) => Verdict::Yes,
                Some(_) => Verdict::No,
                None => Verdict::Maybe,
            }
        }
    }
    #[inline]
    fn select(mask: Verdict, yes: Self, no: Self) -> Self {
        match mask {
            Verdict::Yes => yes,
            Verdict::No => no,
            Verdict::Maybe => yes.hull(no),
        }
    }
    #[inline]
    fn abs(self) -> Self {
        Self { lo: self.mignitude(), hi: self.magnitude() }
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi) }
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi) }
    }
    #[inline]
    fn round(self) -> Self {
        let all = self.nearest();
        let count = all.hi - all.lo + 1.0;
        if (2.0..=4.0).contains(&count)
            && let Some(taken) = choose(count as u8)
        {
            return Self::point(all.lo + f64::from(taken));
        }
        all
    }
    #[inline]
    fn sqrt(self) -> Self {
        self.root()
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        self.sine_cosine()
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        self.angle(x)
    }
    #[inline]
    fn sin_cos_sinc(self) -> (Self, Self, Self) {
        let (sin, cos) = self.sine_cosine();
        (sin, cos, self.sine_over(sin))
    }
    #[inline]
    fn sinc_slope(self, _cos: Self, _sinc: Self) -> Self {
        self.sine_over_slope()
    }
    #[inline]
    fn squared(self) -> Self {
        self.square()
    }
    #[inline]
    fn wrapped_sum(self) -> Self {
        // Floats in (−π, π] stay as they are: they are less than half a turn from 0, and half a turn rounds to none.
        if self.lo > -PI && self.hi <= PI {
            return self;
        }
        // Across the branch: each piece on its own way. −π comes as π with the piece that is one turn on.
        let turns = (self * Self::of(1.0 / TAU)).nearest();
        let count = turns.hi - turns.lo + 1.0;
        if (2.0..=3.0).contains(&count)
            && let Some(taken) = choose(count as u8)
        {
            let near = self - Self::of(TAU) * Self::point(turns.lo + f64::from(taken));
            return near.clamp(Self::of(-PI), Self::of(PI));
        }
        Angle::wrapped(self).radians()
    }
}

impl Interval {
    /// The nearest integers, both at a tie.
    #[inline]
    fn nearest(self) -> Self {
        let (lo, hi) = ((self.lo - 0.5).ceil(), (self.hi + 0.5).floor());
        Self { lo: lo.min(hi), hi: hi.max(lo) }
    }
}
