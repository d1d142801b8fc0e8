//! Evaluation of line extraction against the truth of the loop world.

use std::ops::Range;

use surepose::geometry::{Body, Laser, Map, Pose};
use surepose::lidar::{Association, ExtractedLine, ScanEvent};
use surepose::localization::LoopObserver;
use surepose::map::Wall;
use surepose_sim::{CancelToken, Seed};

use super::loop_world::{LoopTick, LoopWorld};
use super::seeds::for_each;

/// Minimum number of adjacent beams on a visible wall.
const VISIBLE_BEAMS: usize = 9;
/// Minimum length of a visible wall that these beams cover \[m].
const VISIBLE_LENGTH: f64 = 0.5;
/// NEES of (r, ψ) below which a line belongs to a wall; 1 in 270 000 correct lines exceeds it.
const FOUND: f64 = 25.0;

/// Statistics of visible walls and extracted lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extraction {
    /// Walls with at least 9 adjacent beams over at least 0.5 m.
    pub visible: u64,
    /// Visible walls with an extracted line.
    pub found: u64,
    /// Lines with most beams on one wall.
    pub lines: u64,
    /// Lines without such a wall.
    pub spurious: u64,
    /// Sum of the NEES of (r, ψ) over the lines: 2 per line if the covariance is consistent.
    pub line_nees_sum: f64,
    /// Lines that were associated to a wall of the map.
    pub matched: u64,
    /// Lines that were associated to a wrong wall.
    pub wrong: u64,
}

impl Extraction {
    /// Returns the fraction of visible walls with a line; `None` without visible walls.
    pub fn walls_found_share(&self) -> Option<f64> {
        share(self.found as f64, self.visible)
    }

    /// Returns the mean NEES of the lines; `None` without lines.
    pub fn line_nees_mean(&self) -> Option<f64> {
        share(self.line_nees_sum, self.lines)
    }

    /// Returns the fraction of associated lines with a wrong wall; `None` without associations.
    pub fn wrong_match_share(&self) -> Option<f64> {
        share(self.wrong as f64, self.matched)
    }

    pub(super) fn and(self, other: Self) -> Self {
        Self {
            visible: self.visible + other.visible,
            found: self.found + other.found,
            lines: self.lines + other.lines,
            spurious: self.spurious + other.spurious,
            line_nees_sum: self.line_nees_sum + other.line_nees_sum,
            matched: self.matched + other.matched,
            wrong: self.wrong + other.wrong,
        }
    }
}

fn share(part: f64, of: u64) -> Option<f64> {
    (of > 0).then(|| part / of as f64)
}

/// Evaluates every scan of the runs with `seeds`, for the filter with encoders, compass and laser; `None`
/// without a completed run.
pub fn extraction(world: &LoopWorld, seeds: Range<u64>, cancel: &CancelToken) -> Option<Extraction> {
    for_each(seeds, cancel, |seed| judged(world, seed)).into_iter().reduce(Extraction::and)
}

/// Evaluates the scans of one run.
pub(super) fn judged(world: &LoopWorld, seed: Seed) -> Extraction {
    let mut run = world.run(seed);
    let mut robot = run.robot();
    let mut sum = Extraction::default();
    while let Some(LoopTick { truth, sensed }) = run.next() {
        let aims = sensed.scans.iter().flat_map(|scan| world.seen_walls(truth, &scan.value)).collect();
        run.sense(&mut robot, &sensed, &mut Judge { truth, aims, sum: &mut sum });
    }
    sum
}

/// Evaluation of scans against the truth.
struct Judge<'a> {
    truth: Pose<Map, Body, f64>,
    /// Index of the wall that each beam hits.
    aims: Vec<Option<usize>>,
    sum: &'a mut Extraction,
}

impl LoopObserver<f64> for Judge<'_> {
    fn on_scan(&mut self, event: &ScanEvent<'_, f64>) {
        let (observation, walls, sum) = (event.observation, event.map.walls, &mut self.sum);
        let lines = observation.extracted.lines;
        let mut votes = vec![vec![0_usize; walls.len()]; lines.len()];
        for (beam, line) in observation.extracted.beams() {
            if let Some(wall) = self.aims[beam] {
                votes[line][wall] += 1;
            }
        }
        let mut found = vec![false; walls.len()];
        for ((line, votes), association) in lines.iter().zip(&votes).zip(observation.associations.as_slice())
        {
            let most = votes.iter().enumerate().max_by_key(|(_, n)| **n);
            let Some((wall, _)) = most.filter(|(_, n)| 2 * **n > usize::from(line.beams)) else {
                sum.spurious += 1;
                continue;
            };
            let nees = line_nees(line, &walls[wall], self.truth * event.laser.body_from_laser);
            sum.lines += 1;
            sum.line_nees_sum += nees;
            found[wall] |= nees < FOUND;
            if let Association::Wall { number, .. } = association {
                sum.matched += 1;
                sum.wrong += u64::from(*number != wall);
            }
        }
        for (wall, found) in found.iter().enumerate() {
            if is_visible(&self.aims, wall, event.scan.ranges, event.scan.angle_increment) {
                sum.visible += 1;
                sum.found += u64::from(*found);
            }
        }
    }
}

/// Returns the NEES of a line, χ² with 2 degrees of freedom.
fn line_nees(line: &ExtractedLine<f64>, wall: &Wall<f64>, map_from_laser: Pose<Map, Laser, f64>) -> f64 {
    let right = map_from_laser.inverse() * *wall.line();
    let side = if right.distance < 0.0 { -1.0 } else { 1.0 };
    let turned = line.line.direction - right.direction;
    let direction = if side < 0.0 {
        (turned + surepose::geometry::Angle::half_turn()).radians()
    } else {
        turned.radians()
    };
    let distance = line.line.distance - side * right.distance;
    let (v, w, c) = (line.distance_variance, line.direction_variance, line.covariance);
    (w * distance * distance - 2.0 * c * distance * direction + v * direction * direction) / (v * w - c * c)
}

/// Returns whether enough adjacent beams hit the wall over a sufficient length.
fn is_visible(aims: &[Option<usize>], wall: usize, ranges: &[f64], step: f64) -> bool {
    let mut first = None;
    for (i, aim) in aims.iter().enumerate() {
        if *aim != Some(wall) {
            first = None;
            continue;
        }
        let begin = *first.get_or_insert(i);
        let (a, b) = (ranges[begin], ranges[i]);
        let angle = step * (i - begin) as f64;
        let length_squared = a * a + b * b - 2.0 * a * b * angle.cos();
        if i - begin + 1 >= VISIBLE_BEAMS && length_squared >= VISIBLE_LENGTH * VISIBLE_LENGTH {
            return true;
        }
    }
    false
}
