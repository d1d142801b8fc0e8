//! The factored covariance equals the textbook formulas and stays valid.

use proptest::prelude::*;
use surepose::linalg::{Covariance, InvalidCovariance, Matrix};
use surepose::scalar::Float;

type M3 = Matrix<f64, 3, 3>;

fn entries() -> impl Strategy<Value = [f64; 9]> {
    prop::array::uniform9(-2.0..2.0_f64)
}

fn square(e: [f64; 9]) -> M3 {
    Matrix([[e[0], e[1], e[2]], [e[3], e[4], e[5]], [e[6], e[7], e[8]]])
}

/// Returns G Gᵀ, which is a covariance for every G.
fn gram(g: &M3) -> M3 {
    g * &g.transpose()
}

fn largest_difference(a: &M3, b: &M3) -> f64 {
    (0..9).map(|i| (a[(i / 3, i % 3)] - b[(i / 3, i % 3)]).abs()).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn factors_reproduce_the_matrix(e in entries()) {
        let p = gram(&square(e));
        let factored = Covariance::from_matrix(&p).unwrap();
        prop_assert!(factored.is_valid());
        prop_assert!(largest_difference(&factored.matrix(), &p) < 1e-12);
    }

    /// Compares with [Tran2012] Eq. (12) as matrix products.
    #[test]
    fn propagation_matches_the_textbook_formula(e in entries(), a in entries(), w in entries(), q in 0.0..3.0, r in 0.0..3.0) {
        let p = gram(&square(e));
        let a = square(a);
        let w = Matrix([[w[0], w[1]], [w[2], w[3]], [w[4], w[5]]]);
        let noise = &(&w * &Matrix::from_diagonal([q, r])) * &w.transpose();
        let mut expected = &(&a * &p) * &a.transpose();
        for i in 0..9 {
            expected[(i / 3, i % 3)] += noise[(i / 3, i % 3)];
        }
        let found = Covariance::from_matrix(&p).unwrap().propagated(&a, &w, [q, r]);
        prop_assert!(found.is_valid());
        prop_assert!(largest_difference(&found.matrix(), &expected) < 1e-11);
    }

    /// Compares with [Tran2012] Eq. (16), (18): K = P hᵀ/s, P − K s Kᵀ.
    #[test]
    fn observation_matches_the_textbook_formula(e in entries(), row in prop::array::uniform3(-2.0..2.0_f64), r in 0.01..3.0) {
        let p = gram(&square(e));
        let ph: Vec<f64> = (0..3).map(|i| (0..3).map(|k| p[(i, k)] * row[k]).sum()).collect();
        let s: f64 = r + (0..3).map(|i| row[i] * ph[i]).sum::<f64>();
        let mut expected = p;
        for i in 0..9 {
            expected[(i / 3, i % 3)] -= ph[i / 3] * ph[i % 3] / s;
        }
        let seen = Covariance::from_matrix(&p).unwrap().observed(row, r);
        prop_assert!((seen.variance - s).abs() < 1e-12 * s);
        for i in 0..3 {
            prop_assert!((seen.gain[i] - ph[i] / s).abs() < 1e-12);
        }
        prop_assert!(seen.covariance.is_valid());
        prop_assert!(largest_difference(&seen.covariance.matrix(), &expected) < 1e-11);
    }

    /// With P e' = e, the squared Mahalanobis distance of e is eᵀe'.
    #[test]
    fn mahalanobis_inverts_the_matrix(e in entries(), x in prop::array::uniform3(-2.0..2.0_f64)) {
        let mut p = gram(&square(e));
        for i in 0..3 {
            p[(i, i)] += 0.1;
        }
        let error: [f64; 3] = core::array::from_fn(|i| (0..3).map(|k| p[(i, k)] * x[k]).sum());
        let expected: f64 = (0..3).map(|i| error[i] * x[i]).sum();
        let found = Covariance::from_matrix(&p).unwrap().mahalanobis_squared(error);
        prop_assert!((found - expected).abs() < 1e-9 * (1.0 + expected));
    }
}

/// Applies a million badly scaled propagations and observations; checks validity after each.
fn endured<S: Float>() -> Covariance<S, 3> {
    let num = S::from_f64;
    let mut p = Covariance::from_std([num(1.0), num(1e-4), num(0.5)]);
    for k in 0..1_000_000_u32 {
        let phase = f64::from(k % 997) * 0.0063;
        let (sin, cos) = (num(phase.sin()), num(phase.cos()));
        let step = num(0.03);
        let zero = num(0.0);
        let a =
            Matrix([[num(1.0), zero, -(step * sin)], [zero, num(1.0), step * cos], [zero, zero, num(1.0)]]);
        let w = Matrix([[cos, cos], [sin, sin], [num(1.6), num(-1.6)]]);
        p = p.propagated(&a, &w, [num(1e-6), num(1e-6)]);
        if k % 3 == 0 {
            p = p.observed([zero, zero, num(1.0)], num(3e-6)).covariance;
        }
        if k % 7 == 0 {
            p = p.observed([cos, sin, zero], num(1e-10)).covariance;
        }
        assert!(p.is_valid(), "step {k}: {p:?}");
    }
    p
}

/// The result in `f32` is valid and equals that in `f64` up to rounding.
#[test]
fn covariance_stays_valid_for_a_million_steps_in_f32() {
    let (single, double) = (endured::<f32>(), endured::<f64>());
    for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
        let size = double.std(i) * double.std(j);
        let off = f64::from(single.entry(i, j)) - double.entry(i, j);
        assert!(off.abs() < 1e-5 * size, "({i}, {j}): {off} of {size}");
    }
}

#[test]
fn invalid_covariance_is_rejected() {
    let negative = Matrix::from_diagonal([1.0, -1.0, 1.0]);
    assert_eq!(Covariance::from_matrix(&negative), Err(InvalidCovariance));
    let indefinite = Matrix([[1.0, 2.0], [2.0, 1.0]]);
    assert_eq!(Covariance::from_matrix(&indefinite), Err(InvalidCovariance));
    let broken = Matrix([[1.0, f64::NAN], [f64::NAN, 1.0]]);
    assert_eq!(Covariance::from_matrix(&broken), Err(InvalidCovariance));
}
