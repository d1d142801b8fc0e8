//! Small matrices and covariances.
//!
//! A [`Covariance`] stays symmetric and positive semi-definite by construction, in `f32` too. Measurements are applied row
//! by row as scalar [`Observation`]s, so that no matrix is inverted.

mod covariance;
mod matrix;

pub use covariance::{Covariance, InvalidCovariance, Observation};
pub use matrix::Matrix;
