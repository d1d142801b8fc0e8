//! Normal equations of weighted least squares for a pose step (dx, dy, dθ).

use crate::estimation::PoseMeasurement;
use crate::geometry::{Body, Map, Pose};
use crate::linalg::{InvalidCovariance, Matrix};
use crate::scalar::Float;

/// Σ w·jᵀj and Σ w·jᵀe over beams: the information on the pose, and the information times the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseNormalEquations<S> {
    information: Matrix<S, 3, 3>,
    gradient: [S; 3],
}

impl<S: Float> PoseNormalEquations<S> {
    pub(crate) fn new() -> Self {
        Self { information: Matrix::zeros(), gradient: [S::from_f64(0.0); 3] }
    }

    /// Adds a beam whose residual e of variance 1/`weight` changes by `row` with the pose.
    #[inline]
    pub(super) fn add(&mut self, row: [S; 3], residual: S, weight: S) {
        for i in 0..3 {
            let weighted = weight * row[i];
            for k in 0..3 {
                self.information[(i, k)] = self.information[(i, k)] + weighted * row[k];
            }
            self.gradient[i] = self.gradient[i] + weighted * residual;
        }
    }

    /// Pose measurement from the sums, whose steps are relative to `near`.
    ///
    /// # Errors
    /// [`InvalidCovariance`] for values that are not finite.
    pub(crate) fn solve(&self, near: Pose<Map, Body, S>) -> Result<PoseMeasurement<S>, InvalidCovariance> {
        PoseMeasurement::from_information(near, self.information, self.gradient)
    }
}
