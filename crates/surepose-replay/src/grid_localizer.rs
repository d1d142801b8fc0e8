//! Where a recording begins, if nobody says: every place of an occupancy grid is tried, and followed until one is left.
//!
//! The first scan is held against every free place in every heading. What explains it becomes a [`PoseHypothesis`], which
//! odometry carries and each further scan puts right; what speaks for it adds up along the way. One that is less likely
//! than the best by the [`MARGIN`] is given up; the last one is the place, if it explains what was seen ([Wald1945]: a
//! sequential test among as many hypotheses as there are places).

mod consistency;
mod hypothesis;
mod likelihood_field;
mod pose_grid;
mod surface_cells;
#[cfg(test)]
mod tests;

pub(super) use consistency::ConsistencyShares;

use std::f64::consts::PI;

use consistency::ConsistencyCheck;
use hypothesis::{PoseHypothesis, PoseUncertainty, ScanScorer};
use likelihood_field::{LikelihoodField, LikelihoodTable};
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::{Integration, Motion};
use surepose_io::grid::Grid;
use surepose_io::recording::ScanRecord;
use surface_cells::{ScanEndpoints, SurfaceCells};

use super::laser_replay::LaserReplaySettings;

/// By how much the log likelihood of the place must be above that of any other.
///
/// A piece of surface that is not where the map has it takes 3 at most, and a door is nine of them at 10 cm: the margin
/// outweighs three doors that stand otherwise than on the map and by chance as another place has them.
const MARGIN: f64 = 100.0;

/// The place explains at least this part of the surface that was seen.
const EXPLAINED: f64 = 0.6;

/// At most this part was seen where nothing can be seen from there; beyond twice as much the place is withdrawn.
const BEYOND: f64 = 0.05;

/// A robot that is sought looks again after so much way \[m] or turn \[rad].
const SCAN_EVERY: (f64, f64) = (0.3, 20.0 * PI / 180.0);

/// Odometry's heading is off by so much at least \[rad].
const MIN_HEADING_STD: f64 = 0.001;

/// A scan of which fewer beams came back tells nothing.
const MIN_BEAMS: usize = 10;

/// Most hypotheses to begin with.
const MAX_HYPOTHESES: usize = 8192;

/// Hypotheses nearer than this \[m], \[rad] are one.
const MERGE_DISTANCE: (f64, f64) = (0.3, 0.15);

/// How far off a place of the lattice may be from where the first scan was taken.
const START_UNCERTAINTY: PoseUncertainty = PoseUncertainty { position: 0.5, heading: 0.3 };

/// Looks for a robot with a laser on a grid.
#[derive(Debug)]
pub(super) struct GridLocalizer {
    field: LikelihoodField,
    settings: LaserReplaySettings,
    law: LikelihoodTable,
    /// An end so near to a wall is on it \[m].
    within: f64,
    hypotheses: Vec<PoseHypothesis>,
    surface: SurfaceCells,
    endpoint_history: Vec<ScanEndpoints>,
    /// Of the last hypothesis, once one is left.
    consistency: ConsistencyCheck,
    odometry_from_body: Pose<Map, Body, f64>,
    /// Where odometry put the robot when it looked last.
    last_scan_pose: Option<Pose<Map, Body, f64>>,
    /// Way \[m] and turn \[rad] since, and the variance of the travel of each rim.
    since: (f64, f64),
    variance: f64,
}

impl GridLocalizer {
    /// Knows nothing but the grid.
    pub(super) fn new(grid: &Grid, settings: LaserReplaySettings) -> Self {
        // The wall is anywhere in its cell.
        let std = libm::hypot(settings.range_std, rounding(grid.resolution));
        Self {
            field: LikelihoodField::from_grid(grid, std.max(pose_grid::COARSE)),
            settings,
            law: LikelihoodTable::with_std(std, grid.resolution),
            within: 2.0 * std,
            hypotheses: Vec::new(),
            surface: SurfaceCells::new(grid.resolution),
            endpoint_history: Vec::new(),
            consistency: ConsistencyCheck::default(),
            odometry_from_body: Pose::identity(),
            last_scan_pose: None,
            since: (0.0, 0.0),
            variance: 0.0,
        }
    }

    /// Rolls on by `motion`.
    pub(super) fn predict(&mut self, motion: Motion<f64>) {
        self.odometry_from_body = self.odometry_from_body.integrate(motion, Integration::Arc);
        self.since = (self.since.0 + motion.length.abs(), self.since.1 + motion.turn.abs());
        self.variance += self.settings.wheel_odometry(motion).variance.left;
    }

