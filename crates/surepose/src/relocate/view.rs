//! One scan, held against the map from the places that it may have been taken at.

use crate::estimate::{Belief, Ekf};
use crate::frame::{Body, Map};
use crate::laser::{Glance, Pull, Wall};
use crate::pose::Pose;
use crate::scalar::Float;

use super::Hypothesis;
use super::memory::{BEAMS, Memory};

/// How far a proposal may be off, x and y \[m] and heading \[rad]: ten times what two lines leave open, so that the
/// lines, which are counted again when the hypothesis starts, count a hundredth twice.
const VAGUE: [f64; 3] = [0.15, 0.15, 0.05];

/// How far off a proposal is taken to be while it settles, step by step.
const SETTLING: [[f64; 3]; 3] = [[0.1, 0.1, 0.03], [0.05, 0.05, 0.02], [0.05, 0.05, 0.02]];

/// How far off the place that was found may be, and is taken to be while it settles.
const REACH: [f64; 3] = [0.15, 0.15, 0.1];
const FINDING: [[f64; 3]; 4] =
    [[0.1, 0.1, 0.03], [0.05, 0.05, 0.02], [0.02, 0.02, 0.01], [0.01, 0.01, 0.005]];

/// One scan, and what it is held against.
pub(super) struct View<'a, S, const FRAMES: usize> {
    pub ekf: Ekf<S>,
    pub walls: &'a [Wall<S>],
    pub glance: &'a Glance<S, BEAMS>,
    pub memory: &'a Memory<S, FRAMES>,
}

impl<S: Float, const FRAMES: usize> View<'_, S, FRAMES> {
    /// The hypothesis that the robot is where `belief` says, corrected and judged.
    pub(super) fn judged(&self, belief: Belief<S>, scans: u16) -> Hypothesis<S> {
        let mut pull = Pull::none();
        let pose = belief.pose;
        let _of_before =
            self.glance.pulled_from(pose, &belief.covariance, self.walls, pose.origin(), &mut pull);
        let belief = self.pulled(belief, &pull);
        let now = self.glance.from(belief.pose, &belief.covariance, self.walls);
        let agreement = now.plus(&self.memory.agreement(&self.ekf, belief.pose, self.walls));
        Hypothesis { belief, agreement, scans }
    }

    /// Near `pose`, where all scans in mind fit best; as vague as proposals are.
    pub(super) fn settled(&self, mut pose: Pose<Map, Body, S>) -> Belief<S> {
        for vague in SETTLING {
            let vague = Belief::new(pose, vague.map(S::of));
            let mut pull = Pull::none();
            let _of_before =
                self.glance.pulled_from(pose, &vague.covariance, self.walls, pose.origin(), &mut pull);
            self.memory.pull(pose, &vague.covariance, self.walls, &mut pull);
            pose = self.pulled(vague, &pull).pose;
        }
        Belief::new(pose, VAGUE.map(S::of))
    }

    /// The place near `pose` that all scans in mind ask for, each as far as odometry still ties it to now.
    pub(super) fn found(&self, pose: Pose<Map, Body, S>) -> Belief<S> {
        let prior = Belief::new(pose, REACH.map(S::of));
        let mut found = prior;
        for vague in FINDING {
            // Beams are laid on walls from where the robot seems to be by now, but what they say is said once.
            let near = Belief::new(found.pose, vague.map(S::of));
            let now = self.glance.fix(&near, self.walls).1.ok();
            found = now.into_iter().chain(self.memory.fixes(&near, self.walls)).fold(prior, |belief, fix| {
                self.ekf.correct(belief, &fix.innovation(&belief), S::of(f64::MAX)).belief
            });
        }
        found
    }

    fn pulled(&self, belief: Belief<S>, pull: &Pull<S>) -> Belief<S> {
        // What is not finite pulls nowhere.
        pull.fix(belief.pose)
            .map_or(belief, |fix| self.ekf.correct(belief, &fix.innovation(&belief), S::of(f64::MAX)).belief)
    }
}
