//! Borrowed map, as one step of the navigator sees it.

use super::{DistanceField, Wall};

/// Walls of the map and, for the global search, the distances to them. The caller owns both.
#[derive(Clone, Copy, Debug)]
pub struct MapView<'a, S> {
    /// Walls of the map; empty where there is no map.
    pub walls: &'a [Wall<S>],
    /// Distance field over the walls. `None` limits the global search to poses that two visible lines suggest.
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
