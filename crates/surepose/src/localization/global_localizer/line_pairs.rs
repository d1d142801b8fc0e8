//! Candidate poses from two crossing lines and all pairs of walls that may match them.

use crate::geometry::{Angle, Body, Laser, Map, Point, Pose};
use crate::lidar::ExtractedLine;
use crate::map::Wall;
use crate::scalar::Float;

/// Maximum number of line pairs of a scan: all pairs of the four lines with the most beams.
pub const MAX_LINE_PAIRS: usize = 6;

/// Maximum number of lines that form pairs.
const MAX_LINES: usize = 4;

/// Minimum sine of the angle between two lines that fix a pose.
const MIN_CROSSING_SINE: f64 = 0.4;

/// Tolerance of the angle between two walls \[rad], in addition to three standard deviations of the lines.
const ANGLE_TOLERANCE: f64 = 0.03;

/// Minimum fraction of a line that overlaps its wall, and margin of the wall beyond its end in the map \[m].
const MIN_COVERAGE: f64 = 0.8;
const END_MARGIN: f64 = 0.2;

/// Range of possible headings.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeadingPrior<S>(Option<(Angle<S>, S)>);

impl<S: Float> HeadingPrior<S> {
    pub(super) fn unconstrained() -> Self {
        Self(None)
    }

    pub(super) fn from_heading(heading: Angle<S>, reach: S) -> Self {
        Self(Some((heading, reach)))
    }

    pub(super) fn contains(&self, heading: Angle<S>) -> bool {
        self.0.is_none_or(|(center, reach)| (heading - center).radians().abs() <= reach)
    }
}

/// Calls `visit` with every pose from which two of `lines` lie on two of `walls`.
pub(super) fn for_each_line_pair_pose<S: Float>(
    lines: &[ExtractedLine<S>],
    walls: &[Wall<S>],
    body_from_laser: &Pose<Body, Laser, S>,
    heading_prior: &HeadingPrior<S>,
    mut visit: impl FnMut(Pose<Map, Body, S>),
) {
    let laser_from_body = body_from_laser.inverse();
    let best = most_seen(lines);
    for (i, first) in best.iter().enumerate() {
        for second in &best[..i] {
            let (Some(first), Some(second)) = (first, second) else { continue };
            let pair = Pair { first: second, second: first };
            if pair.crossing().abs() > S::from_f64(MIN_CROSSING_SINE) {
                pair.place(walls, |map_from_laser| {
                    let pose = map_from_laser * laser_from_body;
                    if heading_prior.contains(pose.heading) {
                        visit(pose);
                    }
                });
            }
        }
    }
}

/// The lines with the most beams.
fn most_seen<S: Float>(lines: &[ExtractedLine<S>]) -> [Option<&ExtractedLine<S>>; MAX_LINES] {
    let mut best: [Option<&ExtractedLine<S>>; MAX_LINES] = [None; MAX_LINES];
    for line in lines {
        let mut new = Some(line);
        for slot in &mut best {
            if new.map_or(0, |new| new.beams) > slot.map_or(0, |old| old.beams) {
                core::mem::swap(slot, &mut new);
            }
        }
    }
    best
}

/// Two lines of one scan.
struct Pair<'a, S> {
    first: &'a ExtractedLine<S>,
    second: &'a ExtractedLine<S>,
}

/// One side of a wall: its line with the normal that points away from the viewer.
struct Side<'a, S> {
    wall: &'a Wall<S>,
    normal: (S, S),
    distance: S,
}

fn sides<S: Float>(walls: &[Wall<S>]) -> impl Iterator<Item = Side<'_, S>> {
    walls.iter().flat_map(|wall| {
        [S::from_f64(1.0), S::from_f64(-1.0)].map(|sign| {
            let (x, y) = wall.line().normal();
            Side { wall, normal: (sign * x, sign * y), distance: sign * wall.line().distance }
        })
    })
}

impl<S: Float> Pair<'_, S> {
    /// Sine of the angle from the first line to the second.
    fn crossing(&self) -> S {
        cross(self.first.line.normal(), self.second.line.normal())
    }

    /// Calls `visit` with every pose of the laser from which both lines lie on walls.
    fn place(&self, walls: &[Wall<S>], mut visit: impl FnMut(Pose<Map, Laser, S>)) {
        let (first, second) = (self.first, self.second);
        let variance = first.direction_variance + second.direction_variance;
        let reach = S::from_f64(3.0) * variance.sqrt() + S::from_f64(ANGLE_TOLERANCE);
        let share = first.direction_variance.div_or_zero(variance);
        for a in sides(walls).filter(|side| is_long_enough(side.wall, first)) {
            // Rotation from the normal of the first line to that of the wall: cosine and sine.
            let turn = (dot(first.line.normal(), a.normal), cross(first.line.normal(), a.normal));
            let expected = turned(second.line.normal(), turn);
            for b in sides(walls) {
                // Sine of the deviation of the second wall from its expected direction; small, so close to the angle.
                let off = cross(expected, b.normal);
                if off.abs() > reach || dot(expected, b.normal) < S::from_f64(0.0) {
                    continue;
                }
                if !is_long_enough(b.wall, second) {
                    continue;
                }
                // p·n = r_map − r_seen for both walls.
                let determinant = cross(a.normal, b.normal);
                let (ra, rb) = (a.distance - first.line.distance, b.distance - second.line.distance);
                let x = (ra * b.normal.1 - rb * a.normal.1) / determinant;
                let y = (rb * a.normal.0 - ra * b.normal.0) / determinant;
                let heading = Angle::from_vector(turn.0, turn.1).rotated_by(share * off);
                let pose = Pose::new(x, y, heading);
                if lies_on(pose, first, a.wall) && lies_on(pose, second, b.wall) {
                    visit(pose);
                }
            }
        }
    }
}

fn is_long_enough<S: Float>(wall: &Wall<S>, line: &ExtractedLine<S>) -> bool {
    wall.length() + S::from_f64(END_MARGIN) >= S::from_f64(MIN_COVERAGE) * (line.extent.1 - line.extent.0)
}

fn lies_on<S: Float>(map_from_laser: Pose<Map, Laser, S>, line: &ExtractedLine<S>, wall: &Wall<S>) -> bool {
    let (nx, ny) = line.line.normal();
    let r = line.line.distance;
    let ends =
        [line.extent.0, line.extent.1].map(|t| map_from_laser * Point::new(r * nx - t * ny, r * ny + t * nx));
    wall.overlap(ends, S::from_f64(END_MARGIN)) >= S::from_f64(MIN_COVERAGE)
}

fn dot<S: Float>(a: (S, S), b: (S, S)) -> S {
    a.0 * b.0 + a.1 * b.1
}

fn cross<S: Float>(a: (S, S), b: (S, S)) -> S {
    a.0 * b.1 - a.1 * b.0
}

/// Rotates a vector by an angle given as cosine and sine.
fn turned<S: Float>(v: (S, S), turn: (S, S)) -> (S, S) {
    (turn.0 * v.0 - turn.1 * v.1, turn.1 * v.0 + turn.0 * v.1)
}
