//! Elementary functions of intervals.
//!
//! They use `libm`, as the core does. Its sine, cosine, and arc tangent are those of FreeBSD's msun. Their
//! error is below 1 ulp in the polynomial ranges, and below 2 ulp for `atan2`. The argument reduction is
//! exact to more than 30 further bits. Bounds are moved outward by *twice* that error: once for the error at
//! the bound, once to enclose the `libm` result of every member. The tests compare the bounds with an
//! arbitrary-precision oracle.

use core::f64::consts::{FRAC_2_PI, PI, TAU};

use super::{Interval, at_least_ulps};

/// Twice the error of `libm`'s sine and cosine \[ulp].
const SIN_COS_ULPS: f64 = 2.0;
/// Twice the error of `libm`'s `atan2` \[ulp].
const ATAN2_ULPS: f64 = 4.0;
/// Largest angle evaluated \[rad]. Larger intervals give the full range of sine and cosine.
const MAX_ANGLE: f64 = 1e9;

impl Interval {
    /// Square; tighter than `self * self`, which treats the factors as independent.
    #[must_use]
    #[inline]
    pub fn square(self) -> Self {
        let (small, large) = (self.mignitude(), self.magnitude());
        let square = Self::outward(small * small, large * large);
        Self { lo: square.lo.max(0.0), hi: square.hi }
    }

    /// Square root of the nonnegative members. The entire line if all members are negative.
    pub(super) fn root(self) -> Self {
        let root = Self::outward(self.lo.max(0.0).sqrt(), self.hi.sqrt());
        Self { lo: if self.hi < 0.0 { root.lo } else { root.lo.max(0.0) }, hi: root.hi }
    }

    /// Sine and cosine.
    pub(super) fn sine_cosine(self) -> (Self, Self) {
        let all = Self { lo: -1.0, hi: 1.0 };
        if self.magnitude() > MAX_ANGLE || self.hi - self.lo >= TAU {
            return (all, all);
        }
        let (sin_lo, cos_lo) = libm::sincos(self.lo);
        let (sin_hi, cos_hi) = libm::sincos(self.hi);
        let mut sin = padded(sin_lo.min(sin_hi), sin_lo.max(sin_hi), SIN_COS_ULPS);
        let mut cos = padded(cos_lo.min(cos_hi), cos_lo.max(cos_hi), SIN_COS_ULPS);
        // Between the bounds, sine and cosine have extrema at multiples of π/2 only. An extremum included by
        // rounding is harmless, so the range of multiples is rounded outward.
        let (first, last) = (self.lo * FRAC_2_PI, self.hi * FRAC_2_PI);
        let slack = 4.0 * f64::EPSILON * (1.0 + first.abs().max(last.abs()));
        let (first, last) = ((first - slack).ceil() as i64, (last + slack).floor() as i64);
        for quarter in first..=last {
            match quarter.rem_euclid(4) {
                0 => cos.hi = 1.0,
                1 => sin.hi = 1.0,
                2 => cos.lo = -1.0,
                _ => sin.lo = -1.0,
            }
        }
        (within_one(sin), within_one(cos))
    }

    /// sin(x)/x, which is even and decreases from 1 at 0 to 0 at π.
    pub(super) fn sine_over(self, sin: Self) -> Self {
        let (near, far) = (self.mignitude(), self.magnitude());
        if far > PI {
            let bounded = Self { lo: -0.25, hi: 1.0 };
            return if near > 0.0 { (sin / self).intersection(bounded).unwrap_or(bounded) } else { bounded };
        }
        // Two roundings and the error of `libm`, each below an ulp of a value below 1; doubled for the
        // members inside.
        let at = |x: f64| if x < 1e-8 { 1.0 } else { libm::sin(x) / x };
        let (lo, hi) = (at(far), at(near));
        let bounds = padded(lo.min(hi), hi, 6.0);
        Self { lo: bounds.lo, hi: bounds.hi.min(1.0) }
    }

    /// Derivative of sin(x)/x: odd, −x/3 to first order, magnitude at most |x|/3 and at most ½.
    pub(super) fn sine_over_slope(self) -> Self {
        let third = 1.0 / 3.0;
        let bound = |x: f64| (x * third).abs().min(0.5).next_up();
        let hi = if self.lo < 0.0 { bound(self.lo) } else { 0.0 };
        let lo = if self.hi > 0.0 { -bound(self.hi) } else { 0.0 };
        // −x/3 ≤ slope ≤ −x/3 + x³/30 for x ≥ 0, and its mirror image for x < 0; tight for small x.
        let far = self.magnitude();
        if far > 3.0 {
            return Self { lo: -0.5, hi: 0.5 };
        }
        let linear = -self * Self::point(third).hull(Self::point(third.next_up()));
        let cubic = (far * far * far * (1.0 / 30.0)).next_up().next_up();
        let rest = Self {
            lo: if self.lo < 0.0 { -cubic } else { 0.0 },
            hi: if self.hi > 0.0 { cubic } else { 0.0 },
        };
        (linear + rest).intersection(Self { lo, hi }).unwrap_or(Self { lo, hi })
    }

    /// Angle of the vector (`x`, `self`) \[rad].
    ///
    /// The result is the full circle if the box contains the origin or crosses the negative x axis. A vector
    /// on that axis has the angle π. So has one so little below it that the arc tangent rounds to −π: there
    /// [`surepose::scalar::Scalar::atan2`] returns π.
    pub(super) fn angle(self, x: Self) -> Self {
        let circle = padded(-PI, PI, 1.0);
        let origin = self.contains(0.0) && x.contains(0.0);
        let across = x.lo < 0.0 && self.lo < 0.0 && self.hi >= 0.0;
        if origin || across || !(self.magnitude().is_finite() && x.magnitude().is_finite()) {
            return circle;
        }
        // Away from the branch cut, the extreme angles occur at corners. Adding 0 removes the sign of −0.
        let (low, high) = (self.lo + 0.0, self.hi + 0.0);
        let corners = [
            libm::atan2(low, x.lo),
            libm::atan2(low, x.hi),
            libm::atan2(high, x.lo),
            libm::atan2(high, x.hi),
        ];
        let lo = corners.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let angle = padded(lo, hi, ATAN2_ULPS);
        if angle.lo <= -PI { circle } else { angle }
    }
}

/// Moves bounds outward by `ulps`.
#[inline]
fn padded(lo: f64, hi: f64, ulps: f64) -> Interval {
    Interval::outward(lo - at_least_ulps(lo, ulps), hi + at_least_ulps(hi, ulps))
}

#[inline]
fn within_one(x: Interval) -> Interval {
    Interval { lo: x.lo.max(-1.0), hi: x.hi.min(1.0) }
}
