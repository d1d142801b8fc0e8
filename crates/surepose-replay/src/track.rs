//! Estimated trajectory of a replay, and its errors against the reference.

use serde::Serialize;
use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose::linalg::Covariance;
use surepose_sim::{ErrorAccumulator, ErrorSummary};

/// Path length over which the relative pose error is evaluated \[m].
const RELATIVE_DISTANCE: f64 = 1.0;

/// Estimate at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Time \[s], or the number of odometry records for recordings whose stamps are too coarse.
    pub time: f64,
    /// Estimated pose.
    pub pose: Pose<Map, Body, f64>,
    /// Standard deviations of x \[m], y \[m] and θ \[rad].
    pub std: [f64; 3],
    /// Reference pose; `None` where there is none.
    pub truth: Option<Pose<Map, Body, f64>>,
    /// Normalized estimation error squared; `None` where the estimate is not judged.
    pub nees: Option<f64>,
    /// Whether the localizer trusts the estimate; `false` while lost or contradicted by scans.
    pub is_trusted: bool,
}

/// Trajectory of a replay, with what a picture of it needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// Estimates, by time.
    pub points: Vec<TrackPoint>,
    /// Walls of the map, by their ends \[m].
    pub walls: Vec<[(f64, f64); 2]>,
    /// End points of beams at the estimated poses \[m].
    pub beam_ends: Vec<(f64, f64)>,
    /// Standard deviations of the map and the reference: x \[m], y \[m], θ \[rad]. The NEES includes them.
    pub reference_std: [f64; 3],
}

/// Absolute pose error, without alignment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AbsolutePoseError {
    /// Root mean square of the position error \[m].
    pub rmse_m: f64,
    /// Mean \[m].
    pub mean_m: f64,
    /// Largest \[m].
    pub max_m: f64,
    /// Root mean square of the heading error \[°].
    pub rmse_deg: f64,
}

/// Relative pose error over a path of fixed length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RelativePoseError {
    /// Length of the reference path \[m].
    pub delta_m: f64,
    /// Root mean square of the position error \[m].
    pub rmse_m: f64,
    /// Root mean square of the heading error \[°].
    pub rmse_deg: f64,
}

impl Track {
    /// Adds the estimate at `time`; it is judged where there is a truth and the estimate is trusted.
    pub fn add(
        &mut self,
        time: f64,
        belief: &Belief<f64>,
        truth: Option<Pose<Map, Body, f64>>,
        is_trusted: bool,
    ) {
        let nees = truth.filter(|_| is_trusted).map(|truth| self.nees(belief, truth));
        let std = [0, 1, 2].map(|axis| belief.covariance.std(axis));
        self.points.push(TrackPoint { time, pose: belief.pose, std, truth, nees, is_trusted });
    }

    fn nees(&self, belief: &Belief<f64>, truth: Pose<Map, Body, f64>) -> f64 {
        let mut matrix = belief.covariance.matrix();
        for (axis, std) in self.reference_std.iter().enumerate() {
            matrix.0[axis][axis] += std * std;
        }
        let covariance = Covariance::from_matrix(&matrix).unwrap_or(belief.covariance);
        covariance.mahalanobis_squared(belief.error(truth))
    }

    /// Judged points with their errors: x \[m], y \[m], θ \[rad].
    fn judged(&self) -> impl Iterator<Item = (&TrackPoint, Pose<Map, Body, f64>, f64)> {
        self.points.iter().filter_map(|point| Some((point, point.truth?, point.nees?)))
    }

    /// Statistics of the errors; `None` if no estimate is judged.
    pub fn summary(&self) -> Option<ErrorSummary> {
        let mut errors = ErrorAccumulator::default();
        for (point, truth, nees) in self.judged() {
            errors.add(error(point.pose, truth));
            errors.add_nees(nees);
        }
        errors.summary()
    }

    /// Absolute pose error; `None` if no estimate is judged.
    pub fn absolute_error(&self) -> Option<AbsolutePoseError> {
        let errors: Vec<_> = self.judged().map(|(point, truth, _)| error(point.pose, truth)).collect();
        let count = (!errors.is_empty()).then_some(errors.len() as f64)?;
        let distances = || errors.iter().map(|[x, y, _]| libm::hypot(*x, *y));
        Some(AbsolutePoseError {
            rmse_m: libm::sqrt(distances().map(|it| it * it).sum::<f64>() / count),
            mean_m: distances().sum::<f64>() / count,
            max_m: distances().fold(0.0, f64::max),
            rmse_deg: libm::sqrt(errors.iter().map(|[.., it]| it * it).sum::<f64>() / count).to_degrees(),
        })
    }

