//! Picture of a replay on an occupancy grid, with the scans at the estimated poses.

use surepose::geometry::{Body, Map, Point, Pose};
use surepose_io::recording::{Recording, ScanRecord, StampedPose, laser_extrinsics};
use surepose_replay::BuildingMap;
use surepose_replay::cmu_wean::WeanReplay;

use crate::plot::{Color, MapPlot as Drawing, Picture, Stroke};

use super::walls::{Bounds, grid_keys};

/// Every n-th scan is drawn.
const EVERY: usize = 10;
/// Maximum range of a drawn beam \[m]; a heading error of 1° moves a longer beam by more than 0.26 m.
const MAX_SIDE: f64 = 15.0;
/// Margin around the drawing \[m].
const MARGIN: f64 = 2.0;
/// Maximum number of candidate poses shown.
const PLACES: usize = 12;

/// Draws the grid, the trajectory and the scans; if no pose was found, the candidate poses.
pub fn building_map(building: &BuildingMap, log: &Recording<StampedPose>, followed: &WeanReplay) -> Picture {
    let point = |pose: &Pose<Map, Body, f64>| (pose.x, pose.y);
    let trajectory: Vec<_> = followed.trajectory.iter().flatten().map(point).collect();
    let before: Vec<_> = followed.before.iter().map(point).collect();
    let poses = log.scans.iter().zip(&followed.trajectory).step_by(EVERY);
    let seen: Vec<_> = poses.filter_map(|(scan, pose)| Some(ends(scan, (*pose)?))).flatten().collect();
    let mut bounds = Bounds::new();
    let mut include = |(x, y): (f64, f64)| {
        bounds.include((x - MARGIN, y - MARGIN));
        bounds.include((x + MARGIN, y + MARGIN));
    };
    if seen.is_empty() {
        building.walls().iter().flat_map(surepose::map::Wall::ends).for_each(|end| include((end.x, end.y)));
    } else {
        seen.iter().chain(&before).for_each(|at| include(*at));
    }
    let found = followed.candidates.is_empty();
    let mut map = Drawing::new(if found { "Scans on the grid" } else { "Candidate poses of the robot" });
    if let Some(heatmap) = bounds.tiles_of(building.grid()) {
        map = map.heatmap(heatmap, grid_keys());
    }
    if !seen.is_empty() {
        map = map.points("beam end points", seen, Color::Vermilion);
    }
    if !before.is_empty() {
        map = map.trace("path before localization", before, Stroke::solid(Color::Green));
    }
    if let Some(first) = followed.trajectory.iter().flatten().next() {
        map = map.trace("estimated path", trajectory, Stroke::solid(Color::Blue));
        let label = if followed.before.is_empty() { "start" } else { "localized here" };
        map = map.pose(label, point(first), first.heading.radians(), Color::Blue);
    }
    for (i, pose) in followed.candidates.iter().take(PLACES).enumerate() {
        let label = if i == 0 { "candidate" } else { "" };
        map = map.pose(label, point(pose), pose.heading.radians(), Color::Blue);
    }
    map.picture()
}

/// Returns the beam end points of a scan taken at `pose`.
fn ends(scan: &ScanRecord, pose: Pose<Map, Body, f64>) -> Vec<(f64, f64)> {
    let map_from_laser = pose * laser_extrinsics(scan.mount);
    let beams = scan.ranges.iter().enumerate().filter(|(_, range)| range.is_finite() && **range < MAX_SIDE);
    let ends = beams.map(|(number, range)| {
        let (sin, cos) = scan.angle(number).sin_cos();
        let end = map_from_laser * Point::new(range * cos, range * sin);
        (end.x, end.y)
    });
    ends.collect()
}
