//! A scan laid on the walls of the map: for rooms in which few walls are long enough to be found without a map.
//!
//! [`LineExtractor`](super::LineExtractor) needs six beams and a quarter of a metre to believe in a wall. Offices, and
//! halls full of furniture, have few of those in sight and many short faces. With a map, and a belief that is right to
//! within half a metre, each beam can be given to the wall that it hit, and short faces count too.

mod face;
mod map_beam;
mod start;

use crate::covariance::NotACovariance;
use crate::estimate::{Belief, Ekf, Gate, PoseFix};
use crate::frame::{Laser, Map};
use crate::matrix::Matrix;
use crate::pose::Pose;
use crate::scalar::Float;

use super::scan::{RangeFinder, Scan, ScanRefusal};
use super::wall::Wall;

use face::Face;
use map_beam::MapBeam;

/// How often beams are given to walls anew, each time from the pose that the round before found.
const ROUNDS: usize = 6;

/// In all rounds but this many at the end, the pose is taken to be twice as uncertain as it is found to be.
const SHARP_ROUNDS: usize = 2;

/// What is assumed when a scan is laid on walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aligner<S> {
    /// How far off a wall may be, all its beams together.
    pub gate: Gate<S>,
    /// The farthest that a beam may end from its wall, whatever the belief \[m].
    pub farthest_off: S,
    /// The fewest beams that make a wall count.
    pub fewest_beams: u16,
    /// The least part of the beams that must lie on walls, 0 to 1.
    pub least_share: S,
    /// Standard deviation of a wall's place, on top of what its own covariance says \[m].
    pub wall_offset_std: S,
    /// Standard deviation of a wall's direction, on top of what its own covariance says \[rad].
    pub wall_direction_std: S,
    /// Standard deviations of x \[m], y \[m] and θ \[rad] that all beams of a scan share.
    pub scan_std: [S; 3],
}

/// What a scan says of the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aligned<S> {
    /// The pose, as far as the walls in sight show it.
    pub fix: PoseFix<S>,
    /// How many walls took part.
    pub walls: u16,
    /// How many beams lie on these.
    pub beams: u16,
    /// How many beams came back.
    pub returned: u16,
    /// How many walls had beams but were outside the gate.
    pub refused_walls: u16,
}

/// What came of laying a scan on walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alignment<S> {
    /// It lies on them.
    Found(Aligned<S>),
    /// Too small a part of it does for it to be more than chance.
    Unconvincing(Aligned<S>),
    /// No wall is where a beam ended.
    Nowhere,
}

/// The memory that laying scans of up to `BEAMS` beams on walls needs; it holds nothing from one scan to the next.
#[derive(Clone, Debug)]
pub struct AlignerMemory<S, const BEAMS: usize> {
    beams: [MapBeam<S>; BEAMS],
}

impl<S: Float, const BEAMS: usize> Default for AlignerMemory<S, BEAMS> {
    fn default() -> Self {
        Self { beams: [MapBeam::default(); BEAMS] }
    }
}

/// A scan to be laid on walls, and what is believed before.
struct Task<'a, S> {
    ekf: &'a Ekf<S>,
    belief: &'a Belief<S>,
    laser: &'a RangeFinder<S>,
    walls: &'a [Wall<S>],
    /// The longest beam \[m].
    reach: S,
}

/// Where a scan came to lie.
struct Settled<S> {
    /// How much beams and belief disagree there: squared normalised distances.
    disagreement: S,
    aligned: Aligned<S>,
}

impl<S: Float> Aligner<S> {
    /// Lays `scan` on `walls`, starting at what is believed at the time of the scan.
    ///
    /// Each round gives every beam to the nearest wall that it may have hit, fits an offset and a direction of each
    /// wall to its beams, and moves the pose to where belief and walls agree best. Where the heading is so uncertain
    /// that beams may start at wrong walls, this is done from several headings and the best agreement counts. The
    /// belief serves to find the walls; the fix is what the walls say without it.
    ///
    /// The work is bounded: six rounds for each of at most 21 headings, times beams times walls within reach.
    ///
    /// # Errors
    /// [`ScanRefusal`], before anything is looked at.
    pub fn align<const BEAMS: usize>(
        &self,
        memory: &mut AlignerMemory<S, BEAMS>,
        ekf: &Ekf<S>,
        belief: &Belief<S>,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        walls: &[Wall<S>],
    ) -> Result<Alignment<S>, ScanRefusal> {
        laser.check()?;
        scan.check(BEAMS.min(usize::from(u16::MAX)))?;
        let returned = map_beam::read(laser, scan, &mut memory.beams);
        let beams = &mut memory.beams[..returned];
        let reach = beams.iter().fold(S::of(0.0), |longest, beam| longest.max(beam.range));
        let task = Task { ekf, belief, laser, walls, reach };

        let mut best: Option<Settled<S>> = None;
        for start in start::candidates(belief) {
            let is_better = |settled: &Settled<S>| {
                best.as_ref().is_none_or(|best| settled.disagreement < best.disagreement)
            };
            if let Some(settled) = self.settle(&task, start, beams).filter(is_better) {
                best = Some(settled);
            }
        }
        let enough = self.least_share * S::of(returned as f64);
        Ok(match best.map(|settled| settled.aligned) {
            None => Alignment::Nowhere,
            Some(aligned) if S::of(f64::from(aligned.beams)) < enough => Alignment::Unconvincing(aligned),
            Some(aligned) => Alignment::Found(aligned),
        })
    }

