//! Local search for the pose of a robot that was displaced by a small distance.
//!
//! A displacement of about 0.1 m puts walls outside the gates of the filter and of the line associator, so neither
//! corrects it. The error of a single beam may be as large, but all beams together determine the displacement.

use crate::estimation::{Belief, Ekf, PoseMeasurement};
use crate::geometry::Pose;
use crate::lidar::{BeamStats, BeamSubset};
use crate::map::Wall;
use crate::scalar::{Float, Scalar};

/// Uncertainty of the pose in each iteration of the refinement, x and y \[m] and heading \[rad].
const LINEARIZATION_STD: [[f64; 3]; 4] =
    [[0.15, 0.15, 0.1], [0.08, 0.08, 0.05], [0.03, 0.03, 0.02], [0.01, 0.01, 0.005]];

/// Headings at which the search after slip starts, relative to the belief \[rad].
const SLIP_HEADINGS: [f64; 7] = [0.0, 0.15, -0.15, 0.3, -0.3, 0.45, -0.45];

/// Largest displacement by slip, in its standard deviations: a larger one is no slip, and the global search decides.
const MAX_SLIP_STD_DEVS: f64 = 2.5;
/// Minimum fraction of explained beams after slip: the pose changes at once, without the further scans of a lost robot.
const MIN_SLIP_HIT_RATIO: f64 = 0.85;

/// Parameters of the detection of a displacement, and acceptance criteria for the new pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalSearch<S> {
    /// Standard deviations of x \[m], y \[m] and θ \[rad] of the error common to all beams of a scan, mainly that of
    /// the map.
    pub scan_std: [S; 3],
    /// Standard deviations of the displacement in x \[m], y \[m] and θ \[rad].
    pub prior_std: [S; 3],
    /// Minimum fraction of explained beams at the new pose, 0 to 1.
    pub min_hit_ratio: S,
    /// Maximum fraction of beams that end behind the walls, 0 to 1.
    pub max_behind_wall_ratio: S,
    /// Minimum decrease of −2 log likelihood from the believed to the new pose.
    pub min_improvement: S,
}

impl<S: Float> LocalSearch<S> {
    /// Parameters for a map of the uncertainty `scan_std`.
    ///
    /// The displacement is about 0.1 m in each direction. The minimum of 0.7 explained beams allows for clutter that
    /// hides a fifth. The likelihood ratio is 100, as for associations; the detection already requires several scans.
    pub fn from_scan_std(scan_std: [S; 3]) -> Self {
        Self {
            scan_std,
            prior_std: [0.15, 0.15, 0.1].map(S::from_f64),
            min_hit_ratio: S::from_f64(0.7),
            max_behind_wall_ratio: S::from_f64(0.08),
            min_improvement: S::from_f64(9.2),
        }
    }

