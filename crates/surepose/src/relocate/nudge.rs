//! A robot that was pushed a little: the map still explains the scan, and so it is not lost, but from somewhere else.
//!
//! Walls that are a hand's breadth off are outside the gate of the filter and of the matcher, which therefore say nothing
//! of them; and they are inside what a single beam may be off by. All beams together know better.

use crate::estimate::{Belief, Ekf, PoseFix};
use crate::laser::{Agreement, Glance, Wall};
use crate::scalar::{Float, Scalar};

/// How far off the robot is taken to be while its place settles, x and y \[m] and heading \[rad].
const SETTLING: [[f64; 3]; 4] =
    [[0.15, 0.15, 0.1], [0.08, 0.08, 0.05], [0.03, 0.03, 0.02], [0.01, 0.01, 0.005]];

/// How to notice a push, and what must hold of the place where the robot is found then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nudge<S> {
    /// Standard deviations of x \[m], y \[m] and θ \[rad] that all beams of a scan share: how well the map is known.
    pub scan_std: [S; 3],
    /// How far it may have been pushed, standard deviations of x \[m], y \[m] and θ \[rad].
    pub reach: [S; 3],
    /// The least part of the beams that is explained from where it is found.
    pub explained: S,
    /// The largest part that ends beyond the walls.
    pub beyond: S,
    /// By how much smaller the misfit is there than where it was believed to be: −2 log of the likelihood.
    pub margin: S,
}

impl<S: Float> Nudge<S> {
    /// For a map that is known as well as `scan_std` says.
    ///
    /// A hand's breadth in each direction; seven tenths explained, among clutter that hides a fifth; a hundred times as
    /// likely, as for walls to be told apart: that it was pushed, several scans have said before.
    pub fn on_map_known_to(scan_std: [S; 3]) -> Self {
        Self {
            scan_std,
            reach: [0.15, 0.15, 0.1].map(S::of),
            explained: S::of(0.7),
            beyond: S::of(0.08),
            margin: S::of(9.2),
        }
    }

    /// How the scan agrees with the map where the robot is believed to be, and how far from there its beams together put
    /// it: the normalised innovation squared of that, per row, 1 for a consistent filter.
    pub fn look<const BEAMS: usize>(
        &self,
        ekf: &Ekf<S>,
        glance: &Glance<S, BEAMS>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> (Agreement<S>, S) {
        let (agreement, fix) = glance.fix(belief, walls);
        let off = fix.map_or(S::of(0.0), |fix| {
            let fix = self.blurred(&fix);
            ekf.correct(*belief, &fix.innovation(belief), S::of(f64::MAX)).nis / S::of(3.0)
        });
        (agreement, off)
    }

    /// Where near `belief` the robot is, if it was pushed: `None` where the scan is no better explained from there.
    pub fn settle<const BEAMS: usize>(
        &self,
        ekf: &Ekf<S>,
        glance: &Glance<S, BEAMS>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> Option<Belief<S>> {
        let prior = Belief::new(belief.pose, self.reach);
        let mut found = prior;
        for vague in SETTLING {
            // Beams are laid on walls from where the robot seems to be by now, but what they say is said once.
            let near = Belief::new(found.pose, vague.map(S::of));
            let fix = self.blurred(&glance.fix(&near, walls).1.ok()?);
            found = ekf.correct(prior, &fix.innovation(&prior), S::of(f64::MAX)).belief;
        }
        let [there, here] = [found.pose, belief.pose].map(|pose| glance.from(pose, &found.covariance, walls));
        let is_better = there.misfit + self.margin <= here.misfit;
        let is_explained = there.explained_share() >= self.explained && there.beyond_share() <= self.beyond;
        (is_better && is_explained).then_some(found)
    }

    fn blurred(&self, fix: &PoseFix<S>) -> PoseFix<S> {
        fix.blurred(self.scan_std.map(Scalar::squared))
    }
}

#[cfg(test)]
mod tests {
    use super::Nudge;
    use crate::{Angle, Belief, Drive, Ekf, Glance, Integration, Point, Pose, RangeFinder, Scan, Wall};

    fn laser() -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: 0.03,
            bearing_std: 0.004,
            nearest: 0.05,
            farthest: 20.0,
        }
    }

