//! Pose measurements, possibly without information in some directions.

use crate::estimation::ekf::Belief;
use crate::geometry::{Body, Map, Pose};
use crate::linalg::{InvalidCovariance, Matrix};
use crate::scalar::{Float, Scalar};

use super::Innovation;

/// A pose with its information matrix.
///
/// The *information*, the inverse of a covariance, may be 0. In a corridor, for example, a scan gives the lateral
/// position and the heading, but not the position along the corridor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMeasurement<S> {
    /// Measured pose; arbitrary in directions without information.
    pub pose: Pose<Map, Body, S>,
    /// Information on (x, y, θ) in the map frame \[1/m², 1/(m·rad), 1/rad²]: symmetric, positive semi-definite.
    pub information: Matrix<S, 3, 3>,
}

/// Lower bound of the information in divisions: a variance of 1e12.
const INFORMATION_FLOOR: f64 = 1e-12;

/// Minimum information \[1/m², 1/rad²]. A direction with a standard deviation above a kilometer counts as unknown.
///
/// Walls along an axis leave 1e-30 along it by rounding. A step of rounding error over that would leave the map.
const MIN_INFORMATION: f64 = 1e-6;

/// Rounding error of a diagonal entry, as a fraction of the information from which it was computed.
const ROUNDING_TOLERANCE: f64 = 1e-6;

impl<S: Scalar> PoseMeasurement<S> {
    /// ν = Lᵀ(z − x̂), where the information is L D Lᵀ: rows with the independent variances 1/D.
    #[inline]
    pub fn innovation(&self, belief: &Belief<S>) -> Innovation<S, 3> {
        let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
        let offset = [
            self.pose.x - belief.pose.x,
            self.pose.y - belief.pose.y,
            (self.pose.heading - belief.pose.heading).radians(),
        ];
        let LdlFactors { lower, diagonal, .. } =
            LdlFactors::from_matrix(&self.information, S::from_f64(ROUNDING_TOLERANCE));
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
            variance[row] = one / diagonal[row].max(S::from_f64(INFORMATION_FLOOR));
        }
        Innovation { residual, jacobian, variance }
    }

    /// Adds an error common to all data of the measurement, with these variances of x, y \[m²] and θ \[rad²]. Examples
    /// are an error of the scan time and a tilt of the robot.
    ///
    /// (Λ⁻¹ + σ²eeᵀ)⁻¹ = Λ − Λe·eᵀΛ/(σ⁻² + eᵀΛe) for each axis e: [ShermanMorrison1950], which needs no Λ⁻¹. On the
    /// axis itself the result is Λe/(1 + σ²eᵀΛe), without a difference of large numbers.
    #[must_use]
    pub fn inflated(mut self, variances: [S; 3]) -> Self {
        for (axis, variance) in variances.into_iter().enumerate() {
            let column = [0, 1, 2].map(|row| self.information[(row, axis)]);
            let factor = S::from_f64(1.0) / (S::from_f64(1.0) + variance * column[axis]);
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for (row, k) in [(next, next), (next, last), (last, last)] {
                let taken = variance * factor * column[row] * column[k];
                self.set_symmetric(row, k, self.information[(row, k)] - taken);
            }
            for row in 0..3 {
                self.set_symmetric(row, axis, column[row] * factor);
            }
        }
        self
    }

    /// Sets an entry of the information and its mirror image.
    fn set_symmetric(&mut self, row: usize, column: usize, entry: S) {
        self.information[(row, column)] = entry;
        self.information[(column, row)] = entry;
    }
}

