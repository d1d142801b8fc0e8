//! Map of walls and its distance field.

mod distance_field;
mod view;
mod wall;

pub use distance_field::{Cell, CellState, DistanceField, GridSpec};
pub use view::MapView;
pub use wall::{InvalidWall, Wall};
