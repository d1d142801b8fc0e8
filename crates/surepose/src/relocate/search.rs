//! Poses from trying all there are: so that what is not found is not overlooked, but does not explain what was seen.
//!
//! What is seen now and what is remembered becomes one fan of rays around the robot. From every place of a lattice and in
//! every heading its ends are looked up in the [`Chart`]; the best climb to where their ends lie nearest to walls.

use core::f64::consts::TAU;

use crate::angle::Angle;
use crate::frame::{Body, Map};
use crate::pose::{Point, Pose};
use crate::scalar::Float;

use super::chart::{Cell, Chart};
use super::pool::Pool;
use super::propose::Hint;

/// The most rays of a fan, how many of them are a first sight, and how many parts a fan is dealt into.
const MOST_RAYS: usize = 128;
const PARTS: usize = 4;

/// The lattice: metres from place to place, and headings of a turn.
const STEP: f64 = 0.2;
const HEADINGS: usize = 60;

/// A ray's credit where its end is on a wall; falling to 0 where it is as far away as the lattice may put it.
const FULL: u32 = 256;

/// The least mean credit, of full, at first sight and on the lattice.
const AT_FIRST: f64 = 0.2;
const ENOUGH: f64 = 0.3;

/// Climbers, and how far apart they start \[m], \[rad].
const CLIMBERS: usize = 160;
const APART: (f64, f64) = (0.45, 0.25);

/// Rays to where beams ended, seen from the robot.
pub(super) struct Fan<S> {
    rays: [(S, S); MOST_RAYS],
    len: usize,
}

/// A ray in cells, and what its end is worth there.
#[derive(Clone, Copy, Default)]
struct Ray {
    end: Cell,
    /// How much credit a unit of distance takes.
    falls: u32,
}

impl<S: Float> Fan<S> {
    /// An even selection of `ends`, of which there are `count`.
    pub(super) fn of(ends: impl Iterator<Item = Point<Body, S>>, count: usize) -> Self {
        let mut fan = Self { rays: [(S::of(0.0), S::of(0.0)); MOST_RAYS], len: 0 };
        for (k, end) in ends.enumerate() {
            // The next one of so many, evenly over all.
            let due = k * MOST_RAYS / count.max(MOST_RAYS) >= fan.len;
            if let Some(slot) = fan.rays.get_mut(fan.len).filter(|_| due) {
                *slot = (end.x, end.y);
                fan.len += 1;
            }
        }
        fan
    }

    /// Calls `visit` with the poses from which most of the fan ends at walls, the best first.
    pub(super) fn search(
        &self,
        chart: &Chart<'_, S>,
        hint: &Hint<S>,
        clearance: S,
        mut visit: impl FnMut(Pose<Map, Body, S>),
    ) {
        let mut pool = Pool::<S, CLIMBERS>::apart(APART);
        for k in 0..HEADINGS {
            let heading = Angle::wrapped(S::of(TAU * k as f64 / HEADINGS as f64));
            if hint.admits(heading) {
                self.sweep(chart, heading, clearance, &mut pool);
            }
        }
        let mut best = Pool::<S, CLIMBERS>::apart((STEP, 0.1));
        for pose in pool.poses() {
            let (pose, credit) = self.climb(chart, pose);
            best.keep(pose, -S::of(f64::from(credit)));
        }
        best.sorted().for_each(&mut visit);
    }

    /// Tries every place of the lattice in one heading.
    fn sweep(&self, chart: &Chart<'_, S>, heading: Angle<S>, clearance: S, pool: &mut Pool<S, CLIMBERS>) {
        // Half a diagonal of the lattice, half a cell of rounding, and half a step of the heading.
        let rays = self.turned(chart, heading, S::of(0.75 * STEP), S::of(0.5 * TAU / HEADINGS as f64));
        let rays = &rays[..self.len];
        let first = rays.len().div_ceil(PARTS);
        let least = |share: f64, count: usize| (share * f64::from(FULL) * count as f64) as u32;
        let (at_first, enough) = (least(AT_FIRST, first), least(ENOUGH, rays.len()));
        for cell in chart.lattice(S::of(STEP)) {
            if !chart.is_free(cell, clearance) {
                continue;
            }
            let glimpse = credit(chart, cell, rays.iter().step_by(PARTS));
            if glimpse < at_first {
                continue;
            }
            let credit = credit(chart, cell, rays.iter());
            if credit >= enough {
                let at = chart.middle(cell);
                pool.keep(Pose::new(at.x, at.y, heading), -S::of(f64::from(credit)));
            }
        }
    }