impl<S: Float> PoseMeasurement<S> {
    /// Measurement from an information and its gradient at `near`: Λ·(z − `near`) = `gradient`.
    ///
    /// In directions without information the pose remains that of `near`.
    ///
    /// # Errors
    /// [`InvalidCovariance`] where the information of an axis is negative, or a value is not finite.
    pub fn from_information(
        near: Pose<Map, Body, S>,
        information: Matrix<S, 3, 3>,
        gradient: [S; 3],
    ) -> Result<Self, InvalidCovariance> {
        let LdlFactors { lower, diagonal, .. } =
            LdlFactors::from_matrix(&information, S::from_f64(ROUNDING_TOLERANCE));
        let sound = |i: usize| information[(i, i)].is_finite() && information[(i, i)] >= S::from_f64(0.0);
        if !(0..3).all(sound) || !gradient.iter().all(|g| g.is_finite()) {
            return Err(InvalidCovariance);
        }
        let mut step = gradient;
        for row in 0..3 {
            for k in 0..row {
                step[row] = step[row] - lower[row][k] * step[k];
            }
        }
        for row in (0..3).rev() {
            step[row] = step[row].div_or_zero(diagonal[row]);
            for k in row + 1..3 {
                step[row] = step[row] - lower[k][row] * step[k];
            }
        }
        if !step.iter().all(|s| s.is_finite()) {
            return Err(InvalidCovariance);
        }
        let pose = Pose::new(near.x + step[0], near.y + step[1], near.heading.rotated_by(step[2]));
        Ok(Self { pose, information })
    }

    /// Whether the information is finite, symmetric, and positive semi-definite up to rounding.
    ///
    /// In a direction without information, the rounding error of the other directions and of the
    /// [inflation](PoseMeasurement::inflated) remains. The inflation may have reduced the entries by a factor of 10⁴.
    pub(super) fn is_valid(&self) -> bool {
        let slack = S::from_f64(ROUNDING_TOLERANCE).max(S::EPSILON * S::from_f64(32768.0));
        let matrix = &self.information;
        let size = |i: usize| matrix[(i, i)].abs().max(S::from_f64(MIN_INFORMATION)).sqrt();
        let agrees =
            |i: usize, j: usize| (matrix[(i, j)] - matrix[(j, i)]).abs() <= slack * size(i) * size(j);
        let LdlFactors { diagonal, pivot_threshold, remainder, .. } = LdlFactors::from_matrix(matrix, slack);
        (0..3).all(|j| {
            let is_pivot = remainder[j][j] >= -pivot_threshold[j] && remainder[j][j].is_finite();
            // Beside a zero pivot all entries are zero: Λᵢⱼ² ≤ Λᵢᵢ·Λⱼⱼ.
            let most = |i: usize| S::from_f64(2.0) * pivot_threshold[j].sqrt() * size(i);
            let is_alone =
                diagonal[j] > S::from_f64(0.0) || (j + 1..3).all(|i| remainder[i][j].abs() <= most(i));
            // A NaN compares false.
            is_pivot && is_alone && (0..3).all(|i| agrees(i, j))
        })
    }
}

/// Factors L D Lᵀ of a symmetric positive semi-definite matrix.
struct LdlFactors<S> {
    /// L, unit lower triangular.
    lower: [[S; 3]; 3],
    /// D.
    diagonal: [S; 3],
    /// Threshold of a pivot. A smaller one is rounding, or less than [`MIN_INFORMATION`]; it is 0 in D, and so is its
    /// column of L.
    pivot_threshold: [S; 3],
    /// Lower triangle: the remainder of each column before its elimination.
    remainder: [[S; 3]; 3],
}

impl<S: Scalar> LdlFactors<S> {
    /// Factorizes `matrix`; `rounding` is the relative error of its diagonal entries.
    fn from_matrix(matrix: &Matrix<S, 3, 3>, rounding: S) -> Self {
        let zero = S::from_f64(0.0);
        let mut remainder = matrix.0;
        let mut lower = [[zero; 3]; 3];
        let (mut diagonal, mut pivot_threshold) = ([zero; 3], [zero; 3]);
        for j in 0..3 {
            pivot_threshold[j] = (matrix.0[j][j].abs() * rounding).max(S::from_f64(MIN_INFORMATION));
            let pivot = S::select(remainder[j][j].gt(pivot_threshold[j]), remainder[j][j], zero);
            diagonal[j] = pivot;
            for i in j + 1..3 {
                lower[i][j] = remainder[i][j].div_or_zero(pivot);
            }
            for i in j + 1..3 {
                for k in j + 1..3 {
                    remainder[i][k] = remainder[i][k] - lower[i][j] * remainder[j][k];
                }
            }
        }
        Self { lower, diagonal, pivot_threshold, remainder }
    }
}
