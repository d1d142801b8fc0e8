//! From a scan to measurements of the pose, by one of three ways to know walls again.

use crate::estimate::{Belief, Ekf, Measurement, PoseFix};
use crate::pose::Pose;
use crate::scalar::Float;

use super::align::{Aligner, AlignerMemory, Alignment};
use super::extract::{Extracted, LineExtractor};
use super::matching::{Matched, Matcher};
use super::rays::Rays;
use super::scan::{RangeFinder, Scan, ScanRefusal};
use super::wall::Wall;

/// How walls of the map are known again in a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Recognition<S> {
    /// Lines are found in it and matched: for places with long flat walls, and a map that has them exactly.
    Lines(Matcher<S>),
    /// It is laid on the walls beam by beam, each on the nearest: for maps of few walls in cluttered rooms.
    Beams(Aligner<S>),
    /// Each beam ends at the first wall in its way: for maps of many short walls, traced from a grid for instance.
    Rays(Rays<S>),
}

/// Reads scans of up to `BEAMS` beams against the walls of the map.
///
/// It holds the memory that the work needs, and nothing from one scan to the next.
#[derive(Clone, Debug)]
pub struct Eye<S, const BEAMS: usize> {
    /// What takes the scans.
    pub laser: RangeFinder<S>,
    /// How walls are known again.
    pub recognition: Recognition<S>,
    extractor: LineExtractor<S, BEAMS>,
    memory: AlignerMemory<S, BEAMS>,
}

/// What was seen in a scan.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a, S> {
    /// The lines in it.
    pub extracted: Extracted<'a, S>,
    /// Which walls they are; none are asked for where beams are.
    pub matched: Matched<S>,
    /// How it lies on the walls, where beams are asked for.
    pub alignment: Option<Alignment<S>>,
    /// The pose that the rays ask for, where they are asked and enough of them are explained.
    pub fix: Option<PoseFix<S>>,
}

impl<S: Float, const BEAMS: usize> Eye<S, BEAMS> {
    /// The eye for this laser.
    pub fn new(laser: RangeFinder<S>, recognition: Recognition<S>) -> Self {
        Self { laser, recognition, extractor: LineExtractor::new(), memory: AlignerMemory::default() }
    }

    /// What `scan` says, given the belief of where the robot was when it was taken.
    ///
    /// # Errors
    /// [`ScanRefusal`], before anything is looked at.
    pub fn see(
        &mut self,
        ekf: &Ekf<S>,
        belief: &Belief<S>,
        scan: &Scan<'_, S>,
        walls: &[Wall<S>],
    ) -> Result<Seen<'_, S>, ScanRefusal> {
        let extracted = self.extractor.extract(&self.laser, scan)?;
        let mount = &self.laser.body_from_laser;
        let nothing = Seen { extracted, matched: Matched::none(), alignment: None, fix: None };
        Ok(match &self.recognition {
            Recognition::Lines(matcher) => {
                Seen { matched: matcher.matched(ekf, belief, mount, extracted.lines, walls), ..nothing }
            }
            Recognition::Beams(aligner) => {
                let aligned = aligner.align(&mut self.memory, ekf, belief, &self.laser, scan, walls)?;
                Seen { alignment: Some(aligned), ..nothing }
            }
            Recognition::Rays(rays) => Seen { fix: rays.fix(&self.laser, scan, belief, walls)?, ..nothing },
        })
    }
}

impl<S: Float> Eye<S, 0> {
    /// The eye of a robot without a laser: it reads no scan.
    pub fn blind() -> Self {
        let zero = S::of(0.0);
        let nothing = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: zero,
            bearing_std: zero,
            nearest: zero,
            farthest: zero,
        };
        Self::new(nothing, Recognition::Lines(Matcher::default()))
    }
}

impl<S: Float> Seen<'_, S> {
    /// What the filter is to be told.
    pub fn measurements(&self) -> impl Iterator<Item = Measurement<S>> + '_ {
        let aligned = match self.alignment {
            Some(Alignment::Found(aligned)) => Some(aligned.fix),
            _ => None,
        };
        let poses = aligned.into_iter().chain(self.fix).map(Measurement::Pose);
        self.matched.sightings().map(|sighting| Measurement::Wall(*sighting)).chain(poses)
    }
}
