//! Map of walls and its distance field.

mod distance_field;
mod view;
mod wall;

pub(crate) use distance_field::Cell;

pub use distance_field::{DistanceField, GridSpec};
pub use view::MapView;
pub use wall::{InvalidWall, Wall};
