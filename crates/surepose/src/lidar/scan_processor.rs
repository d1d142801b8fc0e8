//! From a scan to measurements of the pose, by one of three ways to know walls again.

use crate::estimation::{Belief, Ekf, Measurement, PoseMeasurement};
use crate::geometry::Pose;
use crate::map::Wall;
use crate::scalar::Float;

use super::beam_model_matcher::BeamModelMatcher;
use super::line_associator::{Associations, LineAssociator};
use super::line_extractor::{LineExtraction, LineExtractor};
use super::scan::{LaserGeometry, RangeFinder, Scan, ScanError};
use super::scan_matcher::{ScanMatch, ScanMatcher, ScanMatcherWorkspace};

/// How walls of the map are known again in a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanModel<S> {
    /// Lines are found in it and matched: for places with long flat walls, and a map that has them exactly.
    Lines(LineAssociator<S>),
    /// It is laid on the walls beam by beam, each on the nearest: for maps of few walls in cluttered rooms.
    ScanMatch(ScanMatcher<S>),
    /// Each beam ends at the first wall in its way: for maps of many short walls, traced from a grid for instance.
    BeamModel(BeamModelMatcher<S>),
}

/// Reads scans of up to `BEAMS` beams against the walls of the map.
///
/// It holds the workspace that the work needs, and nothing from one scan to the next.
#[derive(Clone, Debug)]
pub struct ScanProcessor<S, const BEAMS: usize> {
    /// What takes the scans.
    pub laser: RangeFinder<S>,
    /// How walls are known again.
    pub model: ScanModel<S>,
    extractor: LineExtractor<S, BEAMS>,
    workspace: ScanMatcherWorkspace<S, BEAMS>,
}

/// What was seen in a scan.
#[derive(Clone, Copy, Debug)]
pub struct ScanObservation<'a, S> {
    /// The lines in it.
    pub extracted: LineExtraction<'a, S>,
    /// Which walls they are; none are asked for where beams are.
    pub associations: Associations<S>,
    /// How it lies on the walls, where beams are asked for.
    pub scan_match: Option<ScanMatch<S>>,
    /// The pose by the beam model; `None` for other models, and where too few beams are hits.
    pub fix: Option<PoseMeasurement<S>>,
}

impl<S: Float, const BEAMS: usize> ScanProcessor<S, BEAMS> {
    /// A processor for this laser.
    pub fn new(laser: RangeFinder<S>, model: ScanModel<S>) -> Self {
        Self { laser, model, extractor: LineExtractor::new(), workspace: ScanMatcherWorkspace::default() }
    }

    /// The laser that took `scan`: that of the processor, with the scan's own reach and mounting where it has them.
    pub fn laser_of(&self, scan: &Scan<'_, S>) -> RangeFinder<S> {
        let Some(LaserGeometry { body_from_laser, range_min, range_max }) = scan.geometry else {
            return self.laser;
        };
        RangeFinder { body_from_laser, range_min, range_max, ..self.laser }
    }

    /// What `scan` says, given the belief of where the robot was when it was taken.
    ///
    /// # Errors
    /// [`ScanError`], before anything is looked at.
    pub fn process(
        &mut self,
        ekf: &Ekf<S>,
        belief: &Belief<S>,
        scan: &Scan<'_, S>,
        walls: &[Wall<S>],
    ) -> Result<ScanObservation<'_, S>, ScanError> {
        let laser = self.laser_of(scan);
        let extracted = self.extractor.extract(&laser, scan)?;
        let body_from_laser = &laser.body_from_laser;
        let unmatched =
            ScanObservation { extracted, associations: Associations::new(), scan_match: None, fix: None };
        Ok(match &self.model {
            ScanModel::Lines(line_associator) => ScanObservation {
                associations: line_associator.associate(ekf, belief, body_from_laser, extracted.lines, walls),
                ..unmatched
            },
            ScanModel::ScanMatch(scan_matcher) => {
                let matched =
                    scan_matcher.match_scan(&mut self.workspace, ekf, belief, &laser, scan, walls)?;
                ScanObservation { scan_match: Some(matched), ..unmatched }
            }
            ScanModel::BeamModel(beam_model_matcher) => ScanObservation {
                fix: beam_model_matcher.match_scan(&laser, scan, belief, walls)?,
                ..unmatched
            },
        })
    }
}

impl<S: Float> ScanProcessor<S, 0> {
    /// The processor of a robot without a laser: it reads no scan.
    pub fn disabled() -> Self {
        let zero = S::from_f64(0.0);
        let unmatched = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: zero,
            bearing_std: zero,
            range_min: zero,
            range_max: zero,
        };
        Self::new(unmatched, ScanModel::Lines(LineAssociator::default()))
    }
}

impl<S: Float> ScanObservation<'_, S> {
    /// What the filter is to be told.
    pub fn measurements(&self) -> impl Iterator<Item = Measurement<S>> + '_ {
        let matched = match self.scan_match {
            Some(ScanMatch::Matched(matched)) => Some(matched.fix),
            _ => None,
        };
        let poses = matched.into_iter().chain(self.fix).map(Measurement::Pose);
        self.associations.measurements().map(|line| Measurement::Line(*line)).chain(poses)
    }
}