    /// Relative pose error over one meter of the reference path; `None` if the judged path is shorter.
    pub fn relative_error(&self) -> Option<RelativePoseError> {
        let judged: Vec<_> = self.judged().collect();
        let mut length = 0.0;
        let along: Vec<f64> = std::iter::once(0.0)
            .chain(judged.windows(2).map(|pair| {
                length += pair[0].1.origin().distance(pair[1].1.origin());
                length
            }))
            .collect();
        let (mut position, mut heading, mut count) = (0.0, 0.0, 0.0);
        for (from, start) in judged.iter().zip(&along) {
            let end = along.partition_point(|at| *at < start + RELATIVE_DISTANCE);
            let Some(to) = judged.get(end) else { break };
            let relative = |from: Pose<Map, Body, f64>, to| from.inverse() * to;
            let (estimated, true_motion) = (relative(from.0.pose, to.0.pose), relative(from.1, to.1));
            position += (estimated.x - true_motion.x).powi(2) + (estimated.y - true_motion.y).powi(2);
            heading += (estimated.heading - true_motion.heading).radians().powi(2);
            count += 1.0;
        }
        (count > 0.0).then(|| RelativePoseError {
            delta_m: RELATIVE_DISTANCE,
            rmse_m: libm::sqrt(position / count),
            rmse_deg: libm::sqrt(heading / count).to_degrees(),
        })
    }

    /// Fraction of the recording in which the estimate was judged; `None` without reference.
    ///
    /// `reference_interval` \[s] is the median interval of the reference: a slow reference allows fewer judgments than there are
    /// estimates. 0 requires a judgment of every estimate.
    pub fn judged_share(&self, reference_interval: f64) -> Option<f64> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        let possible = if reference_interval > 0.0 {
            ((last.time - first.time) / reference_interval + 1.0).min(self.points.len() as f64)
        } else {
            self.points.len() as f64
        };
        Some((self.judged().count() as f64 / possible.max(1.0)).min(1.0))
    }
}

fn error(pose: Pose<Map, Body, f64>, truth: Pose<Map, Body, f64>) -> [f64; 3] {
    [pose.x - truth.x, pose.y - truth.y, (pose.heading - truth.heading).radians()]
}

#[cfg(test)]
mod tests {
    use surepose::geometry::Angle;

    use super::*;

    fn pose(x: f64, y: f64) -> Pose<Map, Body, f64> {
        Pose::new(x, y, Angle::zero())
    }

    fn track(points: &[(f64, Option<f64>, bool)]) -> Track {
        let mut track = Track::default();
        for (time, y, is_trusted) in points {
            let belief = Belief::new(pose(*time, 0.0), [0.1; 3]);
            track.add(*time, &belief, y.map(|y| pose(*time, y)), *is_trusted);
        }
        track
    }

    #[test]
    fn constant_offset_is_an_absolute_error_only() {
        let track = track(&[(0.0, Some(0.2), true), (1.0, Some(0.2), true), (2.0, Some(0.2), true)]);
        let (absolute, relative) = (track.absolute_error().unwrap(), track.relative_error().unwrap());
        assert!((absolute.rmse_m - 0.2).abs() < 1e-12 && (absolute.max_m - 0.2).abs() < 1e-12);
        assert!(relative.rmse_m < 1e-12 && relative.rmse_deg < 1e-12);
        assert!(track.points.iter().all(|point| (point.nees.unwrap() - 4.0).abs() < 1e-9));
    }

    #[test]
    fn untrusted_estimates_are_not_judged() {
        let track = track(&[
            (0.0, Some(0.0), true),
            (1.0, Some(9.0), false),
            (2.0, None, true),
            (3.0, Some(0.0), true),
        ]);
        assert!(track.absolute_error().unwrap().max_m < 1e-12);
        assert_eq!(track.judged_share(0.0), Some(0.5));
        // A reference every 3 s allows two judgments.
        assert_eq!(track.judged_share(3.0), Some(1.0));
    }

    #[test]
    fn noise_of_the_reference_is_part_of_the_nees() {
        let mut track = Track { reference_std: [0.1, 0.1, 0.0], ..Track::default() };
        track.add(0.0, &Belief::new(pose(0.0, 0.0), [0.1; 3]), Some(pose(0.0, 0.2)), true);
        assert!((track.points[0].nees.unwrap() - 2.0).abs() < 1e-9);
    }
}
