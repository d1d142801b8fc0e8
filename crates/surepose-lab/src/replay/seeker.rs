//! Where a recording begins, if nobody says: every place of an occupancy grid is tried, and followed until one is left.
//!
//! The first scan is held against every free place in every heading. What explains it becomes a [`Hypothesis`], which
//! odometry carries and each further scan puts right; what speaks for it adds up along the way. One that is less likely
//! than the best by the [`MARGIN`] is given up; the last one is the place, if it explains what was seen ([Wald1945]: a
//! sequential test among as many hypotheses as there are places).

mod audit;
mod field;
mod hypothesis;
mod lattice;
mod surface;
#[cfg(test)]
mod tests;

pub(super) use audit::Account;

use std::f64::consts::PI;

use surepose::{Body, Integration, Map, Motion, Pose};
use surepose_data::grid::Grid;
use surepose_data::recording::Scan;

use super::follower::FollowerSettings;
use audit::Audit;
use field::{Field, Law};
use hypothesis::{Hypothesis, Vague, View};
use surface::{Sighting, Surface};

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
const LOOK_EVERY: (f64, f64) = (0.3, 20.0 * PI / 180.0);

/// Odometry's heading is off by so much at least \[rad].
const LEAST_TURN: f64 = 0.001;

/// A scan of which fewer beams came back tells nothing.
const FEWEST_BEAMS: usize = 10;

/// Most hypotheses to begin with.
const MOST: usize = 8192;

/// Hypotheses nearer than this \[m], \[rad] are one.
const SAME: (f64, f64) = (0.3, 0.15);

/// How far off a place of the lattice may be from where the first scan was taken.
const AT_FIRST: Vague = Vague { position: 0.5, heading: 0.3 };

/// Looks for a robot with a laser on a grid.
#[derive(Debug)]
pub(super) struct Seeker {
    field: Field,
    settings: FollowerSettings,
    law: Law,
    /// An end so near to a wall is on it \[m].
    within: f64,
    hypotheses: Vec<Hypothesis>,
    surface: Surface,
    sightings: Vec<Sighting>,
    /// Of the last hypothesis, once one is left.
    audit: Audit,
    odometry_from_body: Pose<Map, Body, f64>,
    /// Where odometry put the robot when it looked last.
    looked_at: Option<Pose<Map, Body, f64>>,
    /// Way \[m] and turn \[rad] since, and the variance of the travel of each rim.
    since: (f64, f64),
    variance: f64,
}

impl Seeker {
    /// Knows nothing but the grid.
    pub(super) fn new(grid: &Grid, settings: FollowerSettings) -> Self {
        // The wall is anywhere in its cell.
        let std = libm::hypot(settings.range_std, rounding(grid.resolution));
        Self {
            field: Field::of(grid, std.max(lattice::COARSE)),
            settings,
            law: Law::scattering(std, grid.resolution),
            within: 2.0 * std,
            hypotheses: Vec::new(),
            surface: Surface::unseen(grid.resolution),
            sightings: Vec::new(),
            audit: Audit::default(),
            odometry_from_body: Pose::identity(),
            looked_at: None,
            since: (0.0, 0.0),
            variance: 0.0,
        }
    }

    /// Rolls on by `motion`.
    pub(super) fn roll(&mut self, motion: Motion<f64>) {
        self.odometry_from_body = self.odometry_from_body.moved(motion, Integration::Arc);
        self.since = (self.since.0 + motion.length.abs(), self.since.1 + motion.turn.abs());
        self.variance += self.settings.travel(motion).variance.left;
    }

