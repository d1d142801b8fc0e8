//! Borrowed map for one step of the navigator.

use super::{DistanceField, Wall};

/// Walls of the map and, for the global search, their distance field. The caller owns both.
#[derive(Clone, Copy, Debug)]
pub struct MapView<'a, S> {
    /// Walls of the map; empty without a map.
    pub walls: &'a [Wall<S>],
    /// Distance field over the walls. `None` limits the global search to poses from pairs of visible lines.
    pub distance_field: Option<DistanceField<'a, S>>,
}

impl<'a, S> MapView<'a, S> {
    /// Map without a distance field.
    pub fn from_walls(walls: &'a [Wall<S>]) -> Self {
        Self { walls, distance_field: None }
    }

    /// No map.
    pub fn empty() -> Self {
        Self::from_walls(&[])
    }

    /// Whether there is a map.
    pub fn is_known(&self) -> bool {
        !self.walls.is_empty()
    }
}
