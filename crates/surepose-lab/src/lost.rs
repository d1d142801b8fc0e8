//! Lost and found: a robot is lifted and put down somewhere else. Does it notice, find itself, and never fool itself?

mod place;
mod report;
#[cfg(test)]
mod tests;
mod trial;

pub use place::Place;
pub use report::{Kidnappings, kidnappings};
pub use trial::{Kidnapping, Setup, kidnap};
