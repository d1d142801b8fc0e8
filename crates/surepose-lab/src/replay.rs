//! The estimator on recordings of real robots, judged against their references.
//!
//! One module per format. Each one merges its streams by stamp and is causal: a pose is estimated from what had
//! been recorded by then, and is judged at that time.

pub mod carmen;
mod follower;
mod hall;
pub mod mrclam;
mod odometry;
mod reference;
mod report;
mod score;
mod seeker;
pub mod ticks;
pub mod wean;

pub(crate) use follower::mounted;
pub use follower::{FollowerSettings, walls_of};
pub use hall::Hall;
pub use odometry::motion_between;
pub use reference::Reference;
pub use report::{ReplayError, ReplayReport};
pub use score::{Score, Summary};
