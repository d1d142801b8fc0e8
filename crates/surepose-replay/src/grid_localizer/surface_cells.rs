//! Observed surface, divided into cells with beam counts.
//!
//! Repeated observations of a surface are not independent: a door or a cupboard that differs from the map is
//! wrong in every scan. Each surface cell therefore counts once. Cells are identified by their odometry
//! position, which is the same for all hypotheses.

use std::collections::HashMap;

use surepose::geometry::{Body, Map, Point, Pose};
use surepose_io::recording::{ScanRecord, laser_extrinsics};

use crate::laser_replay::{MAX_RANGE, MIN_RANGE};

/// Maximum number of beams used per scan.
const MAX_BEAMS: usize = 128;

/// End points of one scan.
#[derive(Clone, Debug)]
pub(super) struct ScanEndpoints {
    /// Position of the laser.
    pub(super) laser: Point<Body, f64>,
    /// Beam end points.
    pub(super) ends: Vec<Point<Body, f64>>,
    /// Surface cell of each end point, and the number of its beams so far.
    pieces: Vec<(usize, u32)>,
}

impl ScanEndpoints {
    /// Selects returned beams of `scan` evenly.
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

    /// Iterates over end points with their surface cell and the number of its beams so far.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (Point<Body, f64>, usize, u32)> {
        self.ends.iter().zip(&self.pieces).map(|(end, (piece, count))| (*end, *piece, *count))
    }
}

/// All observed surface cells.
#[derive(Clone, Debug)]
pub(super) struct SurfaceCells {
    /// Side of a cell \[m].
    side: f64,
    pieces: HashMap<(i32, i32), usize>,
    beams: Vec<u32>,
}

impl SurfaceCells {
    /// Creates an empty set with cells of this side \[m].
    pub(super) fn new(side: f64) -> Self {
        Self { side, pieces: HashMap::new(), beams: Vec::new() }
    }

    /// Returns the number of cells.
    pub(super) fn len(&self) -> usize {
        self.beams.len()
    }

    /// Adds the end points at an odometry pose.
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
