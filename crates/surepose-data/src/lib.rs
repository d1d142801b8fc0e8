//! Formats at the edge: recordings of real robots and the configuration, each known to exactly one module.

pub mod config;
pub mod error;
pub mod lines;
pub mod mrclam;
mod quantity;
pub mod recording;

pub use config::{Config, ConfigError};
pub use error::{DataError, Problem};