    /// Looks at a scan, if the robot moved since it looked last, and anything came back. Returns whether it did.
    pub(super) fn look(&mut self, scan: &Scan) -> bool {
        let moved = self.since.0 >= LOOK_EVERY.0 || self.since.1 >= LOOK_EVERY.1;
        if self.looked_at.is_some() && !moved {
            return false;
        }
        let mut sighting = Sighting::of(scan);
        if sighting.ends.len() < FEWEST_BEAMS {
            return false;
        }
        self.surface.add(self.odometry_from_body, &mut sighting);
        let (motion, vague) = if let Some(before) = self.looked_at {
            (before.inverse() * self.odometry_from_body, self.vague())
        } else {
            let poses = lattice::poses(&self.field, &sighting.ends, MOST);
            self.hypotheses = poses.into_iter().map(Hypothesis::at).collect();
            (Pose::identity(), AT_FIRST)
        };
        let view =
            View { field: &self.field, law: &self.law, sighting: &sighting, pieces: self.surface.len() };
        for hypothesis in &mut self.hypotheses {
            hypothesis.see(motion, vague, &view);
        }
        self.looked_at = Some(self.odometry_from_body);
        (self.since, self.variance) = ((0.0, 0.0), 0.0);
        self.sightings.push(sighting);
        self.choose();
        true
    }

    /// The place, if one is left and explains what was seen.
    pub(super) fn found(&self) -> Option<Pose<Map, Body, f64>> {
        let [place] = self.hypotheses.as_slice() else { return None };
        let Account { explained, beyond, .. } = self.audit.account();
        (explained >= EXPLAINED && beyond <= BEYOND).then(|| self.field.map_from_cells * place.pose)
    }

    /// Whether the place that was found does not explain what was seen since.
    pub(super) fn is_refuted(&self) -> bool {
        let Account { explained, beyond, .. } = self.audit.account();
        explained < EXPLAINED || beyond > 2.0 * BEYOND
    }

    /// Forgets everything but the grid: the robot may be anywhere.
    pub(super) fn start_over(&mut self) {
        self.hypotheses.clear();
        self.sightings.clear();
        self.surface = Surface::unseen(self.field.resolution());
        self.audit = Audit::default();
        self.looked_at = None;
    }

    /// The places that it may be, the likeliest first.
    pub(super) fn places(&self) -> Vec<Pose<Map, Body, f64>> {
        self.hypotheses.iter().map(|known| self.field.map_from_cells * known.pose).collect()
    }

    /// What the likeliest place explains.
    pub(super) fn account(&self) -> Option<Account> {
        let best = self.hypotheses.first()?;
        let mut audit = self.audit.clone();
        audit.add(&self.field, self.within, &best.way, &self.sightings);
        Some(audit.account())
    }

    /// The way on which the likeliest place was reached, from look to look.
    pub(super) fn way(&self) -> Vec<Pose<Map, Body, f64>> {
        let way = self.hypotheses.first().map_or(&[][..], |best| &best.way);
        way.iter().map(|pose| self.field.map_from_cells * *pose).collect()
    }

    /// What odometry may be off by since the last look; places are no finer than the rounding to cells.
    fn vague(&self) -> Vague {
        let (rims, track) = (2.0 * self.variance, self.settings.track);
        let rounded = rounding(self.field.resolution());
        Vague {
            position: libm::sqrt(0.25 * rims + rounded * rounded),
            heading: libm::sqrt(rims / (track * track)).max(LEAST_TURN),
        }
    }

    /// Keeps the likeliest of each place, and gives up those that are worse than the best by the margin.
    fn choose(&mut self) {
        self.hypotheses.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let least = self.hypotheses.first().map_or(0.0, |best| best.evidence) - MARGIN;
        let mut kept: Vec<Hypothesis> = Vec::new();
        for hypothesis in self.hypotheses.drain(..) {
            if hypothesis.evidence >= least && !kept.iter().any(|better| better.is_near(&hypothesis, SAME)) {
                kept.push(hypothesis);
            }
        }
        self.hypotheses = kept;
        match self.hypotheses.as_slice() {
            [last] => self.audit.add(&self.field, self.within, &last.way, &self.sightings),
            _ => self.audit = Audit::default(),
        }
    }
}

/// Standard deviation of a coordinate that is rounded to a cell \[m].
fn rounding(resolution: f64) -> f64 {
    resolution / libm::sqrt(12.0)
}