    /// Looks at a scan, if the robot moved since it looked last, and anything came back. Returns whether it did.
    pub(super) fn update(&mut self, scan: &ScanRecord) -> bool {
        let moved = self.since.0 >= SCAN_EVERY.0 || self.since.1 >= SCAN_EVERY.1;
        if self.last_scan_pose.is_some() && !moved {
            return false;
        }
        let mut endpoints = ScanEndpoints::from_scan(scan);
        if endpoints.ends.len() < MIN_BEAMS {
            return false;
        }
        self.surface.add(self.odometry_from_body, &mut endpoints);
        let (motion, uncertainty) = if let Some(before) = self.last_scan_pose {
            (before.inverse() * self.odometry_from_body, self.uncertainty())
        } else {
            let poses = pose_grid::poses(&self.field, &endpoints.ends, MAX_HYPOTHESES);
            self.hypotheses = poses.into_iter().map(PoseHypothesis::at).collect();
            (Pose::identity(), START_UNCERTAINTY)
        };
        let view = ScanScorer {
            field: &self.field,
            law: &self.law,
            endpoints: &endpoints,
            pieces: self.surface.len(),
        };
        for hypothesis in &mut self.hypotheses {
            hypothesis.update(motion, uncertainty, &view);
        }
        self.last_scan_pose = Some(self.odometry_from_body);
        (self.since, self.variance) = ((0.0, 0.0), 0.0);
        self.endpoint_history.push(endpoints);
        self.prune();
        true
    }

    /// The place, if one is left and explains what was seen.
    pub(super) fn found(&self) -> Option<Pose<Map, Body, f64>> {
        let [place] = self.hypotheses.as_slice() else { return None };
        let ConsistencyShares { hits, behind_wall, .. } = self.consistency.shares();
        (hits >= EXPLAINED && behind_wall <= BEYOND).then(|| self.field.map_from_cells * place.pose)
    }

    /// Whether the place that was found does not explain what was seen since.
    pub(super) fn is_inconsistent(&self) -> bool {
        let ConsistencyShares { hits, behind_wall, .. } = self.consistency.shares();
        hits < EXPLAINED || behind_wall > 2.0 * BEYOND
    }

    /// Forgets everything but the grid: the robot may be anywhere.
    pub(super) fn reset(&mut self) {
        self.hypotheses.clear();
        self.endpoint_history.clear();
        self.surface = SurfaceCells::new(self.field.resolution());
        self.consistency = ConsistencyCheck::default();
        self.last_scan_pose = None;
    }

    /// The places that it may be, the likeliest first.
    pub(super) fn candidates(&self) -> Vec<Pose<Map, Body, f64>> {
        self.hypotheses.iter().map(|known| self.field.map_from_cells * known.pose).collect()
    }

    /// What the likeliest place explains.
    pub(super) fn shares(&self) -> Option<ConsistencyShares> {
        let best = self.hypotheses.first()?;
        let mut consistency = self.consistency.clone();
        consistency.add(&self.field, self.within, &best.trajectory, &self.endpoint_history);
        Some(consistency.shares())
    }

    /// The way on which the likeliest place was reached, from look to look.
    pub(super) fn trajectory(&self) -> Vec<Pose<Map, Body, f64>> {
        let trajectory = self.hypotheses.first().map_or(&[][..], |best| &best.trajectory);
        trajectory.iter().map(|pose| self.field.map_from_cells * *pose).collect()
    }

    /// What odometry may be off by since the last look; places are no finer than the rounding to cells.
    fn uncertainty(&self) -> PoseUncertainty {
        let (rims, wheel_separation) = (2.0 * self.variance, self.settings.wheel_separation);
        let rounded = rounding(self.field.resolution());
        PoseUncertainty {
            position: libm::sqrt(0.25 * rims + rounded * rounded),
            heading: libm::sqrt(rims / (wheel_separation * wheel_separation)).max(MIN_HEADING_STD),
        }
    }

    /// Keeps the likeliest of each place, and gives up those that are worse than the best by the margin.
    fn prune(&mut self) {
        self.hypotheses.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let least = self.hypotheses.first().map_or(0.0, |best| best.evidence) - MARGIN;
        let mut kept: Vec<PoseHypothesis> = Vec::new();
        for hypothesis in self.hypotheses.drain(..) {
            if hypothesis.evidence >= least
                && !kept.iter().any(|better| better.is_near(&hypothesis, MERGE_DISTANCE))
            {
                kept.push(hypothesis);
            }
        }
        self.hypotheses = kept;
        match self.hypotheses.as_slice() {
            [last] => {
                self.consistency.add(&self.field, self.within, &last.trajectory, &self.endpoint_history)
            }
            _ => self.consistency = ConsistencyCheck::default(),
        }
    }
}

/// Standard deviation of a coordinate that is rounded to a cell \[m].
fn rounding(resolution: f64) -> f64 {
    resolution / libm::sqrt(12.0)
}
