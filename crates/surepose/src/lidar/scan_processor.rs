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
/// It owns the workspace. From one scan to the next it keeps the roughness of the lines: beams that deviate from their lines by more
/// than the configured noise of the ranges, because of the laser or of the walls, increase the noise of later scans.
#[derive(Clone, Debug)]
pub struct ScanProcessor<S, const BEAMS: usize> {
    /// Configured laser.
    pub laser: RangeFinder<S>,
    /// Model of the comparison.
    pub model: ScanModel<S>,
    extractor: LineExtractor<S, BEAMS>,
    /// Mean square of the deviations of beams from their lines, in variances of the configured noise.
    roughness: S,
}

/// Weight of one scan in the roughness.
const ROUGHNESS_WEIGHT: f64 = 0.2;
/// Roughness up to which the configured noise holds: seven standard deviations of what equal noise gives.
const MIN_ROUGHNESS: f64 = 1.3;
/// Largest roughness: noise of four times the configured standard deviation.
const MAX_ROUGHNESS: f64 = 16.0;

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
        Self { laser, model, extractor: LineExtractor::new(), roughness: S::from_f64(1.0) }
    }

    /// Laser that took `scan`: the configured one, with the noise that its lines show and with the range limits and mounting of the scan where present.
    pub fn laser_of(&self, scan: &Scan<'_, S>) -> RangeFinder<S> {
        let mut laser = self.laser;
        if self.roughness > S::from_f64(MIN_ROUGHNESS) {
            laser.range_std = laser.range_std * self.roughness.sqrt();
        }
        let Some(LaserGeometry { body_from_laser, range_min, range_max }) = scan.geometry else {
            return laser;
        };
        RangeFinder { body_from_laser, range_min, range_max, ..laser }
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
        if let ScanModel::Lines(_) = self.model {
            let used = laser.range_std.squared().div_or_zero(self.laser.range_std.squared());
            self.roughness = updated_roughness(self.roughness, used, &extracted);
        }
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

/// Roughness after a scan from which lines were extracted with the roughness `used`.
fn updated_roughness<S: Float>(before: S, used: S, extracted: &LineExtraction<'_, S>) -> S {
    let zero = S::from_f64(0.0);
    let (mut squares, mut freedom) = (zero, zero);
    for line in extracted.lines {
        let own = S::from_f64(f64::from(line.beams.saturating_sub(2)));
        squares = squares + line.reduced_chi2 * own;
        freedom = freedom + own;
    }
    // Lines that are too rough to be extracted show that, and not by how much.
    let seen = if freedom > zero {
        squares / freedom
    } else if extracted.rejected.not_straight > 0 {
        S::from_f64(4.0)
    } else {
        return before;
    };
    let after = before + (seen * used - before) * S::from_f64(ROUGHNESS_WEIGHT);
    after.max(S::from_f64(1.0)).min(S::from_f64(MAX_ROUGHNESS))
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
