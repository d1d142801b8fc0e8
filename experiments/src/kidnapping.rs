//! Kidnapped-robot trials: detection, relocalization and wrong poses.

mod report;
mod spawn_area;
#[cfg(test)]
mod tests;
mod trial;

pub use report::{KidnappingStats, run_trials};
pub use spawn_area::SpawnArea;
pub use trial::{KidnappingSetup, KidnappingTrial, run_trial};
