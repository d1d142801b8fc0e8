//! Covariances that stay positive semi-definite, stored as the factors U D Uᵀ.
//!
//! U is unit upper triangular and D is diagonal. The matrix is therefore symmetric, and positive semi-definite while no
//! entry of D is negative. The observation multiplies entries of D by factors in (0, 1]. The propagation computes them as
//! sums of squares. So rounding cannot change their sign, in `f32` or after any number of steps. [Bierman1977] Ch. V;
//! [Thornton1976].

use crate::scalar::{Float, Scalar};

use super::matrix::Matrix;

/// Symmetric positive semi-definite `N` × `N` matrix, stored as its factors U D Uᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
///
/// ```
/// use surepose::linalg::Covariance;
///
/// let prior = Covariance::<f64, 2>::from_std([0.3, 0.1]);
/// // One observation of the first component with a variance of 0.09.
/// let observation = prior.observed([1.0, 0.0], 0.09);
/// assert!((observation.gain[0] - 0.5).abs() < 1e-12);
/// assert!((observation.covariance.entry(0, 0) - 0.045).abs() < 1e-12);
/// assert!(observation.covariance.is_valid());
/// ```
pub struct Covariance<S, const N: usize> {
    /// Strict upper triangle of U; the other entries are not used.
    upper: [[S; N]; N],
    /// Diagonal of D.
    diagonal: [S; N],
}

/// Rejected matrix: not finite or not positive semi-definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidCovariance;

impl core::fmt::Display for InvalidCovariance {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("invalid covariance: expected a finite, symmetric, positive semi-definite matrix")
    }
}

impl core::error::Error for InvalidCovariance {}

/// Result of one scalar observation: [Tran2012] Eq. (16) and (18) for one row of H.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<S, const N: usize> {
    /// Column K of the Kalman gain.
    pub gain: [S; N],
    /// Innovation variance H P Hᵀ + R.
    pub variance: S,
    /// Covariance after the observation.
    pub covariance: Covariance<S, N>,
}

impl<S: Scalar, const N: usize> Covariance<S, N> {
    /// Creates the covariance of independent errors with the given variances; a negative variance counts as 0.
    #[inline(always)]
    pub fn from_variances(variances: [S; N]) -> Self {
        Self { upper: [[S::from_f64(0.0); N]; N], diagonal: variances.map(|v| v.max(S::from_f64(0.0))) }
    }

    /// Creates the covariance of independent errors with the given standard deviations.
    #[inline(always)]
    pub fn from_std(std: [S; N]) -> Self {
        Self::from_variances(std.map(S::squared))
    }

