//! Replays recordings of real robots through the estimator, and measures the errors against their references.
//!
//! One module per format. Each one merges its streams by stamp and is causal: a pose is estimated from what had
//! been recorded by then, and is judged at that time.

mod building_map;
pub mod carmen;
pub mod cmu_wean;
mod grid_localizer;
mod laser_replay;
pub mod mines_rover;
pub mod mrclam;
mod odometry;
mod reference;
mod report;

pub use building_map::BuildingMap;
pub use laser_replay::LaserReplaySettings;
pub use reference::Reference;
pub use report::{ReplayError, ReplayReport};