    /// Agreement of the scan with the map at the belief, and the innovation of the pose that its beams measure. The
    /// latter is the normalized innovation squared per row, 1 for a consistent filter.
    pub fn evaluate<const BEAMS: usize>(
        &self,
        ekf: &Ekf<S>,
        beams: &BeamSubset<S, BEAMS>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> (BeamStats<S>, S) {
        let (stats, fix) = beams.measure_pose(belief, walls);
        let nis = fix.map_or(S::from_f64(0.0), |fix| {
            let fix = self.inflated(&fix);
            ekf.correct(*belief, &fix.innovation(belief), S::from_f64(f64::MAX)).nis / S::from_f64(3.0)
        });
        (stats, nis)
    }

    /// Pose of a robot whose wheels slipped on the way to `belief`; `None` where no pose explains the scan better.
    ///
    /// The search starts at several headings within twice the standard deviation of the displacement's heading, because the
    /// refinement converges from about 0.1 rad.
    pub fn refine_after_slip<const BEAMS: usize>(
        &self,
        ekf: &Ekf<S>,
        beams: &BeamSubset<S, BEAMS>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> Option<Belief<S>> {
        let strict = Self { min_hit_ratio: self.min_hit_ratio.max(S::from_f64(MIN_SLIP_HIT_RATIO)), ..*self };
        let starts = SLIP_HEADINGS.iter().map(|heading| S::from_f64(*heading));
        let within = starts.filter(|heading| heading.abs() <= self.prior_std[2] * S::from_f64(2.0));
        let found = within.filter_map(|heading| {
            let pose = belief.pose;
            let turned = Pose::new(pose.x, pose.y, pose.heading.rotated_by(heading));
            let found = strict.refine(ekf, beams, &Belief { pose: turned, ..*belief }, walls)?;
            Some((beams.evaluate(found.pose, &found.covariance, walls).neg2_log_likelihood, found))
        });
        let is_slip = |found: &Belief<S>| {
            let moved = found.error(belief.pose);
            let limit = S::from_f64(MAX_SLIP_STD_DEVS);
            moved.iter().zip(self.prior_std).all(|(moved, std)| moved.abs() <= std * limit)
        };
        let found = found.filter(|(_, found)| is_slip(found));
        let better = |a: (S, Belief<S>), b: (S, Belief<S>)| if b.0 < a.0 { b } else { a };
        let (likelihood, found) = found.reduce(better)?;
        let here = beams.evaluate(belief.pose, &found.covariance, walls).neg2_log_likelihood;
        (likelihood + self.min_improvement <= here).then_some(found)
    }

    /// Pose of a displaced robot near `belief`; `None` where no pose explains the scan better.
    pub fn refine<const BEAMS: usize>(
        &self,
        ekf: &Ekf<S>,
        beams: &BeamSubset<S, BEAMS>,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> Option<Belief<S>> {
        let prior = Belief::new(belief.pose, self.prior_std);
        let mut found = prior;
        for std in LINEARIZATION_STD {
            // The beams are linearized at the present estimate, but their information enters only once.
            let near = Belief::new(found.pose, std.map(S::from_f64));
            let fix = self.inflated(&beams.measure_pose(&near, walls).1.ok()?);
            found = ekf.correct(prior, &fix.innovation(&prior), S::from_f64(f64::MAX)).belief;
        }
        let [there, here] =
            [found.pose, belief.pose].map(|pose| beams.evaluate(pose, &found.covariance, walls));
        let is_better = there.neg2_log_likelihood + self.min_improvement <= here.neg2_log_likelihood;
        let is_accepted = there.hit_ratio() >= self.min_hit_ratio
            && there.behind_wall_ratio() <= self.max_behind_wall_ratio;
        (is_better && is_accepted).then_some(found)
    }

    fn inflated(&self, fix: &PoseMeasurement<S>) -> PoseMeasurement<S> {
        fix.inflated(self.scan_std.map(Scalar::squared))
    }
}

#[cfg(test)]
mod tests {
    use crate::estimation::{Belief, Ekf};
    use crate::geometry::{Angle, Point, Pose};
    use crate::kinematics::{DiffDrive, Integration};
    use crate::lidar::{BeamSubset, RangeFinder, Scan};
    use crate::map::Wall;

    use super::LocalSearch;

    fn laser() -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: 0.03,
            bearing_std: 0.004,
            range_min: 0.05,
            range_max: 20.0,
        }
    }

    fn ekf() -> Ekf<f64> {
        Ekf { drive: DiffDrive::new(0.05, 0.6), delta: 0.0025, integration: Integration::Arc }
    }

    /// Walls of the room (0, 0)–(4, 3), the first two of them along x.
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

    /// Noise-free ranges of the 121 beams of a half-circle at (1, 1.2), heading along x.
    fn beams() -> BeamSubset<f64, 128> {
        let step = 1.5_f64.to_radians();
        let ranges: [f64; 121] = core::array::from_fn(|k| {
            let (sin, cos) = (k as f64 * step - core::f64::consts::FRAC_PI_2).sin_cos();
            let leader = if cos > 1e-9 { 3.0 / cos } else { f64::INFINITY };
            let aside = if sin > 0.0 { 1.8 / sin } else { -1.2 / sin };
            leader.min(aside)
        });
        let angle_min = Angle::from_degrees(-90.0);
        BeamSubset::from_scan(&laser(), &Scan::new(angle_min, step, &ranges)).unwrap()
    }

    fn belief(x: f64, y: f64, degrees: f64) -> Belief<f64> {
        Belief::new(Pose::new(x, y, Angle::from_degrees(degrees)), [0.002, 0.002, 0.001])
    }

    fn local_search() -> LocalSearch<f64> {
        LocalSearch::from_scan_std([0.002, 0.002, 0.001])
    }

    #[test]
    fn displacement_is_detected_and_corrected() {
        let truth = belief(1.0, 1.2, 0.0).pose;
        for (x, y, degrees) in [(0.95, 1.2, 0.0), (1.0, 1.28, 0.0), (1.03, 1.16, 3.0)] {
            let displaced = belief(x, y, degrees);
            let (stats, nis) = local_search().evaluate(&ekf(), &beams(), &displaced, &room());
            assert!(stats.hit_ratio() > 0.55, "most beams stay inside their gates: {stats:?}");
            assert!(nis > 9.0, "{nis}");
            let found = local_search().refine(&ekf(), &beams(), &displaced, &room()).unwrap();
            assert!(found.pose.origin().distance(truth.origin()) < 1e-3, "{found:?}");
            assert!((found.pose.heading - truth.heading).radians().abs() < 1e-3, "{found:?}");
            assert!(found.covariance.std(0) < 0.01, "{found:?}");
        }
    }

    #[test]
    fn correct_pose_is_left_unchanged() {
        let (_, nis) = local_search().evaluate(&ekf(), &beams(), &belief(1.0, 1.2, 0.0), &room());
        assert!(nis < 0.01, "{nis}");
        assert_eq!(local_search().refine(&ekf(), &beams(), &belief(1.0, 1.2, 0.0), &room()), None);
    }

    /// Two walls along x give no information on x: its standard deviation remains that of the displacement.
    #[test]
    fn corridor_leaves_its_axis_uncertain() {
        let walls = &room()[..2];
        let found = local_search().refine(&ekf(), &beams(), &belief(1.0, 1.28, 0.0), walls).unwrap();
        assert!((found.pose.y - 1.2).abs() < 1e-3 && found.covariance.std(1) < 0.01, "{found:?}");
        assert!(found.covariance.std(0) > 0.14, "{found:?}");
    }
}