    /// Multiplies the matrix by `factor` ≥ 0.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self { diagonal: self.diagonal.map(|d| d * factor), ..self }
    }

    /// Returns the entry of the matrix in `row` and `column`.
    #[inline(always)]
    pub fn entry(&self, row: usize, column: usize) -> S {
        let mut sum = S::from_f64(0.0);
        for k in row.max(column)..N {
            sum = sum + self.u(row, k) * self.diagonal[k] * self.u(column, k);
        }
        sum
    }

    /// Returns the full matrix.
    pub fn matrix(&self) -> Matrix<S, N, N> {
        let mut result = Matrix::zeros();
        for row in 0..N {
            for column in 0..N {
                result[(row, column)] = self.entry(row, column);
            }
        }
        result
    }

    /// Returns the standard deviation of component `i`.
    #[inline(always)]
    pub fn std(&self, i: usize) -> S {
        self.entry(i, i).sqrt()
    }

    /// Returns the factors: the strict upper triangle of U and the diagonal of D.
    ///
    /// The other entries of the first array have no meaning. The factors serve to store many covariances in one array.
    #[inline(always)]
    pub fn factors(&self) -> ([[S; N]; N], [S; N]) {
        (self.upper, self.diagonal)
    }

    /// Creates a covariance from the result of [`Covariance::factors`].
    ///
    /// The sign of the entries of `diagonal` is not checked.
    #[inline(always)]
    pub fn from_factors(upper: [[S; N]; N], diagonal: [S; N]) -> Self {
        Self { upper, diagonal }
    }

    /// Computes eᵀ P⁻¹ e, the squared Mahalanobis distance of `error`, without directions of zero variance.
    #[inline(always)]
    pub fn mahalanobis_squared(&self, error: [S; N]) -> S {
        // With e = U y, the result is Σ yᵢ²/dᵢ. Back substitution solves for y.
        let mut y = error;
        let mut sum = S::from_f64(0.0);
        for j in (0..N).rev() {
            for i in 0..j {
                y[i] = y[i] - self.upper[i][j] * y[j];
            }
            sum = sum + y[j].squared().div_or_zero(self.diagonal[j]);
        }
        sum
    }

    /// Computes A P Aᵀ + W diag(`noise`) Wᵀ, [Tran2012] Eq. (12).
    ///
    /// The method is weighted Gram–Schmidt orthogonalization [Thornton1976].
    #[must_use]
    #[inline(always)]
    pub fn propagated<const M: usize>(
        &self,
        a: &Matrix<S, N, N>,
        w: &Matrix<S, N, M>,
        noise: [S; M],
    ) -> Self {
        // The rows of [A U, W] are orthogonalized with the weights (D, noise).
        let mut au = a.0;
        for row in &mut au {
            for column in (0..N).rev() {
                for k in 0..column {
                    row[column] = row[column] + row[k] * self.upper[k][column];
                }
            }
        }
        const { assert!(N <= 4, "a pose has three components, and a gyroscope one bias") };
        let zeros = Self { upper: [[S::from_f64(0.0); N]; N], diagonal: [S::from_f64(0.0); N] };
        let mut rows = Rows { au, w: w.0, weights: self.diagonal, noise, result: zeros };
        // Unrolled by hand: a nested loop would prevent the compiler from vectorizing the outer one.
        if N > 3 {
            rows.make_orthogonal(3);
        }
        if N > 2 {
            rows.make_orthogonal(2);
        }
        if N > 1 {
            rows.make_orthogonal(1);
        }
        if N > 0 {
            rows.make_orthogonal(0);
        }
        rows.result
    }

    /// Applies an observation of `row`·x with noise `variance` > 0: [Tran2012] Eq. (16), (18).
    ///
    /// # Departure
    /// With rounding, Eq. (18) as printed loses symmetry and positive semi-definiteness. The factored form of [Bierman1977]
    /// keeps both.
    #[inline(always)]
    pub fn observed(&self, row: [S; N], variance: S) -> Observation<S, N> {
        let mut result = *self;
        let mut gain = [S::from_f64(0.0); N];
        let mut total = variance;
        for j in 0..N {
            let mut f = row[j];
            for i in 0..j {
                f = f + self.upper[i][j] * row[i];
            }
            let v = self.diagonal[j] * f;
            let before = total;
            total = total + f * v;
            result.diagonal[j] = self.diagonal[j] * (before / total);
            let scale = f / before;
            gain[j] = v;
            for i in 0..j {
                let u = self.upper[i][j];
                result.upper[i][j] = u - gain[i] * scale;
                gain[i] = gain[i] + u * v;
            }
        }
        let share = S::from_f64(1.0) / total;
        for component in &mut gain {
            *component = *component * share;
        }
        Observation { gain, variance: total, covariance: result }
    }

    /// Computes P + `weight` v vᵀ, for a `weight` ≥ 0.
    ///
    /// The entries of D are sums and products of numbers that are not negative. [Agee1972]; [Bierman1977] Ch. III.
    #[must_use]
    #[inline(always)]
    pub fn with_rank_one(&self, vector: [S; N], weight: S) -> Self {
        let mut result = *self;
        let (mut v, mut weight) = (vector, weight);
        for j in (0..N).rev() {
            let weighted = weight * v[j];
            let total = self.diagonal[j] + weighted * v[j];
            let share = S::from_f64(1.0).div_or_zero(total);
            result.diagonal[j] = total;
            let gain = weighted * share;
            for i in 0..j {
                v[i] = v[i] - v[j] * self.upper[i][j];
                result.upper[i][j] = self.upper[i][j] + gain * v[i];
            }
            // A component without variance before and after takes nothing.
            let rest = self.diagonal[j] * share;
            weight = S::select(total.gt(S::from_f64(0.0)), weight * rest, weight);
        }
        result
    }

    /// Returns `yes` where `mask` is true, else `no`.
    #[must_use]
    #[inline(always)]
    pub fn select(mask: S::Mask, yes: &Self, no: &Self) -> Self {
        let mut result = *no;
        for i in 0..N {
            result.diagonal[i] = S::select(mask, yes.diagonal[i], no.diagonal[i]);
            for j in i + 1..N {
                result.upper[i][j] = S::select(mask, yes.upper[i][j], no.upper[i][j]);
            }
        }
        result
    }

    #[inline(always)]
    fn u(&self, row: usize, column: usize) -> S {
        if row == column { S::from_f64(1.0) } else { self.upper[row][column] }
    }
}

