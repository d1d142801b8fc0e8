//! Sets of numbers, computed with so that nothing gets lost.

mod functions;
mod scalar;
#[cfg(test)]
mod tests;

use core::ops::{Add, Div, Mul, Neg, Sub};

/// All real numbers between two bounds, both included; a bound may be infinite.
///
/// An operation's result contains the exact result for every choice of members, and also what `f64` computes for
/// members that are `f64`: bounds are rounded outwards by at least the error of the `f64` operation. So what is
/// proved with intervals holds for the program, rounding included. A result that is not a number, or one that
/// cannot be bounded, is the whole line. There is no empty interval.
///
/// ```
/// use surepose_cert::Interval;
/// let third = Interval::point(1.0) / Interval::point(3.0);
/// assert!(third.lo() < third.hi() && third.contains(1.0 / 3.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The whole line.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// From `a` to `b`, in either order; the whole line if one is NaN.
    #[inline]
    pub fn new(a: f64, b: f64) -> Self {
        if a <= b {
            Self::bounded(a, b)
        } else if b < a {
            Self::bounded(b, a)
        } else {
            Self::ENTIRE
        }
    }

    /// One number; the whole line if it is NaN.
    #[inline]
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// From −`radius` to `radius`.
    #[inline]
    pub fn symmetric(radius: f64) -> Self {
        Self::new(-radius, radius)
    }

    /// The lower bound.
    #[inline]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// The upper bound.
    #[inline]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// A number near the middle; finite.
    #[inline]
    pub fn mid(self) -> f64 {
        let (lo, hi) = (self.lo.max(f64::MIN), self.hi.min(f64::MAX));
        (lo * 0.5 + hi * 0.5).clamp(lo, hi)
    }

    /// Upper minus lower bound, rounded up.
    #[inline]
    pub fn width(self) -> f64 {
        (self.hi - self.lo).next_up()
    }

    /// The largest absolute value.
    #[inline]
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest absolute value.
    #[inline]
    pub fn mignitude(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    /// Whether `value` is a member.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether every member of `other` is one of these.
    #[inline]
    pub fn encloses(self, other: Self) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// The smallest interval with the members of both.
    #[must_use]
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The members of both, if there are any.
    #[inline]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then_some(Self { lo, hi })
    }

    /// Two halves that share the middle.
    #[inline]
    pub fn halves(self) -> (Self, Self) {
        let mid = self.mid();
        (Self { lo: self.lo, hi: mid }, Self { lo: mid, hi: self.hi })
    }

    /// Piece `index` of `count` equal ones, which overlap in their ends; of an unbounded interval, all of it.
    #[must_use]
    pub fn piece(self, index: usize, count: usize) -> Self {
        if !(self.hi - self.lo).is_finite() {
            return self;
        }
        let cut = |i: usize| {
            let part = i as f64 / count as f64;
            (self.lo + (self.hi - self.lo) * part).clamp(self.lo, self.hi)
        };
        Self { lo: cut(index), hi: if index + 1 >= count { self.hi } else { cut(index + 1) } }
    }

    /// Bounds already known to be in order; an infinite point is the numbers beyond the largest float.
    #[inline]
    fn bounded(lo: f64, hi: f64) -> Self {
        Self { lo: lo.min(f64::MAX), hi: hi.max(f64::MIN) }
    }

    /// From the least to the largest of results computed to nearest, of which NaN are left out.
    #[inline]
    fn spanned([a, b, c, d]: [f64; 4]) -> Self {
        // Without a NaN, which the sum shows, plain comparisons do: one instruction each.
        if ((a + b) + (c + d)).is_nan() {
            return Self::outward(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        }
        let smaller = |x: f64, y: f64| if x < y { x } else { y };
        let larger = |x: f64, y: f64| if x > y { x } else { y };
        Self::outward(smaller(smaller(a, b), smaller(c, d)), larger(larger(a, b), larger(c, d)))
    }

    /// Bounds computed to nearest, moved outwards by one float.
    ///
    /// Little more than half the way to the next float is added, and rounds to it \[Rump2009].
    #[inline]
    fn outward(lo: f64, hi: f64) -> Self {
        const HALF_ULP: f64 = 0.5 * (1.0 + f64::EPSILON);
        let (low, high) = (lo - at_least_ulps(lo, HALF_ULP), hi + at_least_ulps(hi, HALF_ULP));
        if low <= high { Self { lo: low, hi: high } } else { Self::unordered(lo, hi) }
    }

    /// The same where the quick way ends in NaN: of an infinite bound that rounding made, the largest float is left.
    #[cold]
    fn unordered(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo: lo.next_down(), hi: hi.next_up() } } else { Self::ENTIRE }
    }
}

/// At least so many times the distance of `x` from the next float: 2⁻⁵²·|x| is at least that of a normal number.
///
/// Nothing smaller than [`TINY`] comes of it, so that products stay normal: with subnormal numbers, processors are slow.
#[inline]
fn at_least_ulps(x: f64, ulps: f64) -> f64 {
    x.abs().max(TINY) * (ulps * f64::EPSILON)
}

/// The square of what [`at_least_ulps`] makes of it is a normal number.
const TINY: f64 = 1e-130;

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::outward(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::outward(self.lo - other.hi, self.hi - other.lo)
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        // 0·∞ is NaN where the bound stands for "arbitrarily large": 0, which another product then has too, or
        // all four are NaN and the answer is the whole line.
        let (a, b) = (self.lo * other.lo, self.lo * other.hi);
        let (c, d) = (self.hi * other.lo, self.hi * other.hi);
        Self::spanned([a, b, c, d])
    }
}

impl Div for Interval {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::ENTIRE;
        }
        let (a, b) = (self.lo / other.lo, self.lo / other.hi);
        let (c, d) = (self.hi / other.lo, self.hi / other.hi);
        // ∞/∞ is NaN where every value between 0 and ∞ is possible; the other quotients give 0 only on one side.
        if a.is_nan() || b.is_nan() || c.is_nan() || d.is_nan() {
            return Self::ENTIRE;
        }
        Self::spanned([a, b, c, d])
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}
