//! Association of line observations to walls.

use surepose::geometry::{Line, Map, Point};

use super::line_observation::LineObservation;
use super::model::{during, fraction, known_pose};
use super::parameter::{CalibrationParameter, Geometry};
use super::recording::{OdometryStep, locate};
use super::trajectory::Trajectory;

/// Thresholds of association: maximum differences, and lifetime of a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct AssociationThresholds {
    /// Maximum difference of direction \[rad].
    pub(super) direction: f64,
    /// Maximum distance of the midpoint of one segment from the line of the other \[m].
    pub(super) distance: f64,
    /// Time after its last observation at which a wall expires \[s].
    pub(super) memory: f64,
}

/// A wall during association.
#[derive(Clone, Debug)]
struct TrackedWall {
    line: Line<Map, f64>,
    ends: [Point<Map, f64>; 2],
    last: f64,
}

/// Maximum gap between two segments along the wall \[m].
const GAP: f64 = 0.5;

/// Returns the wall index of each observation, and each wall's line (r, ψ) at its first observation.
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
        // Greedy by cost: each observation and each wall is used at most once.
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

/// Returns the association cost from 0 to 2; `None` if a threshold is exceeded.
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
