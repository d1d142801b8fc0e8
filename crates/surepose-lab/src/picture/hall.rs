//! A replay on an occupancy grid: the scans where the robot took them.

use surepose::{Body, Map, Point, Pose};
use surepose_data::recording::{Recording, Scan, StampedPose};
use surepose_plot::{Color, Map as Drawing, Picture, Stroke};

use crate::replay::mounted;
use crate::replay::wean::{Followed, Hall};

/// One scan of so many is drawn.
const EVERY: usize = 10;
/// Beams that are longer are left out \[m]: a degree moves them across half a room.
const LONGEST: f64 = 15.0;
/// Margin around what is drawn \[m].
const MARGIN: f64 = 3.0;
/// Where it may be: so many places are shown.
const PLACES: usize = 12;

/// The grid, the robot's way, and on it what the laser saw; where the robot was not found, where it may be.
pub fn hall(hall: &Hall, log: &Recording<StampedPose>, followed: &Followed) -> Picture {
    let way: Vec<_> = followed.way.iter().flatten().map(|pose| (pose.x, pose.y)).collect();
    let poses = log.scans.iter().zip(&followed.way).step_by(EVERY);
    let seen: Vec<_> = poses.filter_map(|(scan, pose)| Some(ends(scan, (*pose)?))).flatten().collect();
    let shown = if seen.is_empty() { hall.solid() } else { &seen };
    let mut low = (f64::MAX, f64::MAX);
    let mut high = (f64::MIN, f64::MIN);
    for (x, y) in shown {
        (low, high) = ((low.0.min(*x), low.1.min(*y)), (high.0.max(*x), high.1.max(*y)));
    }
    let (low, high) = ((low.0 - MARGIN, low.1 - MARGIN), (high.0 + MARGIN, high.1 + MARGIN));
    let is_shown = |(x, y): &(f64, f64)| *x > low.0 && *x < high.0 && *y > low.1 && *y < high.1;
    let solid: Vec<_> = hall.solid().iter().copied().filter(is_shown).collect();
    let found = followed.places.is_empty();
    let mut map = Drawing::new(if found { "Scans on the grid" } else { "Where the robot may be" });
    if low.0 < high.0 {
        map = map.window(low, high);
    }
    if solid.is_empty() {
        map = map.walls(hall.walls().iter().map(|wall| wall.ends().map(|end| (end.x, end.y))));
    } else {
        map = map.points("solid cells", solid, Color::Silver);
    }
    if !seen.is_empty() {
        map = map.points("ends of beams", seen, Color::Vermilion);
        map = map.trace("way", way, Stroke::solid(Color::Blue));
    }
    for (i, pose) in followed.places.iter().take(PLACES).enumerate() {
        let label = if i == 0 { "may be it" } else { "" };
        map = map.pose(label, (pose.x, pose.y), pose.heading.radians(), Color::Blue);
    }
    map.picture()
}

/// Where the beams of a scan ended that was taken at `pose`.
fn ends(scan: &Scan, pose: Pose<Map, Body, f64>) -> Vec<(f64, f64)> {
    let map_from_laser = pose * mounted(scan.mount);
    let beams = scan.ranges.iter().enumerate().filter(|(_, range)| range.is_finite() && **range < LONGEST);
    let ends = beams.map(|(number, range)| {
        let (sin, cos) = (scan.angle_min + number as f64 * scan.angle_increment).sin_cos();
        let end = map_from_laser * Point::new(range * cos, range * sin);
        (end.x, end.y)
    });
    ends.collect()
}
