//! Experiments of the paper's figures, and benchmark worlds.

mod extraction;
mod following;
mod localization;
mod loop_world;
mod parking;
mod seeds;
mod stabilization;

pub use extraction::{Extraction, extraction};
pub use following::{PathAccuracy, PathFigures, PathFollowing, PathRuns, ShapeFigures, following};
pub use localization::{
    Accuracy, Comparison, Configuration, DeviationSample, comparison, deviations, localization,
};
pub use loop_world::LoopWorld;
pub use parking::{GoalFigures, PAPER_GOALS, Parked, parking};
pub use stabilization::{LawSample, StabilizationFigures, StabilizedRun, local_law, stabilization};