    fn ekf() -> Ekf<f64> {
        Ekf { drive: Drive::new(0.05, 0.6), delta: 0.0025, integration: Integration::Arc }
    }

    /// The walls of the room (0, 0)–(4, 3), the first two of them along x.
    fn room() -> [Wall<f64>; 4] {
        let wall =
            |a: (f64, f64), b: (f64, f64)| Wall::between(Point::new(a.0, a.1), Point::new(b.0, b.1)).unwrap();
        [
            wall((0.0, 0.0), (4.0, 0.0)),
            wall((0.0, 3.0), (4.0, 3.0)),
            wall((4.0, 0.0), (4.0, 3.0)),
            wall((0.0, 0.0), (0.0, 3.0)),
        ]
    }

    /// What the 121 beams of a half-circle measure at (1, 1.2), looking along x, without noise.
    fn glance() -> Glance<f64, 128> {
        let step = 1.5_f64.to_radians();
        let ranges: [f64; 121] = core::array::from_fn(|k| {
            let (sin, cos) = (k as f64 * step - core::f64::consts::FRAC_PI_2).sin_cos();
            let ahead = if cos > 1e-9 { 3.0 / cos } else { f64::INFINITY };
            let aside = if sin > 0.0 { 1.8 / sin } else { -1.2 / sin };
            ahead.min(aside)
        });
        let first_bearing = Angle::from_degrees(-90.0);
        Glance::of(&laser(), &Scan { first_bearing, bearing_step: step, ranges: &ranges }).unwrap()
    }

    fn belief(x: f64, y: f64, degrees: f64) -> Belief<f64> {
        Belief::new(Pose::new(x, y, Angle::from_degrees(degrees)), [0.002, 0.002, 0.001])
    }

    fn nudge() -> Nudge<f64> {
        Nudge::on_map_known_to([0.002, 0.002, 0.001])
    }

    #[test]
    fn a_push_is_seen_and_put_right() {
        let truth = belief(1.0, 1.2, 0.0).pose;
        for (x, y, degrees) in [(0.95, 1.2, 0.0), (1.0, 1.28, 0.0), (1.03, 1.16, 3.0)] {
            let pushed = belief(x, y, degrees);
            let (agreement, off) = nudge().look(&ekf(), &glance(), &pushed, &room());
            assert!(agreement.explained_share() > 0.55, "single beams see little of it: {agreement:?}");
            assert!(off > 9.0, "{off}");
            let found = nudge().settle(&ekf(), &glance(), &pushed, &room()).unwrap();
            assert!(found.pose.origin().distance(truth.origin()) < 1e-3, "{found:?}");
            assert!((found.pose.heading - truth.heading).radians().abs() < 1e-3, "{found:?}");
            assert!(found.covariance.std(0) < 0.01, "{found:?}");
        }
    }

    #[test]
    fn who_is_where_he_thinks_was_not_pushed() {
        let (_, off) = nudge().look(&ekf(), &glance(), &belief(1.0, 1.2, 0.0), &room());
        assert!(off < 0.01, "{off}");
        assert_eq!(nudge().settle(&ekf(), &glance(), &belief(1.0, 1.2, 0.0), &room()), None);
    }

    /// Two walls along x say nothing of x: it is as vague afterwards as a push may be long.
    #[test]
    fn in_a_corridor_the_way_along_stays_open() {
        let walls = &room()[..2];
        let found = nudge().settle(&ekf(), &glance(), &belief(1.0, 1.28, 0.0), walls).unwrap();
        assert!((found.pose.y - 1.2).abs() < 1e-3 && found.covariance.std(1) < 0.01, "{found:?}");
        assert!(found.covariance.std(0) > 0.14, "{found:?}");
    }
}
