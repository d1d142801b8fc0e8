//! Replay of recordings of real robots through the estimator, with evaluation against a reference.
//!
//! There is one module per format. Each merges its streams by stamp and is causal: a pose is estimated from
//! the records up to its time, and evaluated at that time.

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
mod track;

pub use building_map::BuildingMap;
pub use laser_replay::LaserReplaySettings;
pub use reference::Reference;
pub use report::{ReplayError, ReplayReport};
pub use track::{AbsolutePoseError, RelativePoseError, Track, TrackPoint};
