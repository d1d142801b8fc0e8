//! Covariances that cannot lose their sign: stored as the factors U D Uᵀ.
//!
//! U is unit upper triangular and D diagonal, so the matrix is symmetric by construction and positive
//! semi-definite as long as no entry of D turns negative. Both updates below only ever *shrink* an entry of D by a
//! factor in (0, 1] or rebuild it as a sum of squares: rounding cannot change its sign, in `f32` either, and after
//! any number of steps. [Bierman1977] Ch. V; [Thornton1976].

use crate::scalar::{Float, Scalar};

use super::matrix::Matrix;

/// A symmetric positive semi-definite `N` × `N` matrix, as its factors U D Uᵀ.
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
    /// The strict upper triangle of U; the rest of the square is not read.
    upper: [[S; N]; N],
    /// The diagonal of D.
    diagonal: [S; N],
}

/// The matrix is not symmetric positive semi-definite, or not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidCovariance;

impl core::fmt::Display for InvalidCovariance {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the matrix is not a covariance: it must be finite, symmetric and positive semi-definite")
    }
}

impl core::error::Error for InvalidCovariance {}

/// What one scalar observation does: [Tran2012] Eq. (16) and (18) for a single row of H.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<S, const N: usize> {
    /// The column K of the Kalman gain.
    pub gain: [S; N],
    /// The innovation variance H P Hᵀ + R.
    pub variance: S,
    /// The covariance after the observation.
    pub covariance: Covariance<S, N>,
}

impl<S: Scalar, const N: usize> Covariance<S, N> {
    /// Independent errors with these variances, none of them negative.
    #[inline(always)]
    pub fn from_variances(variances: [S; N]) -> Self {
        Self { upper: [[S::from_f64(0.0); N]; N], diagonal: variances.map(|v| v.max(S::from_f64(0.0))) }
    }

    /// Independent errors with these standard deviations.
    #[inline(always)]
    pub fn from_std(std: [S; N]) -> Self {
        Self::from_variances(std.map(S::squared))
    }

    /// The matrix times `factor`, which is not negative.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self { diagonal: self.diagonal.map(|d| d * factor), ..self }
    }

    /// The entry in `row` and `column` of the matrix itself.
    #[inline(always)]
    pub fn entry(&self, row: usize, column: usize) -> S {
        let mut sum = S::from_f64(0.0);
        for k in row.max(column)..N {
            sum = sum + self.u(row, k) * self.diagonal[k] * self.u(column, k);
        }
        sum
    }

    /// The matrix itself.
    pub fn matrix(&self) -> Matrix<S, N, N> {
        let mut result = Matrix::zeros();
        for row in 0..N {
            for column in 0..N {
                result[(row, column)] = self.entry(row, column);
            }
        }
        result
    }

    /// The standard deviation of component `i`.
    #[inline(always)]
    pub fn std(&self, i: usize) -> S {
        self.entry(i, i).sqrt()
    }

    /// The strict upper triangle of U, the rest of whose square means nothing, and the diagonal of D: for keeping many
    /// covariances side by side.
    #[inline(always)]
    pub fn factors(&self) -> ([[S; N]; N], [S; N]) {
        (self.upper, self.diagonal)
    }

    /// The covariance of `upper` and `diagonal` that [`Covariance::factors`] gave.
    ///
    /// Nothing checks that no entry of `diagonal` is negative.
    #[inline(always)]
    pub fn from_factors(upper: [[S; N]; N], diagonal: [S; N]) -> Self {
        Self { upper, diagonal }
    }

    /// eᵀ P⁻¹ e, the squared Mahalanobis length of `error`; directions without variance do not count.
    #[inline(always)]
    pub fn mahalanobis_squared(&self, error: [S; N]) -> S {
        // With e = U y, the length is Σ yᵢ²/dᵢ; U is solved from the last row up.
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

    /// A P Aᵀ + W diag(`noise`) Wᵀ, [Tran2012] Eq. (12), by weighted Gram–Schmidt: [Thornton1976].
    #[must_use]
    #[inline(always)]
    pub fn propagated<const M: usize>(
        &self,
        a: &Matrix<S, N, N>,
        w: &Matrix<S, N, M>,
        noise: [S; M],
    ) -> Self {
        // The rows of [A U, W] are made orthogonal under the weights (D, noise).
        let mut au = a.0;
        for row in &mut au {
            for column in (0..N).rev() {
                for k in 0..column {
                    row[column] = row[column] + row[k] * self.upper[k][column];
                }
            }
        }
        const { assert!(N <= 3, "a pose has three components") };
        let zeros = Self { upper: [[S::from_f64(0.0); N]; N], diagonal: [S::from_f64(0.0); N] };
        let mut rows = Rows { au, w: w.0, weights: self.diagonal, noise, result: zeros };
        // Written out: a loop that is left inside another keeps the compiler from making vectors of the outer one.
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

    /// Observes `row`·x with noise `variance` > 0: [Tran2012] Eq. (16), (18), in the factored form of [Bierman1977].
    ///
    /// # Departure
    /// (18) as printed loses symmetry and sign to rounding; this form cannot.
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

    /// `yes` where `mask` is true, else `no`.
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
    /// The factors of `matrix`, of which only the upper triangle is read.
    ///
    /// # Errors
    /// [`InvalidCovariance`] where it is not finite or has a negative eigenvalue beyond rounding.
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

    /// Every factor is finite and no entry of D is negative.
    pub fn is_valid(&self) -> bool {
        (0..N).all(|i| {
            self.diagonal[i].is_finite()
                && self.diagonal[i] >= S::from_f64(0.0)
                && (i + 1..N).all(|j| self.upper[i][j].is_finite())
        })
    }
}

/// The rows of [A U, W] on their way to being orthogonal under the weights (D, noise), and the factors found so far.
struct Rows<S, const N: usize, const M: usize> {
    au: [[S; N]; N],
    w: [[S; M]; N],
    weights: [S; N],
    noise: [S; M],
    result: Covariance<S, N>,
}

impl<S: Scalar, const N: usize, const M: usize> Rows<S, N, M> {
    /// Takes the part along row `j` out of the rows above it: the rows below were taken before.
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
