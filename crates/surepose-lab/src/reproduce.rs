//! The experiments of the paper's figures, and of the worlds in which the project is judged.

mod following;
mod parking;
mod stabilisation;

pub use following::{Followed, Following, PathFigures, Shape, ShapeFigures, following};
pub use parking::{GoalFigures, PAPER_GOALS, Parked, parking};
pub use stabilisation::{Instant, Stabilised, StabilisedFigures, local_law, stabilisation};
