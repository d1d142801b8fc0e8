//! Implementation of the core's `Scalar` trait for intervals.

use core::f64::consts::{PI, TAU};

use surepose::geometry::Angle;
use surepose::scalar::Scalar;

use crate::branching::choose_branch;
use crate::interval::Interval;
use crate::tribool::Tribool;

impl Scalar for Interval {
    type Mask = Tribool;

    /// The float `value` as the program has it; π, for example, is the `f64` π.
    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::point(value)
    }
    #[inline]
    fn lt(self, other: Self) -> Tribool {
        if self.hi < other.lo {
            Tribool::True
        } else if self.lo >= other.hi {
            Tribool::False
        } else {
            match choose_branch(2) {
                Some(0) => Tribool::True,
                Some(_) => Tribool::False,
                None => Tribool::Unknown,
            }
        }
    }
    #[inline]
    fn select(mask: Tribool, yes: Self, no: Self) -> Self {
        match mask {
            Tribool::True => yes,
            Tribool::False => no,
            Tribool::Unknown => yes.hull(no),
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
            && let Some(taken) = choose_branch(count as u8)
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
    fn sinc_derivative(self, _cos: Self, _sinc: Self) -> Self {
        self.sine_over_slope()
    }
    #[inline]
    fn squared(self) -> Self {
        self.square()
    }
    #[inline]
    fn wrap_once(self) -> Self {
        // Floats in (−π, π] are returned unchanged: they are less than half a turn from 0, so the turn count
        // rounds to 0.
        if self.lo > -PI && self.hi <= PI {
            return self;
        }
        // An interval across ±π is split into branches. −π appears as π in the piece of the next turn.
        let turns = (self * Self::from_f64(1.0 / TAU)).nearest();
        let count = turns.hi - turns.lo + 1.0;
        if (2.0..=3.0).contains(&count)
            && let Some(taken) = choose_branch(count as u8)
        {
            let near = self - Self::from_f64(TAU) * Self::point(turns.lo + f64::from(taken));
            return near.clamp(Self::from_f64(-PI), Self::from_f64(PI));
        }
        Angle::from_radians(self).radians()
    }
}

impl Interval {
    /// Nearest integers; both at a tie.
    #[inline]
    fn nearest(self) -> Self {
        let (lo, hi) = ((self.lo - 0.5).ceil(), (self.hi + 0.5).floor());
        Self { lo: lo.min(hi), hi: hi.max(lo) }
    }
}
