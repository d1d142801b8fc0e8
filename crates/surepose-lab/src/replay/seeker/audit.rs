//! Whether a place explains what was seen from it, whatever other places there are.

use surepose::{Body, Point, Pose};
use surepose_data::grid::Cells;

use super::field::Field;
use super::surface::Sighting;

/// What becomes of the surface that is seen along a way.
#[derive(Clone, Debug, Default)]
pub(super) struct Audit {
    /// Beams on each piece by what became of them.
    fates: Vec<[u32; 3]>,
    /// So many sightings were counted.
    sightings: usize,
}

/// Parts of the surface that was seen, each piece counted once; they add up to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::replay) struct Account {
    /// It lies on walls.
    pub(in crate::replay) explained: f64,
    /// It stands where the map is free, in sight of the laser: people and furniture do.
    pub(in crate::replay) before: f64,
    /// It lies beyond walls, or where the map knows nothing: by the map, nothing can be seen there.
    pub(in crate::replay) beyond: f64,
}

impl Audit {
    /// Counts those of `sightings` that were not counted yet, made along `way`.
    pub(super) fn add(
        &mut self,
        field: &Field,
        within: f64,
        way: &[Pose<Cells, Body, f64>],
        sightings: &[Sighting],
    ) {
        for (pose, sighting) in way.iter().zip(sightings).skip(self.sightings) {
            let laser = *pose * sighting.laser;
            for (end, piece, _) in sighting.pieces() {
                if self.fates.len() <= piece {
                    self.fates.resize(piece + 1, [0; 3]);
                }
                self.fates[piece][fate(field, within, laser, *pose * end) as usize] += 1;
            }
            self.sightings += 1;
        }
    }

    /// The parts of what was counted.
    pub(super) fn account(&self) -> Account {
        let mut parts = [0.0; 3];
        let mut seen = 0.0;
        for fates in &self.fates {
            let beams = fates.iter().sum::<u32>();
            if beams > 0 {
                seen += 1.0;
                for (part, fate) in parts.iter_mut().zip(fates) {
                    *part += f64::from(*fate) / f64::from(beams);
                }
            }
        }
        let [explained, before, beyond] = parts.map(|part| if seen > 0.0 { part / seen } else { 0.0 });
        Account { explained, before, beyond }
    }
}

/// What may become of a beam, in the order in which it is counted.
#[derive(Clone, Copy)]
enum Fate {
    Explained,
    Before,
    Beyond,
}

/// What becomes of a beam from `laser` to `end`.
fn fate(field: &Field, within: f64, laser: Point<Cells, f64>, end: Point<Cells, f64>) -> Fate {
    if field.is_near_wall(field.cell_at(end), within) {
        return Fate::Explained;
    }
    let steps = (laser.distance(end) / field.resolution()).ceil().max(1.0) as usize;
    let mut along = (0..=steps).map(|step| {
        let part = step as f64 / steps as f64;
        field.cell_at(Point::new(laser.x + part * (end.x - laser.x), laser.y + part * (end.y - laser.y)))
    });
    if along.all(|cell| field.is_free(cell)) { Fate::Before } else { Fate::Beyond }
}
