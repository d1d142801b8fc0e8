//! A pose that something else found, with directions it may know nothing of.

use crate::covariance::NotACovariance;
use crate::frame::{Body, Map};
use crate::matrix::Matrix;
use crate::pose::Pose;
use crate::scalar::{Float, Scalar};

use super::Innovation;
use crate::estimate::ekf::Belief;

/// A pose, and how much is known of it in each direction.
///
/// The inverse of a covariance, the *information*, can say "nothing": in a corridor a scan knows the way across and the
/// heading, but not the way along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseFix<S> {
    /// The pose; where nothing is known of a direction it may be anything in that direction.
    pub pose: Pose<Map, Body, S>,
    /// The information on (x, y, θ) in the map frame \[1/m², 1/(m·rad), 1/rad²]: symmetric, positive semi-definite.
    pub information: Matrix<S, 3, 3>,
}

/// Information that stands for none where a division needs one: a variance of 1e12.
const NOTHING: f64 = 1e-12;

/// Least information that is any \[1/m², 1/rad²]: a direction known worse than to a kilometre is not known.
///
/// Walls that run along an axis leave 1e-30 of it, by rounding; a step of rounding over that would leave the map.
const LEAST: f64 = 1e-6;

/// So much of an entry of its diagonal is the rounding of what an information was made of.
const ROUNDING: f64 = 1e-6;

impl<S: Scalar> PoseFix<S> {
    /// ν = Lᵀ(z − x̂), where the information is L D Lᵀ: rows with the independent variances 1/D.
    #[inline]
    pub fn innovation(&self, belief: &Belief<S>) -> Innovation<S, 3> {
        let (zero, one) = (S::of(0.0), S::of(1.0));
        let offset = [
            self.pose.x - belief.pose.x,
            self.pose.y - belief.pose.y,
            (self.pose.heading - belief.pose.heading).radians(),
        ];
        let Factors { lower, diagonal, .. } = Factors::of(&self.information, S::of(ROUNDING));
        let mut jacobian = [[zero; 3]; 3];
        let mut residual = [zero; 3];
        let mut variance = [zero; 3];
        for row in 0..3 {
            jacobian[row][row] = one;
            residual[row] = offset[row];
            for k in row + 1..3 {
                jacobian[row][k] = lower[k][row];
                residual[row] = residual[row] + lower[k][row] * offset[k];
            }
            variance[row] = one / diagonal[row].max(S::of(NOTHING));
        }
        Innovation { residual, jacobian, variance }
    }

    /// The same pose, where an error of these variances of x, y \[m²] and θ \[rad²] is added that all that was seen
    /// shares: the time of a scan, or how the robot leaned.
    ///
    /// (Λ⁻¹ + σ²eeᵀ)⁻¹ = Λ − Λe·eᵀΛ/(σ⁻² + eᵀΛe) for each axis e: [ShermanMorrison1950], which needs no Λ⁻¹. On the axis
    /// itself that is Λe/(1 + σ²eᵀΛe), without a difference of large numbers.
    #[must_use]
    pub fn blurred(mut self, variances: [S; 3]) -> Self {
        for (axis, variance) in variances.into_iter().enumerate() {
            let column = [0, 1, 2].map(|row| self.information[(row, axis)]);
            let left = S::of(1.0) / (S::of(1.0) + variance * column[axis]);
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for (row, k) in [(next, next), (next, last), (last, last)] {
                let taken = variance * left * column[row] * column[k];
                self.put(row, k, self.information[(row, k)] - taken);
            }
            for row in 0..3 {
                self.put(row, axis, column[row] * left);
            }
        }
        self
    }

    /// Puts an entry of the information, on either side of the diagonal.
    fn put(&mut self, row: usize, column: usize, entry: S) {
        self.information[(row, column)] = entry;
        self.information[(column, row)] = entry;
    }
}

