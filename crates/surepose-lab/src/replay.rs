//! The estimator on recordings of real robots, judged against their references.
//!
//! One module per format. Each one merges its streams by stamp and is causal: a pose is estimated from what had
//! been recorded by then, and is judged at that time.

mod building_map;
pub mod carmen;
pub mod cmu_wean;
mod errors;
mod grid_localizer;
mod laser_replay;
pub mod mines_rover;
pub mod mrclam;
mod odometry;
mod reference;
mod report;

pub use building_map::BuildingMap;
pub use errors::{ErrorAccumulator, ErrorSummary};
pub(crate) use laser_replay::laser_extrinsics;
pub use laser_replay::{LaserReplaySettings, walls_from_map};
pub use odometry::motion_between;
pub use reference::Reference;
pub use report::{ReplayError, ReplayReport};