    /// Climbs from `pose` to where the ends lie nearest to walls, in ever smaller steps.
    fn climb(&self, chart: &Chart<'_, S>, mut pose: Pose<Map, Body, S>) -> (Pose<Map, Body, S>, u32) {
        let fine = |pose: Pose<Map, Body, S>| {
            let cell = chart.cell_at(pose.origin());
            if !chart.is_free(cell, S::of(0.0)) {
                return 0;
            }
            let rays = self.turned(chart, pose.heading, S::of(0.15), S::of(0.02));
            credit(chart, cell, rays[..self.len].iter())
        };
        let mut credit = fine(pose);
        for (step, turn) in [(0.1, 0.05), (0.1, 0.025)] {
            let (step, turn, zero) = (S::of(step), S::of(turn), S::of(0.0));
            for _ in 0..4 {
                let moves = [(step, zero, zero), (zero, step, zero), (zero, zero, turn)]
                    .map(|(x, y, t)| [(x, y, t), (-x, -y, -t)]);
                let mut best = (pose, credit);
                for (x, y, t) in moves.into_iter().flatten() {
                    let next = Pose::new(pose.x + x, pose.y + y, pose.heading.turned(t));
                    let worth = fine(next);
                    if worth > best.1 {
                        best = (next, worth);
                    }
                }
                if best.1 == credit {
                    break;
                }
                (pose, credit) = best;
            }
        }
        (pose, credit)
    }

    /// The rays in cells, and what they are worth where the place may be off by `place` \[m] and the heading by `turn`.
    fn turned(&self, chart: &Chart<'_, S>, heading: Angle<S>, place: S, turn: S) -> [Ray; MOST_RAYS] {
        let (sin, cos) = heading.sin_cos();
        let mut rays = [Ray::default(); MOST_RAYS];
        for (ray, (x, y)) in rays.iter_mut().zip(&self.rays[..self.len]) {
            let range = (x.squared() + y.squared()).sqrt();
            let slack = (place + turn * range).min(Chart::<S>::reach());
            let end = chart.steps_of(cos * *x - sin * *y, sin * *x + cos * *y);
            *ray = Ray { end, falls: FULL / Chart::<S>::units(slack).max(1) };
        }
        rays
    }
}

fn credit<'r, S: Float>(chart: &Chart<'_, S>, at: Cell, rays: impl Iterator<Item = &'r Ray>) -> u32 {
    rays.map(|ray| {
        let distance = chart.distance((at.0 + ray.end.0, at.1 + ray.end.1));
        FULL.saturating_sub(distance * ray.falls)
    })
    .sum()
}

#[cfg(test)]
mod tests {
    use super::super::chart::{Chart, Extent};
    use super::super::propose::Hint;
    use super::Fan;
    use crate::{Point, Pose, Wall};

    extern crate std;
    use std::vec::Vec;

    /// A room of 5 × 4 m with a plate, and points on its walls as a robot at `pose` sees them.
    fn room(pose: Pose<crate::Map, crate::Body, f64>) -> (Vec<Wall<f64>>, Vec<Point<crate::Body, f64>>) {
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
                Point::<crate::Map, f64>::new(a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1))
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
    fn the_best_of_all_poses_is_the_true_one() {
        let truth = Pose::new(3.33, 1.27, crate::Angle::from_degrees(-133.0));
        let (walls, seen) = room(truth);
        let extent = Extent::around(&walls, 0.1);
        let mut cells = std::vec![0; extent.cells()];
        extent.draw(&walls, &mut cells, |_| true);
        let chart = Chart::of(extent, &cells).unwrap();
        let fan = Fan::of(seen.iter().copied(), seen.len());
        let mut found = Vec::new();
        fan.search(&chart, &Hint::none(), 0.3, |pose| found.push(pose));
        let best = found.first().unwrap();
        let turned = (best.heading - truth.heading).radians().abs();
        assert!(best.origin().distance(truth.origin()) < 0.12 && turned < 0.04, "{best:?}");
    }

    #[test]
    fn nobody_is_found_where_nobody_can_be() {
        let truth = Pose::new(3.33, 1.27, crate::Angle::from_degrees(-133.0));
        let (walls, seen) = room(truth);
        let extent = Extent::around(&walls, 0.1);
        let mut cells = std::vec![0; extent.cells()];
        extent.draw(&walls, &mut cells, |at| at.x < 2.5);
        let chart = Chart::of(extent, &cells).unwrap();
        let fan = Fan::of(seen.iter().copied(), seen.len());
        fan.search(&chart, &Hint::none(), 0.3, |pose| assert!(pose.x < 2.6, "{pose:?}"));
        assert!(Chart::of(extent, &cells[1..]).is_none());
    }

    /// A beam may be as long as a number can be.
    #[test]
    fn beams_without_end_explain_nothing_and_break_nothing() {
        let (walls, mut seen) = room(Pose::new(3.33, 1.27, crate::Angle::from_degrees(-133.0)));
        for (point, x) in seen.iter_mut().zip([1e300, -1e300, 1e9, -1e9, 3e38, f64::MAX, f64::MIN]) {
            *point = Point::new(x, -x);
        }
        let extent = Extent::around(&walls, 0.1);
        let mut cells = std::vec![0; extent.cells()];
        extent.draw(&walls, &mut cells, |_| true);
        let chart = Chart::of(extent, &cells).unwrap();
        let (left, up) = chart.steps_of(-1e300, 1e300);
        assert!(left < 0 && up > 0, "{left}, {up}");
        let fan = Fan::of(seen.iter().copied(), seen.len());
        fan.search(&chart, &Hint::none(), 0.3, |pose| assert!(pose.x.is_finite(), "{pose:?}"));
    }
}