impl<S: Float> PoseFix<S> {
    /// The fix at which an information and its gradient add up to nothing more: Λ·(z − `near`) = `gradient`.
    ///
    /// In directions without information the pose stays that of `near`.
    ///
    /// # Errors
    /// [`NotACovariance`] where the information of an axis is negative, or anything is not finite.
    pub fn from_information(
        near: Pose<Map, Body, S>,
        information: Matrix<S, 3, 3>,
        gradient: [S; 3],
    ) -> Result<Self, NotACovariance> {
        let Factors { lower, diagonal, .. } = Factors::of(&information, S::of(ROUNDING));
        let sound = |i: usize| information[(i, i)].is_finite() && information[(i, i)] >= S::of(0.0);
        if !(0..3).all(sound) || !gradient.iter().all(|g| g.is_finite()) {
            return Err(NotACovariance);
        }
        let mut step = gradient;
        for row in 0..3 {
            for k in 0..row {
                step[row] = step[row] - lower[row][k] * step[k];
            }
        }
        for row in (0..3).rev() {
            step[row] = step[row].over_positive(diagonal[row]);
            for k in row + 1..3 {
                step[row] = step[row] - lower[k][row] * step[k];
            }
        }
        if !step.iter().all(|s| s.is_finite()) {
            return Err(NotACovariance);
        }
        let pose = Pose::new(near.x + step[0], near.y + step[1], near.heading.turned(step[2]));
        Ok(Self { pose, information })
    }

    /// Whether the information is one: finite, symmetric, and positive semi-definite as far as rounding tells.
    ///
    /// Where walls show nothing along them what is left along them is the rounding of what they show across, and of what was
    /// [taken from it](PoseFix::blurred), which may have been some ten thousand times as much.
    pub(super) fn is_informed(&self) -> bool {
        let slack = S::of(ROUNDING).max(S::EPSILON * S::of(32768.0));
        let matrix = &self.information;
        let size = |i: usize| matrix[(i, i)].abs().max(S::of(LEAST)).sqrt();
        let agrees =
            |i: usize, j: usize| (matrix[(i, j)] - matrix[(j, i)]).abs() <= slack * size(i) * size(j);
        let Factors { diagonal, nothing, left, .. } = Factors::of(matrix, slack);
        (0..3).all(|j| {
            let is_pivot = left[j][j] >= -nothing[j] && left[j][j].is_finite();
            // Next to nothing there is nothing: Λᵢⱼ² ≤ Λᵢᵢ·Λⱼⱼ.
            let most = |i: usize| S::of(2.0) * nothing[j].sqrt() * size(i);
            let is_alone = diagonal[j] > S::of(0.0) || (j + 1..3).all(|i| left[i][j].abs() <= most(i));
            // A NaN compares false.
            is_pivot && is_alone && (0..3).all(|i| agrees(i, j))
        })
    }
}

/// A symmetric positive semi-definite matrix as L D Lᵀ.
struct Factors<S> {
    /// L, unit lower triangular.
    lower: [[S; 3]; 3],
    /// D.
    diagonal: [S; 3],
    /// What a pivot must be more than: less is rounding only, or less than [`LEAST`], and 0 in D, and with it its column of L.
    nothing: [S; 3],
    /// In the lower triangle, what was left of each column when its turn came.
    left: [[S; 3]; 3],
}

impl<S: Scalar> Factors<S> {
    /// Those of `matrix`, where `rounding` of an entry of its diagonal is nothing.
    fn of(matrix: &Matrix<S, 3, 3>, rounding: S) -> Self {
        let zero = S::of(0.0);
        let mut left = matrix.0;
        let mut lower = [[zero; 3]; 3];
        let (mut diagonal, mut nothing) = ([zero; 3], [zero; 3]);
        for j in 0..3 {
            nothing[j] = (matrix.0[j][j].abs() * rounding).max(S::of(LEAST));
            let pivot = S::select(left[j][j].gt(nothing[j]), left[j][j], zero);
            diagonal[j] = pivot;
            for i in j + 1..3 {
                lower[i][j] = left[i][j].over_positive(pivot);
            }
            for i in j + 1..3 {
                for k in j + 1..3 {
                    left[i][k] = left[i][k] - lower[i][j] * left[j][k];
                }
            }
        }
        Self { lower, diagonal, nothing, left }
    }
}
