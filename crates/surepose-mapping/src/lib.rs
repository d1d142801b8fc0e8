//! Wall maps from recorded scans or occupancy grids, and calibration of a robot from its recording.
//!
//! [`from_log`] and [`from_grid`] extract wall maps. Both convert their input to surface points with the direction
//! of free space ([`point_cloud`]); collinear points become walls ([`fit_walls`]). [`calibrate`] fits wheels, laser
//! mounting and noise.

pub mod calibrate;
pub mod fit_walls;
pub mod from_grid;
pub mod from_log;
pub mod point_cloud;

use std::collections::BTreeSet;

use fit_walls::FittedWall;
use serde::Serialize;
use surepose_io::wall_map::WallMap;

/// A wall map with its quality figures.
#[derive(Clone, Debug, PartialEq)]
pub struct MappingResult {
    /// The walls; each normal, to the right of the direction from first to second end, points to free space.
    pub map: WallMap,
    /// Quality figures.
    pub report: MapReport,
}

/// Figures of a wall map, named as in the command line's JSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MapReport {
    /// Number of walls.
    pub walls: usize,
    /// Total length of the walls \[m].
    pub length_m: f64,
    /// Root mean square distance of the points from their wall \[m]; `None` without points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_rms_m: Option<f64>,
    /// Fraction of the points that lie on a wall; `None` without points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained: Option<f64>,
}

impl MapReport {
    /// Returns the figures of a map whose source points are not known.
    pub fn from_map(map: &WallMap) -> Self {
        let length_m =
            map.walls.iter().map(surepose_io::wall_map::MapWall::length).fold(0.0, core::ops::Add::add);
        Self { walls: map.walls.len(), length_m, residual_rms_m: None, explained: None }
    }

    fn from_fit(map: &WallMap, grown: &[FittedWall], points: usize) -> Self {
        let members = || grown.iter().flat_map(|wall| &wall.members);
        // A point may count twice in a fit, but is explained once.
        let explained = members().collect::<BTreeSet<_>>().len();
        let squares: f64 = grown.iter().map(|wall| wall.residual_sum_of_squares).sum();
        let of = |sum: f64, count: usize| (count > 0).then(|| sum / count as f64);
        Self {
            residual_rms_m: of(squares, members().count()).map(libm::sqrt),
            explained: of(explained as f64, points),
            ..Self::from_map(map)
        }
    }
}