impl<S: Float, const N: usize> Covariance<S, N> {
    /// Factors `matrix`; only its upper triangle is used.
    ///
    /// # Errors
    /// [`InvalidCovariance`] if it is not finite or has a negative eigenvalue beyond rounding.
    pub fn from_matrix(matrix: &Matrix<S, N, N>) -> Result<Self, InvalidCovariance> {
        let mut rest = matrix.0;
        let mut result = Self::from_variances([S::from_f64(0.0); N]);
        let scale = (0..N).fold(S::from_f64(0.0), |largest, i| largest.max(rest[i][i]));
        let rounding = scale * S::EPSILON * S::from_f64(16.0);
        for j in (0..N).rev() {
            let d = rest[j][j];
            if !d.is_finite() || d < -rounding {
                return Err(InvalidCovariance);
            }
            result.diagonal[j] = d.max(S::from_f64(0.0));
            for i in 0..j {
                if !rest[i][j].is_finite() || (d <= rounding && rest[i][j].abs() > rounding) {
                    return Err(InvalidCovariance);
                }
                result.upper[i][j] = if d > rounding { rest[i][j] / d } else { S::from_f64(0.0) };
            }
            for i in 0..j {
                for k in i..j {
                    rest[i][k] = rest[i][k] - result.upper[i][j] * d * result.upper[k][j];
                }
            }
        }
        Ok(result)
    }

    /// Returns whether every factor is finite and no entry of D is negative.
    pub fn is_valid(&self) -> bool {
        (0..N).all(|i| {
            self.diagonal[i].is_finite()
                && self.diagonal[i] >= S::from_f64(0.0)
                && (i + 1..N).all(|j| self.upper[i][j].is_finite())
        })
    }
}

/// State of the orthogonalization of the rows of [A U, W] with the weights (D, noise).
struct Rows<S, const N: usize, const M: usize> {
    au: [[S; N]; N],
    w: [[S; M]; N],
    weights: [S; N],
    noise: [S; M],
    result: Covariance<S, N>,
}

impl<S: Scalar, const N: usize, const M: usize> Rows<S, N, M> {
    /// Subtracts the projection on row `j` from the rows above it. The rows below were processed before.
    #[inline(always)]
    fn make_orthogonal(&mut self, j: usize) {
        let Self { au, w, weights, noise, result } = self;
        let mut weighted = [S::from_f64(0.0); N];
        let mut weighted_noise = [S::from_f64(0.0); M];
        let mut sum = S::from_f64(0.0);
        for k in 0..N {
            weighted[k] = au[j][k] * weights[k];
            sum = sum + weighted[k] * au[j][k];
        }
        for k in 0..M {
            weighted_noise[k] = w[j][k] * noise[k];
            sum = sum + weighted_noise[k] * w[j][k];
        }
        result.diagonal[j] = sum;
        let share = S::from_f64(1.0).div_or_zero(sum);
        for i in 0..j {
            let mut dot = S::from_f64(0.0);
            for k in 0..N {
                dot = dot + au[i][k] * weighted[k];
            }
            for k in 0..M {
                dot = dot + w[i][k] * weighted_noise[k];
            }
            let factor = dot * share;
            result.upper[i][j] = factor;
            for k in 0..N {
                au[i][k] = au[i][k] - factor * au[j][k];
            }
            for k in 0..M {
                w[i][k] = w[i][k] - factor * w[j][k];
            }
        }
    }
}
