//! Which line observations are of one wall.

use surepose::geometry::{Line, Map, Point};

use super::line_observation::LineObservation;
use super::model::{during, fraction, known_pose};
use super::parameter::{CalibrationParameter, Geometry};
use super::recording::{OdometryStep, locate};
use super::trajectory::Trajectory;

/// How alike two line observations must be, and how long a wall is remembered.
#[derive(Clone, Copy, Debug)]
pub(super) struct AssociationThresholds {
    /// Largest difference of direction \[rad].
    pub(super) direction: f64,
    /// Largest distance of either end from the other's line \[m].
    pub(super) distance: f64,
    /// How long after its last sighting a wall is known again \[s].
    pub(super) memory: f64,
}

/// A wall while line observations are gathered.
#[derive(Clone, Debug)]
struct TrackedWall {
    line: Line<Map, f64>,
    ends: [Point<Map, f64>; 2],
    last: f64,
}

/// How far apart along the wall two pieces may lie \[m].
const GAP: f64 = 0.5;

/// The number of the wall of each sighting, and the walls' lines as first seen.
pub(super) fn associate(
    line_observations: &[LineObservation],
    steps: &[OdometryStep],
    trajectory: &Trajectory,
    geometry: &Geometry<f64>,
    thresholds: AssociationThresholds,
) -> (Vec<usize>, Vec<[f64; 2]>) {
    let mut known: Vec<TrackedWall> = Vec::new();
    let mut first = Vec::new();
    let mut walls = vec![usize::MAX; line_observations.len()];
    let mut begin = 0;
    for scan in line_observations.chunk_by(|a, b| a.scan == b.scan) {
        let stamp = scan[0].stamp;
        let latency = geometry.get(CalibrationParameter::LaserLatency);
        let (index, _) = locate(steps, stamp - latency);
        let part = fraction(&steps[index], stamp, latency);
        let (from, to) = (trajectory.poses[index], trajectory.poses[index + 1]);
        let map_from_laser = during(known_pose(from), known_pose(to), part) * geometry.body_from_laser();
        let here: Vec<TrackedWall> = scan
            .iter()
            .map(|s| TrackedWall {
                line: map_from_laser * s.line,
                ends: s.ends.map(|end| map_from_laser * end),
                last: stamp,
            })
            .collect();
        // The best pairs first, each sighting and each wall once.
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (s, seen) in here.iter().enumerate() {
            for (w, wall) in
                known.iter().enumerate().filter(|(_, wall)| stamp - wall.last <= thresholds.memory)
            {
                if let Some(cost) = association_cost(wall, seen, thresholds) {
                    pairs.push((cost, s, w));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut taken = vec![false; known.len()];
        for (_, s, w) in pairs {
            if walls[begin + s] == usize::MAX && !taken[w] {
                walls[begin + s] = w;
                taken[w] = true;
                known[w] = here[s].clone();
            }
        }
        for (s, seen) in here.into_iter().enumerate() {
            if walls[begin + s] == usize::MAX {
                walls[begin + s] = known.len();
                first.push([seen.line.distance, seen.line.direction.radians()]);
                known.push(seen);
            }
        }
        begin += scan.len();
    }
    (walls, first)
}

/// How unlike a sighting is to a wall, from 0 to 2; `None` where it is another wall.
fn association_cost(
    wall: &TrackedWall,
    seen: &TrackedWall,
    thresholds: AssociationThresholds,
) -> Option<f64> {
    let turn = (wall.line.direction - seen.line.direction).radians().abs() / thresholds.direction;
    let off = |line: &Line<Map, f64>, ends: &[Point<Map, f64>; 2]| {
        let middle = Point::new(ends[0].x.midpoint(ends[1].x), ends[0].y.midpoint(ends[1].y));
        line.distance_from(middle).abs()
    };
    let distance = off(&wall.line, &seen.ends).min(off(&seen.line, &wall.ends)) / thresholds.distance;
    let (nx, ny) = wall.line.normal();
    let along = |point: Point<Map, f64>| ny * point.x - nx * point.y;
    let span = |ends: &[Point<Map, f64>; 2]| {
        let (a, b) = (along(ends[0]), along(ends[1]));
        (a.min(b), a.max(b))
    };
    let ((a, b), (c, d)) = (span(&wall.ends), span(&seen.ends));
    let gap = (a.max(c) - b.min(d)).max(0.0);
    (turn < 1.0 && distance < 1.0 && gap < GAP).then_some(turn + distance)
}
