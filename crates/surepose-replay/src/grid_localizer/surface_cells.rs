//! What was seen of the surfaces around: pieces as large as a cell of the grid, each with the number of beams that ended
//! there.
//!
//! A wall that is looked at for a minute says no more than one that is looked at once: what makes its beams end where the
//! map has no wall, a door that stands otherwise or a cupboard that was moved, is there each time. So a piece counts once
//! however often it is seen. Pieces are told apart by where odometry puts them, which is the same for all hypotheses.

use std::collections::HashMap;

use surepose::geometry::{Body, Map, Point, Pose};
use surepose_io::recording::{ScanRecord, laser_extrinsics};

use crate::laser_replay::{MAX_RANGE, MIN_RANGE};

/// The most beams of a scan that are looked at.
const MAX_BEAMS: usize = 128;

/// The beams of one scan.
#[derive(Clone, Debug)]
pub(super) struct ScanEndpoints {
    /// Where the laser is.
    pub(super) laser: Point<Body, f64>,
    /// Where beams ended.
    pub(super) ends: Vec<Point<Body, f64>>,
    /// Which piece of surface each of them is, and how many beams had ended there by then.
    pieces: Vec<(usize, u32)>,
}

impl ScanEndpoints {
    /// An even selection of the beams of `scan` that came back.
    pub(super) fn from_scan(scan: &ScanRecord) -> Self {
        let body_from_laser = laser_extrinsics(scan.mount);
        let beams = scan.ranges.iter().enumerate().step_by(scan.ranges.len().div_ceil(MAX_BEAMS).max(1));
        let ends =
            beams.filter(|(_, range)| (MIN_RANGE..MAX_RANGE).contains(*range)).map(|(number, range)| {
                let (sin, cos) = scan.angle(number).sin_cos();
                body_from_laser * Point::new(range * cos, range * sin)
            });
        Self { laser: body_from_laser.origin(), ends: ends.collect(), pieces: Vec::new() }
    }

    /// Where each beam ended, its piece of surface, and how many beams had ended there by then.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (Point<Body, f64>, usize, u32)> {
        self.ends.iter().zip(&self.pieces).map(|(end, (piece, count))| (*end, *piece, *count))
    }
}

/// All pieces of surface that were seen.
#[derive(Clone, Debug)]
pub(super) struct SurfaceCells {
    /// Side of a piece \[m].
    side: f64,
    pieces: HashMap<(i32, i32), usize>,
    beams: Vec<u32>,
}

impl SurfaceCells {
    /// Nothing was seen yet; pieces will have this side \[m].
    pub(super) fn new(side: f64) -> Self {
        Self { side, pieces: HashMap::new(), beams: Vec::new() }
    }

    /// How many pieces were seen.
    pub(super) fn len(&self) -> usize {
        self.beams.len()
    }

    /// Adds what was seen from where odometry puts the robot.
    pub(super) fn add(&mut self, odometry_from_body: Pose<Map, Body, f64>, endpoints: &mut ScanEndpoints) {
        endpoints.pieces.clear();
        for end in &endpoints.ends {
            let at = odometry_from_body * *end;
            let place = ((at.x / self.side).floor() as i32, (at.y / self.side).floor() as i32);
            let piece = *self.pieces.entry(place).or_insert(self.beams.len());
            if piece == self.beams.len() {
                self.beams.push(0);
            }
            self.beams[piece] += 1;
            endpoints.pieces.push((piece, self.beams[piece]));
        }
    }
}
