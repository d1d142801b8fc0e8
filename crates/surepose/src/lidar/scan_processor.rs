//! Scans to pose measurements, by one of two models.

use crate::estimation::{Belief, Ekf, Measurement};
use crate::geometry::Pose;
use crate::map::Wall;
use crate::scalar::Float;

use super::beam_model_matcher::{BeamMatch, BeamModelMatcher};
use super::line_associator::{Associations, LineAssociator};
use super::line_extractor::{LineExtraction, LineExtractor};
use super::scan::{LaserGeometry, RangeFinder, Scan, ScanError};

/// Model by which a scan is compared with the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanModel<S> {
    /// Lines are extracted and associated: for places with long flat walls and an exact map of them.
    Lines(LineAssociator<S>),
    /// Each beam ends at the first wall on its ray: for maps of many short walls, for example traced from a grid.
    BeamModel(BeamModelMatcher<S>),
}

/// Compares scans of up to `BEAMS` beams with the walls of the map.
///
/// It owns the workspace and keeps no state from one scan to the next.
#[derive(Clone, Debug)]
pub struct ScanProcessor<S, const BEAMS: usize> {
    /// Configured laser.
    pub laser: RangeFinder<S>,
    /// Model of the comparison.
    pub model: ScanModel<S>,
    extractor: LineExtractor<S, BEAMS>,
}

/// Result of processing one scan.
#[derive(Clone, Copy, Debug)]
pub struct ScanObservation<'a, S> {
    /// Extracted lines.
    pub extracted: LineExtraction<'a, S>,
    /// Associations of the lines; empty for models other than [`ScanModel::Lines`].
    pub associations: Associations<S>,
    /// Result of the beam model; `None` for [`ScanModel::Lines`].
    pub beam_match: Option<BeamMatch<S>>,
}

impl<S: Float, const BEAMS: usize> ScanProcessor<S, BEAMS> {
    /// Processor for this laser.
    pub fn new(laser: RangeFinder<S>, model: ScanModel<S>) -> Self {
        Self { laser, model, extractor: LineExtractor::new() }
    }

    /// Laser that took `scan`: the configured one, with the range limits and mounting of the scan where present.
    pub fn laser_of(&self, scan: &Scan<'_, S>) -> RangeFinder<S> {
        let Some(LaserGeometry { body_from_laser, range_min, range_max }) = scan.geometry else {
            return self.laser;
        };
        RangeFinder { body_from_laser, range_min, range_max, ..self.laser }
    }

    /// Processes `scan`, given the belief at the time of the scan.
    ///
    /// # Errors
    /// [`ScanError`] for a scan or laser that is invalid.
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
        let unmatched = ScanObservation { extracted, associations: Associations::new(), beam_match: None };
        Ok(match &self.model {
            ScanModel::Lines(line_associator) => ScanObservation {
                associations: line_associator.associate(ekf, belief, body_from_laser, extracted.lines, walls),
                ..unmatched
            },
            ScanModel::BeamModel(beam_model_matcher) => ScanObservation {
                beam_match: Some(beam_model_matcher.match_scan(ekf, &laser, scan, belief, walls)?),
                ..unmatched
            },
        })
    }
}

impl<S: Float> ScanProcessor<S, 0> {
    /// Processor of a robot without a laser; it processes no scan.
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
    /// Measurements for the filter.
    pub fn measurements(&self) -> impl Iterator<Item = Measurement<S>> + '_ {
        let pose = self.beam_match.and_then(|matched| matched.fix).map(Measurement::Pose);
        self.associations.measurements().map(|line| Measurement::Line(*line)).chain(pose)
    }
}
