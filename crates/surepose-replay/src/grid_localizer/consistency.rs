//! Consistency of a hypothesis with the scans, independent of other hypotheses.

use surepose::geometry::{Body, Point, Pose};
use surepose_io::grid::Cells;

use super::likelihood_field::LikelihoodField;
use super::surface_cells::ScanEndpoints;

/// Classification of the surface observed along a path.
#[derive(Clone, Debug, Default)]
pub(super) struct ConsistencyCheck {
    /// Number of beams on each surface cell, by class.
    beam_counts: Vec<[u32; 3]>,
    /// Number of observations counted so far.
    endpoint_history: usize,
}

/// Fractions of the observed surface; each surface cell counts once, and the fractions add up to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ConsistencyShares {
    /// On walls.
    pub(crate) hits: f64,
    /// In free space of the map, in front of walls: people and furniture.
    pub(crate) short: f64,
    /// Behind walls or in unknown space, where the map allows no observation.
    pub(crate) behind_wall: f64,
}

impl ConsistencyCheck {
    /// Counts the new observations of `endpoint_history`, made along `trajectory`.
    pub(super) fn add(
        &mut self,
        field: &LikelihoodField,
        within: f64,
        trajectory: &[Pose<Cells, Body, f64>],
        endpoint_history: &[ScanEndpoints],
    ) {
        for (pose, endpoints) in trajectory.iter().zip(endpoint_history).skip(self.endpoint_history) {
            let laser = *pose * endpoints.laser;
            for (end, piece, _) in endpoints.pieces() {
                if self.beam_counts.len() <= piece {
                    self.beam_counts.resize(piece + 1, [0; 3]);
                }
                self.beam_counts[piece][classify(field, within, laser, *pose * end) as usize] += 1;
            }
            self.endpoint_history += 1;
        }
    }

    /// Returns the fractions so far.
    pub(super) fn shares(&self) -> ConsistencyShares {
        let mut parts = [0.0; 3];
        let mut seen = 0.0;
        for beam_counts in &self.beam_counts {
            let beams = beam_counts.iter().sum::<u32>();
            if beams > 0 {
                seen += 1.0;
                for (part, classify) in parts.iter_mut().zip(beam_counts) {
                    *part += f64::from(*classify) / f64::from(beams);
                }
            }
        }
        let [hits, short, behind_wall] = parts.map(|part| if seen > 0.0 { part / seen } else { 0.0 });
        ConsistencyShares { hits, short, behind_wall }
    }
}

/// Class of a beam, in the order of the counters.
#[derive(Clone, Copy)]
enum BeamClass {
    Hit,
    Short,
    BehindWall,
}

/// Classifies a beam from `laser` to `end`.
fn classify(
    field: &LikelihoodField,
    within: f64,
    laser: Point<Cells, f64>,
    end: Point<Cells, f64>,
) -> BeamClass {
    if field.is_near_wall(field.cell_at(end), within) {
        return BeamClass::Hit;
    }
    let steps = (laser.distance(end) / field.resolution()).ceil().max(1.0) as usize;
    let mut along = (0..=steps).map(|step| {
        let part = step as f64 / steps as f64;
        field.cell_at(Point::new(laser.x + part * (end.x - laser.x), laser.y + part * (end.y - laser.y)))
    });
    if along.all(|cell| field.is_free(cell)) { BeamClass::Short } else { BeamClass::BehindWall }
}
