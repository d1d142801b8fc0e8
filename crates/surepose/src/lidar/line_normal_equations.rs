//! Normal equations of weighted least squares for a line in (a, b).

use crate::scalar::Float;

use super::beam::Beam;
use super::inverse_range_line::InverseRangeLine;

/// Sums over beams: Σ w·g·gᵀ and Σ w·g·v with g = (cos φ, sin φ), weights w, values v.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineNormalEquations<S> {
    cc: S,
    cs: S,
    ss: S,
    c: S,
    s: S,
    /// Number of beams.
    pub count: u16,
    /// Sum of the squared normalized residuals of the beams.
    pub chi2: S,
}

/// Covariance of an estimated (a, b).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineCovariance<S> {
    pub aa: S,
    pub ab: S,
    pub bb: S,
}

impl<S: Float> LineNormalEquations<S> {
    #[inline]
    pub(super) fn add(&mut self, beam: &Beam<S>, weight: S, value: S) {
        let (wc, ws) = (weight * beam.cos, weight * beam.sin);
        self.cc = self.cc + wc * beam.cos;
        self.cs = self.cs + wc * beam.sin;
        self.ss = self.ss + ws * beam.sin;
        self.c = self.c + wc * value;
        self.s = self.s + ws * value;
    }

    /// Sum of both normal equations.
    #[must_use]
    pub(super) fn merged(&self, other: &Self) -> Self {
        Self {
            cc: self.cc + other.cc,
            cs: self.cs + other.cs,
            ss: self.ss + other.ss,
            c: self.c + other.c,
            s: self.s + other.s,
            count: self.count + other.count,
            chi2: self.chi2 + other.chi2,
        }
    }

    /// Least-squares (a, b) and its covariance, the inverse of the normal matrix.
    #[inline]
    pub(super) fn solve(&self) -> (InverseRangeLine<S>, LineCovariance<S>) {
        let scale = S::from_f64(1.0) / (self.cc * self.ss - self.cs.squared());
        let covariance = LineCovariance { aa: self.ss * scale, ab: -self.cs * scale, bb: self.cc * scale };
        let line = InverseRangeLine {
            a: covariance.aa * self.c + covariance.ab * self.s,
            b: covariance.ab * self.c + covariance.bb * self.s,
        };
        (line, covariance)
    }

    /// Decrease of χ² by the step of [`LineNormalEquations::solve`], where the values are residuals. It equals the
    /// squared length of the step in standard deviations.
    #[inline]
    pub(super) fn cost_reduction(&self, step: InverseRangeLine<S>) -> S {
        step.a * self.c + step.b * self.s
    }
}

impl<S: Float> LineCovariance<S> {
    /// Variance of u at the bearing of `beam`.
    #[inline]
    pub(super) fn at(&self, beam: &Beam<S>) -> S {
        self.aa * beam.cos.squared()
            + S::from_f64(2.0) * self.ab * beam.cos * beam.sin
            + self.bb * beam.sin.squared()
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self { aa: self.aa + other.aa, ab: self.ab + other.ab, bb: self.bb + other.bb }
    }

    #[inline]
    pub(super) fn times(self, factor: S) -> Self {
        Self { aa: self.aa * factor, ab: self.ab * factor, bb: self.bb * factor }
    }

    /// eᵀ P⁻¹ e.
    #[inline]
    pub(super) fn mahalanobis_squared(&self, e: InverseRangeLine<S>) -> S {
        let determinant = self.aa * self.bb - self.ab.squared();
        (self.bb * e.a.squared() - S::from_f64(2.0) * self.ab * e.a * e.b + self.aa * e.b.squared())
            / determinant
    }
}

/// The 99.9 % quantile of χ² of `count` beams on one straight line.
///
/// [WilsonHilferty1931]: (χ²/n)^⅓ is nearly normal with mean 1 − 2/(9n) and variance 2/(9n).
#[inline]
pub(super) fn chi2_limit<S: Float>(count: u16) -> S {
    let degrees = S::from_f64(f64::from(count.max(3)) - 2.0);
    let variance = S::from_f64(2.0 / 9.0) / degrees;
    let root = S::from_f64(1.0) - variance + S::from_f64(3.09) * variance.sqrt();
    degrees * root * root * root
}
