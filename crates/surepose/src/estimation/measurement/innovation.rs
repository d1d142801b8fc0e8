//! Residual, Jacobian and variance of a measurement, with rows whose noise is independent.

use crate::linalg::Covariance;
use crate::scalar::{Mask, Scalar};

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

/// Step of the state and covariance after a gated measurement; zero and the prior where it was rejected.
pub(in crate::estimation) struct GatedUpdate<S: Scalar, const N: usize> {
    pub(in crate::estimation) step: [S; N],
    pub(in crate::estimation) covariance: Covariance<S, N>,
    pub(in crate::estimation) nis: S,
    pub(in crate::estimation) accepted: S::Mask,
}

impl<S: Scalar, const M: usize> Innovation<S, M> {
    /// Updates a state of `N` ≥ 3 components that ends with the pose, inside the gate `nis < threshold`: [Tran2012] Eq.
    /// (16)–(18), row by row.
    ///
    /// The rows carry independent noise, so sequential updates equal the joint update. The sum of their squared normalized
    /// residuals is the joint νᵀS⁻¹ν, and no matrix is inverted.
    #[inline(always)]
    pub(in crate::estimation) fn update<const N: usize>(
        &self,
        prior: &Covariance<S, N>,
        threshold: S,
    ) -> GatedUpdate<S, N> {
        const { assert!(N >= 3, "the state ends with the pose") };
        let zero = S::from_f64(0.0);
        let mut step = [zero; N];
        let mut covariance = *prior;
        let mut nis = zero;
        let mut max_variance = zero;
        for m in 0..M {
            let mut row = [zero; N];
            for i in 0..3 {
                row[N - 3 + i] = self.jacobian[m][i];
            }
            let seen = covariance.observed(row, self.variance[m]);
            let mut predicted = row[0] * step[0];
            for i in 1..N {
                predicted = predicted + row[i] * step[i];
            }
            let residual = self.residual[m] - predicted;
            nis = nis + residual.squared() / seen.variance;
            max_variance = max_variance.max(seen.variance);
            for (component, gain) in step.iter_mut().zip(&seen.gain) {
                *component = *component + *gain * residual;
            }
            covariance = seen.covariance;
        }
        // A NaN compares false and is rejected. A row that overflows is rejected as well: its variance would be
        // infinite.
        let accepted = nis.lt(threshold).and(max_variance.lt(S::from_f64(f64::INFINITY)));
        GatedUpdate {
            step: step.map(|value| S::select(accepted, value, zero)),
            covariance: Covariance::select(accepted, &covariance, prior),
            nis,
            accepted,
        }
    }
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
