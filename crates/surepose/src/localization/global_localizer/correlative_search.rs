//! Exhaustive correlative search over all poses of the map.
//!
//! The present scan and the keyframes form one template of rays around the robot. For every position of a lattice and
//! every heading, the ray ends are looked up in the [`DistanceField`]. Hill climbing refines the best poses.

use core::f64::consts::TAU;

use crate::geometry::{Angle, Body, Map, Point, Pose};
use crate::map::{Cell, DistanceField};
use crate::scalar::Float;

use super::line_pairs::HeadingPrior;
use super::top_candidates::TopCandidates;

/// Maximum number of rays of a template, and the stride of the coarse subset.
const MAX_RAYS: usize = 128;
const COARSE_STRIDE: usize = 4;

/// Lattice spacing \[m], and number of headings per turn.
const STEP: f64 = 0.2;
const HEADINGS: usize = 60;

/// Score of a ray that ends on a wall. It falls to 0 at the largest distance that the lattice spacing can cause.
const MAX_SCORE: u32 = 256;

/// Minimum mean score, as a fraction of the maximum: in the coarse subset, and on the lattice.
const MIN_COARSE_SCORE: f64 = 0.2;
const MIN_SCORE: f64 = 0.3;

/// Maximum number of starts of the hill climbing, and their separation \[m], \[rad].
const MAX_STARTS: usize = 160;
const START_SEPARATION: (f64, f64) = (0.45, 0.25);

/// Ray ends in the body frame.
pub(super) struct ScanTemplate<S> {
    rays: [(S, S); MAX_RAYS],
    len: usize,
}

/// A ray end in cells, and its score function.
#[derive(Clone, Copy, Default)]
struct Ray {
    end: Cell,
    /// Decrease of the score per unit of distance.
    decay: u32,
}

impl<S: Float> ScanTemplate<S> {
    /// Even selection of `ends`, which are `count` in number.
    pub(super) fn from_points(ends: impl Iterator<Item = Point<Body, S>>, count: usize) -> Self {
        let mut template = Self { rays: [(S::from_f64(0.0), S::from_f64(0.0)); MAX_RAYS], len: 0 };
        for (k, end) in ends.enumerate() {
            // The selection is spread evenly over all ends.
            let due = k * MAX_RAYS / count.max(MAX_RAYS) >= template.len;
            if let Some(slot) = template.rays.get_mut(template.len).filter(|_| due) {
                *slot = (end.x, end.y);
                template.len += 1;
            }
        }
        template
    }

    /// Calls `visit` with the poses from which most of the template ends at walls, the best first.
    pub(super) fn correlative_search(
        &self,
        field: &DistanceField<'_, S>,
        heading_prior: &HeadingPrior<S>,
        clearance: S,
        mut visit: impl FnMut(Pose<Map, Body, S>),
    ) {
        let mut candidates = TopCandidates::<S, MAX_STARTS>::with_separation(START_SEPARATION);
        for k in 0..HEADINGS {
            let heading = Angle::from_radians(S::from_f64(TAU * k as f64 / HEADINGS as f64));
            if heading_prior.contains(heading) {
                self.search_heading(field, heading, clearance, &mut candidates);
            }
        }
        let mut best = TopCandidates::<S, MAX_STARTS>::with_separation((STEP, 0.1));
        for pose in candidates.poses() {
            let (pose, score) = self.hill_climb(field, pose);
            best.insert(pose, -S::from_f64(f64::from(score)));
        }
        best.sorted().for_each(&mut visit);
    }

