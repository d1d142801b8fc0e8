//! Formats at the edge: recordings of real robots, each format known to exactly one module.

pub mod error;
pub mod lines;
pub mod mrclam;
mod quantity;
pub mod recording;

pub use error::{DataError, Problem};
