//! Lines a·x + b·y = 1, in which the inverse range of a beam is linear.

use crate::scalar::Float;

use super::beam::Beam;

/// The line a·x + b·y = 1 in the laser frame, (a, b) = (cos ψ, sin ψ)/r.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct InverseRangeLine<S> {
    pub a: S,
    pub b: S,
}

impl<S: Float> InverseRangeLine<S> {
    /// Line through the ends of two beams of different bearing.
    #[inline]
    pub(super) fn through(p: &Beam<S>, q: &Beam<S>) -> Self {
        let scale = S::from_f64(1.0) / (p.cos * q.sin - p.sin * q.cos);
        Self {
            a: (p.inverse * q.sin - q.inverse * p.sin) * scale,
            b: (q.inverse * p.cos - p.inverse * q.cos) * scale,
        }
    }

    /// Inverse range u = a·cos φ + b·sin φ at the bearing φ of a beam, and its slope ∂u/∂φ.
    #[inline]
    pub(super) fn at(&self, beam: &Beam<S>) -> (S, S) {
        (self.a * beam.cos + self.b * beam.sin, self.b * beam.cos - self.a * beam.sin)
    }

    /// `self` − `other`: its u is the difference of the two, and is zero where the lines meet.
    #[inline]
    pub(super) fn minus(self, other: Self) -> Self {
        Self { a: self.a - other.a, b: self.b - other.b }
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b }
    }

    /// Position on the line where a beam at φ meets it: distance from the foot of the perpendicular, positive left
    /// \[m].
    #[inline]
    pub(super) fn along(&self, beam: &Beam<S>) -> S {
        let (u, slope) = self.at(beam);
        -slope / (u * (self.a.squared() + self.b.squared()).sqrt())
    }
}