    /// Lets the pose settle from `start` within [`ROUNDS`].
    fn settle(&self, task: &Task<'_, S>, start: Belief<S>, beams: &mut [MapBeam<S>]) -> Option<Settled<S>> {
        let belief = task.belief;
        let mut found = start;
        let mut result = None;
        for round in 0..ROUNDS {
            let known = self.look(task, &found, beams);
            let fix = known.fix(&found).ok().filter(|_| known.walls > 0)?;
            let disagreement = map_beam::misfit(task.laser, beams)
                + belief.covariance.mahalanobis_squared(found.error(belief.pose));
            let aligned = Aligned {
                fix: fix.blurred(self.scan_std.map(S::squared)),
                walls: known.walls,
                beams: known.beams,
                returned: beams.len() as u16,
                refused_walls: known.refused_walls,
            };
            found = task.ekf.correct(*belief, &fix.innovation(belief), S::of(f64::MAX)).belief;
            if round + SHARP_ROUNDS < ROUNDS {
                found.covariance = found.covariance.scaled(S::of(4.0));
            }
            result = Some(Settled { disagreement, aligned });
        }
        result
    }

    /// One round: which beams are on which walls, seen from `found`, and what these say of the pose.
    fn look(&self, task: &Task<'_, S>, found: &Belief<S>, beams: &mut [MapBeam<S>]) -> Knowledge<S> {
        let map_from_laser: Pose<Map, Laser, S> = found.pose * task.laser.body_from_laser;
        map_beam::place(found, map_from_laser, task.laser.range_std, self.farthest_off, beams);
        let within = task.reach + self.farthest_off;
        let numbered = || task.walls.iter().take(usize::from(u16::MAX)).zip(0_u16..);
        for (wall, number) in numbered() {
            if wall.distance(map_from_laser.origin()) < within {
                for beam in beams.iter_mut() {
                    beam.offer(number, wall);
                }
            }
        }
        let mut known = Knowledge::none();
        for (wall, number) in numbered() {
            if wall.distance(map_from_laser.origin()) >= within {
                continue;
            }
            let own = beams.iter().filter(|beam| beam.is_of(number));
            let Some(face) = Face::seen(task.laser, found, wall, own, self.fewest_beams) else { continue };
            let face = face.with_doubt(self.wall_offset_std.squared(), self.wall_direction_std.squared());
            if face.nis(&found.covariance) < self.gate.threshold(2) {
                known.add(&face);
            } else {
                known.refused_walls += 1;
            }
        }
        known
    }
}

/// Sums over walls: the information on the pose, and that times the step they ask for.
struct Knowledge<S> {
    information: Matrix<S, 3, 3>,
    gradient: [S; 3],
    walls: u16,
    beams: u16,
    refused_walls: u16,
}

impl<S: Float> Knowledge<S> {
    fn none() -> Self {
        let gradient = [S::of(0.0); 3];
        Self { information: Matrix::zeros(), gradient, walls: 0, beams: 0, refused_walls: 0 }
    }

    fn add(&mut self, face: &Face<S>) {
        let (information, gradient) = face.says();
        for row in 0..3 {
            for column in 0..3 {
                let sum = self.information[(row, column)] + information[(row, column)];
                self.information[(row, column)] = sum;
            }
            self.gradient[row] = self.gradient[row] + gradient[row];
        }
        self.walls += 1;
        self.beams += face.beams;
    }

    fn fix(&self, found: &Belief<S>) -> Result<PoseFix<S>, NotACovariance> {
        PoseFix::from_information(found.pose, self.information, self.gradient)
    }
}
