//! Residual of the beams on one wall, and its information on the pose.

use crate::estimation::Belief;
use crate::lidar::scan::RangeFinder;
use crate::linalg::{Covariance, Matrix};
use crate::map::Wall;
use crate::scalar::Float;

use super::map_beam::MapBeam;

/// Deviation of the beams from a wall of the map: offset at a point of the wall, and slope along it.
///
/// With the residual e = n·Y − r of a beam that ends at Y, a = t·Y − a₀ along the wall, e ≈ o + s·a. A pose error
/// (dx, dy, dθ) changes o by n·(dx, dy) − b·dθ and s by −dθ. Here b is the distance along the wall from the robot to
/// the point a₀.
#[derive(Clone, Copy, Debug)]
pub(super) struct WallResidual<S> {
    normal: (S, S),
    /// b \[m].
    lever: S,
    /// o \[m], s \[rad].
    offset: S,
    slope: S,
    /// Variances and covariance of o and s.
    oo: S,
    os: S,
    ss: S,
    pub beams: u16,
}

impl<S: Float> WallResidual<S> {
    /// Residual of the `associated` beams at `wall`; `None` where these are too few, or do not fix a line.
    ///
    /// The weight of a beam falls with its distance, 1/(1 + (e/c)²)² of [GemanMcClure1987], where c is a third of its
    /// gate. The variance is inflated where the beams scatter by more than the noise of the laser.
    pub(super) fn from_beams<'a>(
        laser: &RangeFinder<S>,
        estimate: &Belief<S>,
        wall: &Wall<S>,
        associated: impl Iterator<Item = &'a MapBeam<S>> + Clone,
        min_beams: u16,
    ) -> Option<Self> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let (nx, ny) = wall.line().normal();
        let along = |x: S, y: S| nx * y - ny * x;
        let (mut count, mut sum) = (0_u16, zero);
        for beam in associated.clone() {
            count += 1;
            sum = sum + along(beam.end.0, beam.end.1);
        }
        if count < min_beams.max(2) {
            return None;
        }
        let middle = sum / S::from_f64(f64::from(count));
        // Σw, Σwa, Σwa², Σwe, Σwae, Σwe².
        let mut sums = [zero; 6];
        for beam in associated {
            let a = along(beam.end.0, beam.end.1) - middle;
            let e = nx * beam.end.0 + ny * beam.end.1 - wall.line().distance;
            let head_on = (beam.direction.0 * nx + beam.direction.1 * ny).squared();
            let variance = laser.range_std.squared() * head_on
                + (beam.range * laser.bearing_std).squared() * (one - head_on);
            let variance = variance.max(S::from_f64(MIN_STD * MIN_STD));
            let scale = (beam.gate * S::from_f64(1.0 / 3.0)).squared().max(variance);
            let weight = one / ((one + e.squared() / scale).squared() * variance);
            let terms = [weight, weight * a, weight * a * a, weight * e, weight * a * e, weight * e * e];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum = *sum + term;
            }
        }
        let [w, wa, waa, we, wae, wee] = sums;
        let determinant = w * waa - wa.squared();
        if !determinant.is_finite() || determinant <= w * waa * S::from_f64(1e-9) {
            return None;
        }
        let scale = one / determinant;
        let (offset, slope) = ((waa * we - wa * wae) * scale, (w * wae - wa * we) * scale);
        let reduced_chi2 = (wee - offset * we - slope * wae) / S::from_f64(f64::from(count.max(3)) - 2.0);
        let variance_scale = scale * reduced_chi2.max(one);
        let robot = along(estimate.pose.x, estimate.pose.y);
        let [rr, r_psi, psi_psi] = wall.covariance();
        Some(Self {
            normal: (nx, ny),
            lever: middle - robot,
            offset,
            slope,
            // Uncertainty of the wall itself, propagated from the foot of the map origin to this point of the wall.
            oo: waa * variance_scale + rr - S::from_f64(2.0) * middle * r_psi + middle.squared() * psi_psi,
            os: -(wa * variance_scale) - r_psi + middle * psi_psi,
            ss: w * variance_scale + psi_psi,
            beams: count,
        })
    }

    /// Adds variance to the position \[m²] and the direction \[rad²] of the wall.
    pub(super) fn with_added_variance(self, offset: S, direction: S) -> Self {
        Self { oo: self.oo + offset, ss: self.ss + direction, ..self }
    }

    fn jacobian(&self) -> [[S; 3]; 2] {
        [[self.normal.0, self.normal.1, -self.lever], [S::from_f64(0.0), S::from_f64(0.0), -S::from_f64(1.0)]]
    }

    /// Normalized innovation squared of this association: (o, s) (H P Hᵀ + R)⁻¹ (o, s)ᵀ.
    pub(super) fn nis(&self, covariance: &Covariance<S, 3>) -> S {
        let h = self.jacobian();
        let spread = |u: &[S; 3], v: &[S; 3]| {
            let mut sum = S::from_f64(0.0);
            for i in 0..3 {
                for j in 0..3 {
                    sum = sum + u[i] * covariance.entry(i, j) * v[j];
                }
            }
            sum
        };
        let (oo, os, ss) =
            (self.oo + spread(&h[0], &h[0]), self.os + spread(&h[0], &h[1]), self.ss + spread(&h[1], &h[1]));
        let squared = ss * self.offset.squared() - S::from_f64(2.0) * os * self.offset * self.slope
            + oo * self.slope.squared();
        squared / (oo * ss - os.squared())
    }

    /// HᵀR⁻¹H and −HᵀR⁻¹(o, s): the information on the pose, and the information times the step.
    pub(super) fn normal_equations(&self) -> (Matrix<S, 3, 3>, [S; 3]) {
        let h = self.jacobian();
        let scale = S::from_f64(1.0) / (self.oo * self.ss - self.os.squared());
        let inverse = [[self.ss * scale, -self.os * scale], [-self.os * scale, self.oo * scale]];
        let weighted = |k: usize, column: usize| inverse[k][0] * h[0][column] + inverse[k][1] * h[1][column];
        let mut information = Matrix::zeros();
        let mut gradient = [S::from_f64(0.0); 3];
        for row in 0..3 {
            for column in 0..3 {
                information[(row, column)] =
                    h[0][row] * weighted(0, column) + h[1][row] * weighted(1, column);
            }
            gradient[row] = -(weighted(0, row) * self.offset + weighted(1, row) * self.slope);
        }
        (information, gradient)
    }
}

/// Minimum standard deviation of a beam from its wall \[m].
const MIN_STD: f64 = 0.01;
