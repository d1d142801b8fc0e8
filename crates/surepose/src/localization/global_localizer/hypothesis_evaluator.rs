//! Evaluation and refinement of hypotheses with the present scan and the keyframes.

use crate::estimation::{Belief, Ekf};
use crate::geometry::{Body, Map, Pose};
use crate::lidar::{BeamStats, BeamSubset, PoseNormalEquations};
use crate::map::Wall;
use crate::scalar::Float;

use super::keyframes::{BEAMS, KeyframeBuffer};

/// A candidate pose of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hypothesis<S> {
    /// Pose and its covariance under this hypothesis, at the time of the last scan.
    pub belief: Belief<S>,
    /// Agreement of the last scan and the keyframes with the map.
    pub stats: BeamStats<S>,
    /// Number of scans that the hypothesis has lasted.
    pub scans: u16,
}

/// Standard deviation of a proposal, x and y \[m] and heading \[rad]: ten times that of a pose from two lines. The
/// lines count again when the hypothesis starts; the factor limits the double counting to 1 %.
const PROPOSAL_STD: [f64; 3] = [0.15, 0.15, 0.05];

/// Pose uncertainty in each iteration of the refinement of a proposal.
const LINEARIZATION_STD: [[f64; 3]; 3] = [[0.1, 0.1, 0.03], [0.05, 0.05, 0.02], [0.05, 0.05, 0.02]];

/// Standard deviation of an accepted pose before the final refinement, and the pose uncertainty in each of its
/// iterations.
const PRIOR_STD: [f64; 3] = [0.15, 0.15, 0.1];
const FINAL_LINEARIZATION_STD: [[f64; 3]; 4] =
    [[0.1, 0.1, 0.03], [0.05, 0.05, 0.02], [0.02, 0.02, 0.01], [0.01, 0.01, 0.005]];

/// The present scan, the keyframes and the map.
pub(super) struct HypothesisEvaluator<'a, S, const FRAMES: usize> {
    pub ekf: Ekf<S>,
    pub walls: &'a [Wall<S>],
    pub beams: &'a BeamSubset<S, BEAMS>,
    pub keyframes: &'a KeyframeBuffer<S, FRAMES>,
}

impl<S: Float, const FRAMES: usize> HypothesisEvaluator<'_, S, FRAMES> {
    /// Corrects `belief` by the scan and evaluates the agreement with all scans.
    pub(super) fn evaluate(&self, belief: Belief<S>, scans: u16) -> Hypothesis<S> {
        let mut equations = PoseNormalEquations::new();
        let pose = belief.pose;
        let _prior_stats =
            self.beams.linearize(pose, &belief.covariance, self.walls, pose.origin(), &mut equations);
        let belief = self.corrected(belief, &equations);
        let now = self.beams.evaluate(belief.pose, &belief.covariance, self.walls);
        let stats = now.plus(&self.keyframes.evaluate(&self.ekf, belief.pose, self.walls));
        Hypothesis { belief, stats, scans }
    }

    /// Refines `pose` with all keyframes; the covariance is that of a proposal.
    pub(super) fn refine(&self, mut pose: Pose<Map, Body, S>) -> Belief<S> {
        for uncertain in LINEARIZATION_STD {
            let uncertain = Belief::new(pose, uncertain.map(S::from_f64));
            let mut equations = PoseNormalEquations::new();
            let _prior_stats =
                self.beams.linearize(pose, &uncertain.covariance, self.walls, pose.origin(), &mut equations);
            self.keyframes.linearize(pose, &uncertain.covariance, self.walls, &mut equations);
            pose = self.corrected(uncertain, &equations).pose;
        }
        Belief::new(pose, PROPOSAL_STD.map(S::from_f64))
    }

    /// Refines an accepted `pose` with all keyframes, each weighted by the odometry drift since then.
    pub(super) fn refine_accepted(&self, pose: Pose<Map, Body, S>) -> Belief<S> {
        let prior = Belief::new(pose, PRIOR_STD.map(S::from_f64));
        let mut found = prior;
        for uncertain in FINAL_LINEARIZATION_STD {
            // The beams are linearized at the present estimate, but their information enters only once.
            let near = Belief::new(found.pose, uncertain.map(S::from_f64));
            let now = self.beams.measure_pose(&near, self.walls).1.ok();
            found = now.into_iter().chain(self.keyframes.pose_measurements(&near, self.walls)).fold(
                prior,
                |belief, fix| {
                    self.ekf.correct(belief, &fix.innovation(&belief), S::from_f64(f64::MAX)).belief
                },
            );
        }
        found
    }

    fn corrected(&self, belief: Belief<S>, equations: &PoseNormalEquations<S>) -> Belief<S> {
        // Where the equations are not finite, the belief is unchanged.
        equations.solve(belief.pose).map_or(belief, |fix| {
            self.ekf.correct(belief, &fix.innovation(&belief), S::from_f64(f64::MAX)).belief
        })
    }
}
