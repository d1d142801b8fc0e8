//! Frontal least-squares solver: variables are eliminated in order of time.
//!
//! The normal matrix of a trajectory is sparse: a pose is coupled to its neighbors and to the walls observed
//! from it. With elimination in order of time, the dense front has a few dozen variables, so the cost is
//! linear in the length of the recording.

use nalgebra::{DMatrix, DVector};

/// Key of a variable block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key {
    Pose(usize),
    Wall(usize),
    Geometry,
}

/// Dense front of active variables, with the quadratic cost ½xᵀAx − bᵀx.
#[derive(Clone, Debug)]
pub(super) struct FrontalSolver {
    keys: Vec<(Key, usize)>,
    a: DMatrix<f64>,
    b: DVector<f64>,
    /// Minimum of the sum of squares over all eliminated variables; `log_determinant` is that of their
    /// information matrix.
    pub(super) chi_squared: f64,
    pub(super) log_determinant: f64,
    eliminated: Vec<Eliminated>,
}

/// An eliminated variable as a function of the remaining ones: x = x₀ − M·rest.
#[derive(Clone, Debug)]
struct Eliminated {
    key: Key,
    at: DVector<f64>,
    by: DMatrix<f64>,
    rest: Vec<(Key, usize)>,
}

/// The matrix is not positive definite: a variable is not determined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Singular;

impl FrontalSolver {
    pub(super) fn new() -> Self {
        Self {
            keys: Vec::new(),
            a: DMatrix::zeros(0, 0),
            b: DVector::zeros(0),
            chi_squared: 0.0,
            log_determinant: 0.0,
            eliminated: Vec::new(),
        }
    }

    fn find(&self, key: Key) -> Option<usize> {
        let mut offset = 0;
        for (other, size) in &self.keys {
            if *other == key {
                return Some(offset);
            }
            offset += size;
        }
        None
    }

    /// Returns the index of `key` in the front; adds the variable if it is new.
    pub(super) fn add_variable(&mut self, key: Key, size: usize) -> usize {
        self.find(key).unwrap_or_else(|| {
            let n = self.b.len();
            self.keys.push((key, size));
            self.a.resize_mut(n + size, n + size, 0.0);
            self.b.resize_vertically_mut(n + size, 0.0);
            n
        })
    }

    /// Adds the square of `residual` + J·x, weighted by `information`; `columns` has the front index of each
    /// column of J.
    pub(super) fn add_factor<const M: usize>(
        &mut self,
        residual: &[f64; M],
        jacobian: &[[f64; M]],
        columns: &[usize],
        information: &[[f64; M]; M],
    ) {
        let times = |v: &[f64; M]| -> [f64; M] {
            core::array::from_fn(|i| (0..M).map(|j| information[i][j] * v[j]).sum())
        };
        let dot = |a: &[f64; M], b: &[f64; M]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let weighted_residual = times(residual);
        self.chi_squared += dot(residual, &weighted_residual);
        for (p, row) in jacobian.iter().zip(columns) {
            self.b[*row] -= dot(p, &weighted_residual);
            let weighted = times(p);
            for (q, column) in jacobian.iter().zip(columns) {
                self.a[(*row, *column)] += dot(q, &weighted);
            }
        }
    }

    /// Eliminates `key` by a Schur complement.
    pub(super) fn eliminate(&mut self, key: Key) -> Result<(), Singular> {
        let Some(offset) = self.find(key) else { return Ok(()) };
        let Some(place) = self.keys.iter().position(|(other, _)| *other == key) else { return Ok(()) };
        let (_, size) = self.keys.remove(place);
        let n = self.b.len();
        let rest: Vec<usize> = (0..offset).chain(offset + size..n).collect();
        let own = self.a.view((offset, offset), (size, size)).into_owned();
        let cross = DMatrix::from_fn(size, rest.len(), |i, j| self.a[(offset + i, rest[j])]);
        let b_own = self.b.rows(offset, size).into_owned();
        let factor = own.cholesky().ok_or(Singular)?;
        let at = factor.solve(&b_own);
        let by = factor.solve(&cross);
        self.log_determinant += 2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        self.chi_squared -= b_own.dot(&at);
        let mut a = DMatrix::from_fn(rest.len(), rest.len(), |i, j| self.a[(rest[i], rest[j])]);
        a.gemm_tr(-1.0, &cross, &by, 1.0);
        let mut b = DVector::from_fn(rest.len(), |i, _| self.b[rest[i]]);
        b.gemv_tr(-1.0, &cross, &at, 1.0);
        self.a = a;
        self.b = b;
        self.eliminated.push(Eliminated { key, at, by, rest: self.keys.clone() });
        Ok(())
    }