    /// Evaluates every position of the lattice at one heading.
    fn search_heading(
        &self,
        field: &DistanceField<'_, S>,
        heading: Angle<S>,
        clearance: S,
        candidates: &mut TopCandidates<S, MAX_STARTS>,
    ) {
        // Half a diagonal of the lattice, half a cell of rounding, and half a step of the heading.
        let rays =
            self.rays_at(field, heading, S::from_f64(0.75 * STEP), S::from_f64(0.5 * TAU / HEADINGS as f64));
        let rays = &rays[..self.len];
        let first = rays.len().div_ceil(COARSE_STRIDE);
        let least = |share: f64, count: usize| (share * f64::from(MAX_SCORE) * count as f64) as u32;
        let (min_coarse_score, min_score) = (least(MIN_COARSE_SCORE, first), least(MIN_SCORE, rays.len()));
        for cell in field.cells_at_spacing(S::from_f64(STEP)) {
            if !field.is_free(cell, clearance) {
                continue;
            }
            let coarse_score = score(field, cell, rays.iter().step_by(COARSE_STRIDE));
            if coarse_score < min_coarse_score {
                continue;
            }
            let score = score(field, cell, rays.iter());
            if score >= min_score {
                let at = field.center(cell);
                candidates.insert(Pose::new(at.x, at.y, heading), -S::from_f64(f64::from(score)));
            }
        }
    }

    /// Climbs from `pose` to a local optimum of the score, in ever smaller steps.
    fn hill_climb(
        &self,
        field: &DistanceField<'_, S>,
        mut pose: Pose<Map, Body, S>,
    ) -> (Pose<Map, Body, S>, u32) {
        let fine_score = |pose: Pose<Map, Body, S>| {
            let cell = field.cell_at(pose.origin());
            if !field.is_free(cell, S::from_f64(0.0)) {
                return 0;
            }
            let rays = self.rays_at(field, pose.heading, S::from_f64(0.15), S::from_f64(0.02));
            score(field, cell, rays[..self.len].iter())
        };
        let mut score = fine_score(pose);
        for (step, turn) in [(0.1, 0.05), (0.1, 0.025)] {
            let (step, turn, zero) = (S::from_f64(step), S::from_f64(turn), S::from_f64(0.0));
            for _ in 0..4 {
                let moves = [(step, zero, zero), (zero, step, zero), (zero, zero, turn)]
                    .map(|(x, y, t)| [(x, y, t), (-x, -y, -t)]);
                let mut best = (pose, score);
                for (x, y, t) in moves.into_iter().flatten() {
                    let next = Pose::new(pose.x + x, pose.y + y, pose.heading.rotated_by(t));
                    let next_score = fine_score(next);
                    if next_score > best.1 {
                        best = (next, next_score);
                    }
                }
                if best.1 == score {
                    break;
                }
                (pose, score) = best;
            }
        }
        (pose, score)
    }

    /// Rays in cells, with scores for a position uncertainty `place` \[m] and a heading uncertainty `turn` \[rad].
    fn rays_at(&self, field: &DistanceField<'_, S>, heading: Angle<S>, place: S, turn: S) -> [Ray; MAX_RAYS] {
        let (sin, cos) = heading.sin_cos();
        let mut rays = [Ray::default(); MAX_RAYS];
        for (ray, (x, y)) in rays.iter_mut().zip(&self.rays[..self.len]) {
            let range = (x.squared() + y.squared()).sqrt();
            let slack = (place + turn * range).min(field.max_distance());
            let end = field.cells_of(cos * *x - sin * *y, sin * *x + cos * *y);
            *ray = Ray { end, decay: MAX_SCORE / field.units(slack).max(1) };
        }
        rays
    }
}

