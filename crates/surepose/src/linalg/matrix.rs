//! Matrices of fixed size, for Jacobians and covariances.

use core::ops::{Index, IndexMut, Mul};

use crate::scalar::Scalar;

/// Matrix with `R` rows and `C` columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix<S, const R: usize, const C: usize>(
    /// Rows of the matrix.
    pub [[S; C]; R],
);

impl<S: Scalar, const R: usize, const C: usize> Matrix<S, R, C> {
    /// Creates a matrix of zeros.
    #[inline]
    pub fn zeros() -> Self {
        Self([[S::from_f64(0.0); C]; R])
    }

    /// Returns the transpose.
    #[must_use]
    #[inline]
    pub fn transpose(&self) -> Matrix<S, C, R> {
        let mut result = Matrix::zeros();
        for row in 0..R {
            for column in 0..C {
                result[(column, row)] = self[(row, column)];
            }
        }
        result
    }
}

impl<S: Scalar, const N: usize> Matrix<S, N, N> {
    /// Creates a diagonal matrix.
    #[inline]
    pub fn from_diagonal(diagonal: [S; N]) -> Self {
        let mut result = Self::zeros();
        for (i, value) in diagonal.into_iter().enumerate() {
            result[(i, i)] = value;
        }
        result
    }
}

impl<S, const R: usize, const C: usize> Index<(usize, usize)> for Matrix<S, R, C> {
    type Output = S;
    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &S {
        &self.0[row][column]
    }
}

impl<S, const R: usize, const C: usize> IndexMut<(usize, usize)> for Matrix<S, R, C> {
    #[inline]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut S {
        &mut self.0[row][column]
    }
}

impl<S: Scalar, const R: usize, const K: usize, const C: usize> Mul<&Matrix<S, K, C>> for &Matrix<S, R, K> {
    type Output = Matrix<S, R, C>;
    #[inline]
    fn mul(self, other: &Matrix<S, K, C>) -> Matrix<S, R, C> {
        let mut result = Matrix::zeros();
        for row in 0..R {
            for column in 0..C {
                let mut sum = S::from_f64(0.0);
                for k in 0..K {
                    sum = sum + self[(row, k)] * other[(k, column)];
                }
                result[(row, column)] = sum;
            }
        }
        result
    }
}
