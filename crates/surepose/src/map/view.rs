//! Borrowed map for one step of the navigator.

use super::{DistanceField, Wall};

/// Walls of the map and, for the global search, their distance field. The caller owns both.
#[derive(Clone, Copy, Debug)]
///
/// ```
/// use surepose::geometry::Point;
/// use surepose::map::{DistanceField, GridSpec, MapView, Wall};
///
/// let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)].map(|(x, y)| Point::new(x, y));
/// let walls = [0, 1, 2, 3].map(|k| Wall::between(corners[k], corners[(k + 1) % 4]).unwrap());
/// let mut map = MapView::from_walls(&walls);
///
/// // For the global search in places where a scan shows few walls:
/// let grid = GridSpec::from_walls(&walls, 0.05);
/// let mut cells = vec![0; grid.cell_count()];
/// grid.rasterize(&walls, &mut cells, |at| (0.0..4.0).contains(&at.x) && (0.0..3.0).contains(&at.y));
/// map.distance_field = DistanceField::from_cells(grid, &cells);
/// assert!(map.is_known() && map.distance_field.is_some());
/// ```
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