fn score<'r, S: Float>(field: &DistanceField<'_, S>, at: Cell, rays: impl Iterator<Item = &'r Ray>) -> u32 {
    rays.map(|ray| {
        let distance = field.distance((at.0 + ray.end.0, at.1 + ray.end.1));
        MAX_SCORE.saturating_sub(distance * ray.decay)
    })
    .sum()
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Point, Pose};
    use crate::map::{DistanceField, GridSpec, Wall};

    use super::super::line_pairs::HeadingPrior;
    use super::ScanTemplate;

    extern crate std;
    use std::vec::Vec;

    /// A room of 5 × 4 m with a plate, and points on its walls as seen from `pose`.
    fn room(
        pose: Pose<crate::geometry::Map, crate::geometry::Body, f64>,
    ) -> (Vec<Wall<f64>>, Vec<Point<crate::geometry::Body, f64>>) {
        let corners = [(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 4.0), (0.0, 0.0)];
        let mut ends: Vec<_> = corners.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        ends.push([(1.0, 2.5), (2.2, 2.5)]);
        let walls: Vec<_> = ends
            .iter()
            .map(|[a, b]| Wall::between(Point::new(a.0, a.1), Point::new(b.0, b.1)).unwrap())
            .collect();
        let points = ends.iter().flat_map(|[a, b]| {
            (0..24).map(move |k| {
                let part = (f64::from(k) + 0.5) / 24.0;
                Point::<crate::geometry::Map, f64>::new(a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1))
            })
        });
        let body_from_map = pose.inverse();
        let seen = points.map(|p| {
            let (sin, cos) = body_from_map.heading.sin_cos();
            let (x, y) = (cos * p.x - sin * p.y, sin * p.x + cos * p.y);
            Point::new(body_from_map.x + x, body_from_map.y + y)
        });
        let seen = seen.collect();
        (walls, seen)
    }

    #[test]
    fn best_pose_is_the_true_pose() {
        let truth = Pose::new(3.33, 1.27, crate::geometry::Angle::from_degrees(-133.0));
        let (walls, seen) = room(truth);
        let grid = GridSpec::from_walls(&walls, 0.1);
        let mut cells = std::vec![0; grid.cell_count()];
        grid.rasterize(&walls, &mut cells, |_| true);
        let field = DistanceField::from_cells(grid, &cells).unwrap();
        let template = ScanTemplate::from_points(seen.iter().copied(), seen.len());
        let mut found = Vec::new();
        template.correlative_search(&field, &HeadingPrior::unconstrained(), 0.3, |pose| found.push(pose));
        let best = found.first().unwrap();
        let turned = (best.heading - truth.heading).radians().abs();
        assert!(best.origin().distance(truth.origin()) < 0.12 && turned < 0.04, "{best:?}");
    }

    #[test]
    fn occupied_cells_yield_no_pose() {
        let truth = Pose::new(3.33, 1.27, crate::geometry::Angle::from_degrees(-133.0));
        let (walls, seen) = room(truth);
        let grid = GridSpec::from_walls(&walls, 0.1);
        let mut cells = std::vec![0; grid.cell_count()];
        grid.rasterize(&walls, &mut cells, |at| at.x < 2.5);
        let field = DistanceField::from_cells(grid, &cells).unwrap();
        let template = ScanTemplate::from_points(seen.iter().copied(), seen.len());
        template.correlative_search(&field, &HeadingPrior::unconstrained(), 0.3, |pose| {
            assert!(pose.x < 2.6, "{pose:?}");
        });
        assert!(DistanceField::from_cells(grid, &cells[1..]).is_none());
    }

    /// Beams of the largest finite length are valid.
    #[test]
    fn unbounded_ranges_yield_finite_poses() {
        let (walls, mut seen) = room(Pose::new(3.33, 1.27, crate::geometry::Angle::from_degrees(-133.0)));
        for (point, x) in seen.iter_mut().zip([1e300, -1e300, 1e9, -1e9, 3e38, f64::MAX, f64::MIN]) {
            *point = Point::new(x, -x);
        }
        let grid = GridSpec::from_walls(&walls, 0.1);
        let mut cells = std::vec![0; grid.cell_count()];
        grid.rasterize(&walls, &mut cells, |_| true);
        let field = DistanceField::from_cells(grid, &cells).unwrap();
        let (left, up) = field.cells_of(-1e300, 1e300);
        assert!(left < 0 && up > 0, "{left}, {up}");
        let template = ScanTemplate::from_points(seen.iter().copied(), seen.len());
        template.correlative_search(&field, &HeadingPrior::unconstrained(), 0.3, |pose| {
            assert!(pose.x.is_finite(), "{pose:?}");
        });
    }
}
