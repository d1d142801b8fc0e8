//! Interval arithmetic with outward rounding.

mod functions;
mod scalar;
#[cfg(test)]
mod tests;

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A closed interval of real numbers; bounds may be infinite.
///
/// The result of an operation encloses the exact result for all members, and the `f64` result for all `f64`
/// members. Bounds are rounded outward by at least the error of the `f64` operation. A claim proved with
/// intervals therefore holds for the program, rounding included. A result that is NaN or unbounded is
/// [`Interval::ENTIRE`]. There is no empty interval.
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
    /// All real numbers.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// Creates the interval between `a` and `b`, in either order. NaN gives [`Interval::ENTIRE`].
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

    /// Creates an interval with one member. NaN gives [`Interval::ENTIRE`].
    #[inline]
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Creates the interval [−`radius`, `radius`].
    #[inline]
    pub fn symmetric(radius: f64) -> Self {
        Self::new(-radius, radius)
    }

    /// Lower bound.
    #[inline]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Upper bound.
    #[inline]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// Approximate midpoint; always finite.
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

    /// Largest absolute value of a member.
    #[inline]
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Smallest absolute value of a member.
    #[inline]
    pub fn mignitude(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    /// Whether `value` is a member.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether every member of `other` is a member of `self`.
    #[inline]
    pub fn encloses(self, other: Self) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// Smallest interval that encloses both.
    #[must_use]
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Common members. `None`: disjoint.
    #[inline]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then_some(Self { lo, hi })
    }

    /// Splits at the midpoint; both halves contain it.
    #[inline]
    pub fn halves(self) -> (Self, Self) {
        let mid = self.mid();
        (Self { lo: self.lo, hi: mid }, Self { lo: mid, hi: self.hi })
    }

    /// Piece `index` of `count` equal pieces with shared end points. An unbounded interval is returned whole.
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

    /// Creates an interval from ordered bounds. An infinite point becomes the interval beyond the largest
    /// float.
    #[inline]
    fn bounded(lo: f64, hi: f64) -> Self {
        Self { lo: lo.min(f64::MAX), hi: hi.max(f64::MIN) }
    }

    /// Encloses four results rounded to nearest; NaN values are ignored.
    #[inline]
    fn spanned([a, b, c, d]: [f64; 4]) -> Self {
        // The sum shows whether there is a NaN. Without one, plain comparisons take one instruction each.
        if ((a + b) + (c + d)).is_nan() {
            return Self::outward(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        }
        let smaller = |x: f64, y: f64| if x < y { x } else { y };
        let larger = |x: f64, y: f64| if x > y { x } else { y };
        Self::outward(smaller(smaller(a, b), smaller(c, d)), larger(larger(a, b), larger(c, d)))
    }

    /// Moves bounds that were rounded to nearest outward by one float.
    ///
    /// Slightly more than half the distance to the next float is added, which rounds to the next float
    /// \[Rump2009].
    #[inline]
    fn outward(lo: f64, hi: f64) -> Self {
        const HALF_ULP: f64 = 0.5 * (1.0 + f64::EPSILON);
        let (low, high) = (lo - at_least_ulps(lo, HALF_ULP), hi + at_least_ulps(hi, HALF_ULP));
        if low <= high { Self { lo: low, hi: high } } else { Self::unordered(lo, hi) }
    }

    /// Handles the NaN of [`Interval::outward`]: for an infinite bound due to overflow, the largest float
    /// remains.
    #[cold]
    fn unordered(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo: lo.next_down(), hi: hi.next_up() } } else { Self::ENTIRE }
    }
}

/// Returns at least `ulps` times the distance from `x` to the next float.
///
/// For normal numbers, 2⁻⁵²·|x| is at least that distance. The result is never smaller than that for
/// [`TINY`], so products stay normal; processors are slow with subnormal numbers.
#[inline]
fn at_least_ulps(x: f64, ulps: f64) -> f64 {
    x.abs().max(TINY) * (ulps * f64::EPSILON)
}

/// Smallest magnitude used; the square of the resulting padding is a normal number.
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
        // 0·∞ is NaN where the bound means "arbitrarily large". The product 0 then occurs in another term, or
        // all four terms are NaN and the result is the entire line.
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
        // ∞/∞ is NaN, and any value between 0 and ∞ is possible. The other quotients give 0 on one side only.
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
