//! Global localization on an occupancy grid by multiple hypotheses.
//!
//! The first scan is scored at every free position and heading. The best poses become [`PoseHypothesis`]es,
//! which odometry predicts and further scans correct. Their evidence is accumulated along the path. A
//! hypothesis whose evidence is below the best by [`MARGIN`] is dropped. The last one is accepted if it
//! explains the scans: a sequential test [Wald1945] among all hypotheses.

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
/// A surface cell that is not on the map costs at most 3, and a door has nine cells at 10 cm. The margin
/// exceeds three doors that differ from the map and happen to match another pose.
const MARGIN: f64 = 100.0;

/// Minimum fraction of the observed surface that an accepted pose explains.
const EXPLAINED: f64 = 0.6;

/// Maximum fraction of the observed surface behind walls; beyond twice as much an accepted pose is withdrawn.
const BEYOND: f64 = 0.05;

/// Minimum travel \[m] or turn \[rad] between two updates.
const SCAN_EVERY: (f64, f64) = (0.3, 20.0 * PI / 180.0);

/// Minimum standard deviation of the odometry heading \[rad].
const MIN_HEADING_STD: f64 = 0.001;

/// Minimum number of returns of a usable scan.
const MIN_BEAMS: usize = 10;

/// Maximum number of initial hypotheses.
const MAX_HYPOTHESES: usize = 8192;

/// Distance \[m] and angle \[rad] below which two hypotheses are merged.
const MERGE_DISTANCE: (f64, f64) = (0.3, 0.15);

/// Uncertainty of a pose of the initial grid.
const START_UNCERTAINTY: PoseUncertainty = PoseUncertainty { position: 0.5, heading: 0.3 };

/// Global localizer of a robot with a laser on a grid.
#[derive(Debug)]
pub(super) struct GridLocalizer {
    field: LikelihoodField,
    settings: LaserReplaySettings,
    law: LikelihoodTable,
    /// Distance from a wall within which an end point is on it \[m].
    within: f64,
    hypotheses: Vec<PoseHypothesis>,
    surface: SurfaceCells,
    endpoint_history: Vec<ScanEndpoints>,
    /// Consistency of the last remaining hypothesis.
    consistency: ConsistencyCheck,
    odometry_from_body: Pose<Map, Body, f64>,
    /// Odometry pose at the last update.
    last_scan_pose: Option<Pose<Map, Body, f64>>,
    /// Travel \[m] and turn \[rad] since the last update, and the variance of the travel of each rim.
    since: (f64, f64),
    variance: f64,
}

impl GridLocalizer {
    /// Starts without any prior pose.
    pub(super) fn new(grid: &Grid, settings: LaserReplaySettings) -> Self {
        // The wall is anywhere in its cell.
        let std = libm::hypot(settings.range_std, rounding(grid.resolution));
        let field = LikelihoodField::from_grid(grid, std.max(pose_grid::COARSE));
        Self {
            law: field.likelihood_table(std),
            field,
            settings,
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

    /// Predicts by `motion`.
    pub(super) fn predict(&mut self, motion: Motion<f64>) {
        self.odometry_from_body = self.odometry_from_body.integrate(motion, Integration::Arc);
        self.since = (self.since.0 + motion.length.abs(), self.since.1 + motion.turn.abs());
        self.variance += self.settings.wheel_odometry(motion).variance.left;
    }

    /// Updates by a scan if the robot moved enough and the scan is usable; returns whether it did.
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

    /// Returns the pose, if one hypothesis remains and explains the scans.
    pub(super) fn found(&self) -> Option<Pose<Map, Body, f64>> {
        let [place] = self.hypotheses.as_slice() else { return None };
        let ConsistencyShares { hits, behind_wall, .. } = self.consistency.shares();
        (hits >= EXPLAINED && behind_wall <= BEYOND).then(|| self.field.map_from_cells * place.pose)
    }

    /// Returns whether the accepted pose fails to explain later scans.
    pub(super) fn is_inconsistent(&self) -> bool {
        let ConsistencyShares { hits, behind_wall, .. } = self.consistency.shares();
        hits < EXPLAINED || behind_wall > 2.0 * BEYOND
    }

    /// Resets to a uniform prior.
    pub(super) fn reset(&mut self) {
        self.hypotheses.clear();
        self.endpoint_history.clear();
        self.surface = SurfaceCells::new(self.field.resolution());
        self.consistency = ConsistencyCheck::default();
        self.last_scan_pose = None;
    }

    /// Returns the remaining poses, the most likely first.
    pub(super) fn candidates(&self) -> Vec<Pose<Map, Body, f64>> {
        self.hypotheses.iter().map(|known| self.field.map_from_cells * known.pose).collect()
    }

    /// Returns what the most likely hypothesis explains.
    pub(super) fn shares(&self) -> Option<ConsistencyShares> {
        let best = self.hypotheses.first()?;
        let mut consistency = self.consistency.clone();
        consistency.add(&self.field, self.within, &best.trajectory, &self.endpoint_history);
        Some(consistency.shares())
    }

    /// Returns the path of the most likely hypothesis, one pose per update.
    pub(super) fn trajectory(&self) -> Vec<Pose<Map, Body, f64>> {
        let trajectory = self.hypotheses.first().map_or(&[][..], |best| &best.trajectory);
        trajectory.iter().map(|pose| self.field.map_from_cells * *pose).collect()
    }

    /// Returns the odometry uncertainty since the last update, at least the quantization of cells.
    fn uncertainty(&self) -> PoseUncertainty {
        let (rims, wheel_separation) = (2.0 * self.variance, self.settings.wheel_separation);
        let rounded = rounding(self.field.resolution());
        PoseUncertainty {
            position: libm::sqrt(0.25 * rims + rounded * rounded),
            heading: libm::sqrt(rims / (wheel_separation * wheel_separation)).max(MIN_HEADING_STD),
        }
    }

    /// Merges nearby hypotheses and drops those below the best by the margin.
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
                self.consistency.add(&self.field, self.within, &last.trajectory, &self.endpoint_history);
            }
            _ => self.consistency = ConsistencyCheck::default(),
        }
    }
}

/// Returns the standard deviation of a coordinate rounded to a cell \[m].
fn rounding(resolution: f64) -> f64 {
    resolution / libm::sqrt(12.0)
}
