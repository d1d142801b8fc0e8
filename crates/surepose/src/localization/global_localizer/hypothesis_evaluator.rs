//! One scan, held against the map from the places that it may have been taken at.

use crate::estimation::{Belief, Ekf};
use crate::geometry::{Body, Map, Pose};
use crate::lidar::{BeamSubset, PoseNormalEquations};
use crate::map::Wall;
use crate::scalar::Float;

use super::Hypothesis;
use super::keyframes::{BEAMS, KeyframeBuffer};

/// How far a proposal may be off, x and y \[m] and heading \[rad]: ten times what two lines leave open, so that the
/// lines, which are counted again when the hypothesis starts, count a hundredth twice.
const PROPOSAL_STD: [f64; 3] = [0.15, 0.15, 0.05];

/// How far off a proposal is taken to be while it settles, step by step.
const LINEARIZATION_STD: [[f64; 3]; 3] = [[0.1, 0.1, 0.03], [0.05, 0.05, 0.02], [0.05, 0.05, 0.02]];

/// How far off the place that was found may be, and is taken to be while it settles.
const PRIOR_STD: [f64; 3] = [0.15, 0.15, 0.1];
const FINAL_LINEARIZATION_STD: [[f64; 3]; 4] =
    [[0.1, 0.1, 0.03], [0.05, 0.05, 0.02], [0.02, 0.02, 0.01], [0.01, 0.01, 0.005]];

/// One scan, and what it is held against.
pub(super) struct HypothesisEvaluator<'a, S, const FRAMES: usize> {
    pub ekf: Ekf<S>,
    pub walls: &'a [Wall<S>],
    pub beams: &'a BeamSubset<S, BEAMS>,
    pub keyframes: &'a KeyframeBuffer<S, FRAMES>,
}

impl<S: Float, const FRAMES: usize> HypothesisEvaluator<'_, S, FRAMES> {
    /// The hypothesis that the robot is where `belief` says, corrected and judged.
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

    /// Near `pose`, where all keyframes fit best; as vague as proposals are.
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

    /// The place near `pose` that all keyframes ask for, each as far as odometry still ties it to now.
    pub(super) fn refine_accepted(&self, pose: Pose<Map, Body, S>) -> Belief<S> {
        let prior = Belief::new(pose, PRIOR_STD.map(S::from_f64));
        let mut found = prior;
        for uncertain in FINAL_LINEARIZATION_STD {
            // Beams are laid on walls from where the robot seems to be by now, but what they say is said once.
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
        // What is not finite pulls nowhere.
        equations.solve(belief.pose).map_or(belief, |fix| {
            self.ekf.correct(belief, &fix.innovation(&belief), S::from_f64(f64::MAX)).belief
        })
    }
}
