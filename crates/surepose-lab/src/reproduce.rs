//! The experiments of the paper's figures, and of the worlds in which the project is judged.

mod extraction;
mod following;
mod localisation;
mod loop_world;
mod parking;
mod seeds;
mod stabilisation;

pub use extraction::{Extraction, extraction};
pub use following::{Followed, Following, PathFigures, Shape, ShapeFigures, following};
pub use localisation::{Accuracy, Comparison, Configuration, Moment, comparison, deviations, localisation};
pub use loop_world::LoopWorld;
pub use parking::{GoalFigures, PAPER_GOALS, Parked, parking};
pub use stabilisation::{Instant, Stabilised, StabilisedFigures, local_law, stabilisation};
