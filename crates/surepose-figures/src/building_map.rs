//! A replay on an occupancy grid: the scans where the robot took them.

use surepose::geometry::{Body, Map, Point, Pose};
use surepose_io::recording::{Recording, ScanRecord, StampedPose, laser_extrinsics};
use surepose_replay::BuildingMap;
use surepose_replay::cmu_wean::WeanReplay;

use crate::plot::{Color, MapPlot as Drawing, Picture, Stroke};

use super::walls::{Bounds, grid_keys};

/// One scan of so many is drawn.
const EVERY: usize = 10;
/// Beams that are longer are left out \[m]: a degree moves them across half a room.
const MAX_SIDE: f64 = 15.0;
/// Margin around what is drawn \[m].
const MARGIN: f64 = 2.0;
/// Where it may be: so many places are shown.
const PLACES: usize = 12;

/// The grid, the robot's way, and on it what the laser saw; where the robot was not found, where it may be.
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
    let mut map = Drawing::new(if found { "Scans on the grid" } else { "Where the robot may be" });
    if let Some(heatmap) = bounds.tiles_of(building.grid()) {
        map = map.heatmap(heatmap, grid_keys());
    }
    if !seen.is_empty() {
        map = map.points("ends of beams", seen, Color::Vermilion);
    }
    if !before.is_empty() {
        map = map.trace("way until found", before, Stroke::solid(Color::Green));
    }
    if let Some(first) = followed.trajectory.iter().flatten().next() {
        map = map.trace("way since", trajectory, Stroke::solid(Color::Blue));
        let label = if followed.before.is_empty() { "start" } else { "found here" };
        map = map.pose(label, point(first), first.heading.radians(), Color::Blue);
    }
    for (i, pose) in followed.candidates.iter().take(PLACES).enumerate() {
        let label = if i == 0 { "may be it" } else { "" };
        map = map.pose(label, point(pose), pose.heading.radians(), Color::Blue);
    }
    map.picture()
}

/// Where the beams of a scan ended that was taken at `pose`.
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
