//! What beams say of a line: the normal equations of weighted least squares in (a, b).

use crate::scalar::Float;

use super::beam::Beam;
use super::ray_line::RayLine;

/// Sums over beams: Σ w·g·gᵀ and Σ w·g·v with g = (cos φ, sin φ), weights w, values v.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Evidence<S> {
    cc: S,
    cs: S,
    ss: S,
    c: S,
    s: S,
    /// How many beams.
    pub count: u16,
    /// Σ of their squared normalised residuals.
    pub misfit: S,
}

/// The variances of an (a, b) that was estimated.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread<S> {
    pub aa: S,
    pub ab: S,
    pub bb: S,
}

impl<S: Float> Evidence<S> {
    #[inline]
    pub(super) fn add(&mut self, beam: &Beam<S>, weight: S, value: S) {
        let (wc, ws) = (weight * beam.cos, weight * beam.sin);
        self.cc = self.cc + wc * beam.cos;
        self.cs = self.cs + wc * beam.sin;
        self.ss = self.ss + ws * beam.sin;
        self.c = self.c + wc * value;
        self.s = self.s + ws * value;
    }

    /// Both together.
    #[must_use]
    pub(super) fn with(&self, other: &Self) -> Self {
        Self {
            cc: self.cc + other.cc,
            cs: self.cs + other.cs,
            ss: self.ss + other.ss,
            c: self.c + other.c,
            s: self.s + other.s,
            count: self.count + other.count,
            misfit: self.misfit + other.misfit,
        }
    }

    /// The (a, b) of least squares and its covariance, the inverse of the normal matrix.
    #[inline]
    pub(super) fn solve(&self) -> (RayLine<S>, Spread<S>) {
        let scale = S::of(1.0) / (self.cc * self.ss - self.cs.squared());
        let spread = Spread { aa: self.ss * scale, ab: -self.cs * scale, bb: self.cc * scale };
        let line = RayLine {
            a: spread.aa * self.c + spread.ab * self.s,
            b: spread.ab * self.c + spread.bb * self.s,
        };
        (line, spread)
    }

    /// How much the step that [`Evidence::solve`] gives takes off the misfit, where the values are residuals: its
    /// squared length in standard deviations.
    #[inline]
    pub(super) fn gain_of(&self, step: RayLine<S>) -> S {
        step.a * self.c + step.b * self.s
    }
}

impl<S: Float> Spread<S> {
    /// The variance of u at the bearing of `beam`.
    #[inline]
    pub(super) fn at(&self, beam: &Beam<S>) -> S {
        self.aa * beam.cos.squared()
            + S::of(2.0) * self.ab * beam.cos * beam.sin
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
    pub(super) fn mahalanobis_squared(&self, e: RayLine<S>) -> S {
        let determinant = self.aa * self.bb - self.ab.squared();
        (self.bb * e.a.squared() - S::of(2.0) * self.ab * e.a * e.b + self.aa * e.b.squared()) / determinant
    }
}

/// The misfit that `count` beams of one straight line exceed once in 1000 times.
///
/// [WilsonHilferty1931]: (χ²/n)^⅓ is nearly normal with mean 1 − 2/(9n) and variance 2/(9n).
#[inline]
pub(super) fn misfit_limit<S: Float>(count: u16) -> S {
    let degrees = S::of(f64::from(count.max(3)) - 2.0);
    let variance = S::of(2.0 / 9.0) / degrees;
    let root = S::of(1.0) - variance + S::of(3.09) * variance.sqrt();
    degrees * root * root * root
}
