//! Offline fits: wall maps from recorded scans or occupancy grids, and a robot's calibration from its recording.
//!
//! A wall map is fitted by [`from_log`] or [`from_grid`]. Both come down to points on surfaces, each with the direction of the free space before it ([`point_cloud`]); straight runs
//! of such points become walls ([`fit_walls`]). [`calibrate`] fits wheels, laser mount and noise.

pub mod calibrate;
pub mod fit_walls;
pub mod from_grid;
pub mod from_log;
pub mod point_cloud;

use fit_walls::FittedWall;
use serde::Serialize;
use surepose_io::wall_map::WallMap;

/// A wall map, and how well it fits what it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct MappingResult {
    /// The walls; each one's normal, to the right of the way from its first end to its second, points to free space.
    pub map: WallMap,
    /// The figures.
    pub report: MapReport,
}

/// The figures of a wall map, under the names of the command line's JSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MapReport {
    /// Number of walls.
    pub walls: usize,
    /// Their length in all \[m].
    pub length_m: f64,
    /// Root mean square distance of the points from the wall that they are on \[m].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_rms_m: Option<f64>,
    /// The part of all points that lie on some wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained: Option<f64>,
}

impl MapReport {
    /// The figures of a map of which nothing but the walls is known.
    pub fn from_map(map: &WallMap) -> Self {
        let length_m =
            map.walls.iter().map(surepose_io::wall_map::MapWall::length).fold(0.0, core::ops::Add::add);
        Self { walls: map.walls.len(), length_m, residual_rms_m: None, explained: None }
    }

    fn from_fit(map: &WallMap, grown: &[FittedWall], points: usize) -> Self {
        let on_walls: usize = grown.iter().map(|wall| wall.members.len()).sum();
        let squares: f64 = grown.iter().map(|wall| wall.residual_sum_of_squares).sum();
        let of = |sum: f64, count: usize| (count > 0).then(|| sum / count as f64);
        Self {
            residual_rms_m: of(squares, on_walls).map(libm::sqrt),
            explained: of(on_walls as f64, points),
            ..Self::from_map(map)
        }
    }
}
