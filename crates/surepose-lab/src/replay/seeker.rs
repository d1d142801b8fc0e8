//! Where a recording begins, if nobody says: the core's relocaliser on odometry and scans.

use surepose::{Belief, Certainty, Finding, Hypothesis, Motion, Relocaliser, Stamp, Wall};
use surepose_data::recording;

use super::follower::{FollowerSettings, scan_of};
use crate::survey::Survey;

/// The most hypotheses: rooms of one building look more alike than a room looks like itself.
const HYPOTHESES: usize = 32;

/// How many scans are remembered: a corridor tells its places apart by what lies at its ends.
const FRAMES: usize = 64;

/// Looks for a robot with a laser among known walls.
#[derive(Debug)]
pub(super) struct Seeker<'a> {
    relocaliser: Box<Relocaliser<f64, HYPOTHESES, FRAMES>>,
    settings: FollowerSettings,
    walls: &'a [Wall<f64>],
    survey: &'a Survey,
}

impl<'a> Seeker<'a> {
    /// Knows nothing at `stamp`.
    pub(super) fn new(
        walls: &'a [Wall<f64>],
        survey: &'a Survey,
        settings: FollowerSettings,
        certainty: Certainty<f64>,
        stamp: Stamp,
    ) -> Self {
        let relocaliser = Box::new(Relocaliser::new(settings.ekf(), certainty, stamp));
        Self { relocaliser, settings, walls, survey }
    }

    /// Rolls on by `motion` until `stamp`.
    pub(super) fn roll(&mut self, stamp: Stamp, motion: Motion<f64>) {
        self.relocaliser.roll(stamp, self.settings.travel(motion));
    }

    /// Where the robot is, if a scan that was taken at `stamp` leaves one place only.
    pub(super) fn see(&mut self, stamp: Stamp, scan: &recording::Scan) -> Option<Belief<f64>> {
        let (laser, chart) = (self.settings.laser(scan.mount), self.survey.chart());
        match self.relocaliser.look(stamp, &laser, &scan_of(scan), &[], self.walls, chart.as_ref()) {
            Finding::Found(belief) => Some(belief),
            Finding::Nothing | Finding::Several(_) => None,
        }
    }

    /// The places that it may be, the likeliest first.
    pub(super) fn hypotheses(&self) -> Vec<Hypothesis<f64>> {
        let mut known: Vec<_> = self.relocaliser.hypotheses().copied().collect();
        known.sort_by(|a, b| a.agreement.misfit.total_cmp(&b.agreement.misfit));
        known
    }
}
