//! Small matrices and covariances.
//!
//! A [`Covariance`] is symmetric and positive semi-definite by construction, in `f32` too. Each row of a measurement is
//! applied as a scalar [`Observation`], so that no matrix is inverted.

mod covariance;
mod matrix;

pub use covariance::{Covariance, InvalidCovariance, Observation};
pub use matrix::Matrix;
