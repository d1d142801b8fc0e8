//! Lost and found: a robot is lifted and put down somewhere else. Does it notice, find itself, and never fool itself?

mod report;
mod spawn_area;
#[cfg(test)]
mod tests;
mod trial;

pub use report::{KidnappingStats, run_trials};
pub use spawn_area::SpawnArea;
pub use trial::{KidnappingSetup, KidnappingTrial, run_trial};