    /// Returns A and b of the variables that remain in the front.
    pub(super) fn remaining(&self) -> (&DMatrix<f64>, &DVector<f64>) {
        (&self.a, &self.b)
    }

    /// Computes the values of all eliminated variables from the values of the remaining ones.
    pub(super) fn back_substitute(&self, left: &DVector<f64>, mut found: impl FnMut(Key, &DVector<f64>)) {
        let mut values = std::collections::HashMap::new();
        let mut offset = 0;
        for (key, size) in &self.keys {
            values.insert(*key, left.rows(offset, *size).into_owned());
            offset += size;
        }
        for eliminated in self.eliminated.iter().rev() {
            let mut x = eliminated.at.clone();
            let mut offset = 0;
            for (key, size) in &eliminated.rest {
                if let Some(value) = values.get(key) {
                    x.gemv(-1.0, &eliminated.by.columns(offset, *size), value, 1.0);
                }
                offset += size;
            }
            found(eliminated.key, &x);
            values.insert(eliminated.key, x);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::{FrontalSolver, Key, Singular};

    /// Each measurement depends on two of six variables; the dense solution is the reference.
    #[test]
    fn elimination_matches_the_dense_solution() {
        let keys = [Key::Geometry, Key::Pose(0), Key::Pose(1), Key::Wall(0), Key::Pose(2), Key::Wall(1)];
        let mut solver = FrontalSolver::new();
        let (mut a, mut b) = (DMatrix::<f64>::zeros(6, 6), DVector::<f64>::zeros(6));
        let mut squares = 0.0;
        let at: Vec<usize> = keys.iter().map(|key| solver.add_variable(*key, 1)).collect();
        for i in 0..6 {
            for j in 0..=i {
                let (p, q, e) = (1.0 + i as f64, 0.5 - j as f64, (i * 3 + j) as f64 * 0.1 - 0.4);
                solver.add_factor(&[e], &[[p], [q]], &[at[i], at[j]], &[[2.0]]);
                squares += 2.0 * e * e;
                for (x, m) in [(p, i), (q, j)] {
                    b[m] -= 2.0 * x * e;
                    for (y, n) in [(p, i), (q, j)] {
                        a[(m, n)] += 2.0 * x * y;
                    }
                }
            }
        }
        let whole = a.clone().cholesky().unwrap();
        let best = whole.solve(&b);
        for key in &keys[1..] {
            solver.eliminate(*key).unwrap();
        }
        let (left_a, left_b) = solver.remaining();
        let geometry = DVector::from_element(1, left_b[0] / left_a[(0, 0)]);
        assert!((geometry[0] - best[0]).abs() < 1e-12);
        let mut found = 0;
        solver.back_substitute(&geometry, |key, value| {
            let i = keys.iter().position(|other| *other == key).unwrap();
            assert!((value[0] - best[i]).abs() < 1e-10, "{key:?}");
            found += 1;
        });
        assert_eq!(found, 5);
        let determinant = solver.log_determinant + left_a[(0, 0)].ln();
        assert!((determinant - a.determinant().ln()).abs() < 1e-10);
        let minimum = solver.chi_squared - left_b[0] * geometry[0];
        assert!((minimum - (squares - b.dot(&best))).abs() < 1e-10);
    }

    #[test]
    fn undetermined_variables_are_singular() {
        let mut solver = FrontalSolver::new();
        solver.add_variable(Key::Pose(0), 3);
        assert_eq!(solver.eliminate(Key::Pose(0)), Err(Singular));
    }
}
