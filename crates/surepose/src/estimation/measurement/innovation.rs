//! Residual, Jacobian and variance of a measurement, with rows whose noise is independent.

use crate::scalar::Scalar;

/// `M` scalar measurements with independent noise, linearized at a belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation<S, const M: usize> {
    /// ν = z − h(x̂), angles wrapped.
    pub residual: [S; M],
    /// H, the rows of ∂h/∂(x, y, θ).
    pub jacobian: [[S; 3]; M],
    /// The noise variance of each row.
    pub variance: [S; M],
}

impl<S: Scalar> Innovation<S, 2> {
    /// Two rows with correlated noise of this `covariance`, decorrelated.
    ///
    /// With R = L D Lᵀ, the rows L⁻¹ν, L⁻¹H have the diagonal noise D and carry the same information.
    #[inline(always)]
    pub fn with_correlated_pair(
        residual: [S; 2],
        jacobian: [[S; 3]; 2],
        variance: [S; 2],
        covariance: S,
    ) -> Self {
        let share = covariance / variance[0];
        let mut second = jacobian[1];
        for (entry, first) in second.iter_mut().zip(&jacobian[0]) {
            *entry = *entry - share * *first;
        }
        Self {
            residual: [residual[0], residual[1] - share * residual[0]],
            jacobian: [jacobian[0], second],
            variance: [variance[0], variance[1] - share * covariance],
        }
    }
}
