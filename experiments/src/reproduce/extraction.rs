//! How well lines are extracted, judged by the truth of the loop world.

use std::ops::Range;

use surepose::geometry::{Body, Laser, Map, Pose};
use surepose::lidar::{Association, ExtractedLine, ScanEvent};
use surepose::localization::LoopObserver;
use surepose::map::Wall;
use surepose_sim::{CancelToken, Seed};

use super::loop_world::{LoopTick, LoopWorld};
use super::seeds::for_each;

/// A visible wall has at least so many beams aimed at it, all in a row …
const VISIBLE_BEAMS: usize = 9;
/// … and they hit it over at least this length \[m].
const VISIBLE_LENGTH: f64 = 0.5;
/// A wall is found by a line whose (r, ψ) has a normalised error squared below this: one in 270 000 right lines has more.
const FOUND: f64 = 25.0;

/// What became of the walls that could be seen, and of the lines that were.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extraction {
    /// Walls with at least 9 beams in a row over at least 0.5 m.
    pub visible: u64,
    /// Those of them that a line was found for.
    pub found: u64,
    /// Lines most beams of which are aimed at one wall.
    pub lines: u64,
    /// Lines of which that cannot be said.
    pub spurious: u64,
    /// Sum over the lines of the normalised error squared of (r, ψ): 2 a line, if the covariance is right.
    pub line_nees_sum: f64,
    /// Lines that were matched to a wall of the map.
    pub matched: u64,
    /// Those of them that were matched to another one than the one they see.
    pub wrong: u64,
}

impl Extraction {
    /// The part of the visible walls that a line was found for.
    pub fn walls_found_share(&self) -> Option<f64> {
        share(self.found as f64, self.visible)
    }

    /// The mean of the lines' normalised errors squared.
    pub fn line_nees_mean(&self) -> Option<f64> {
        share(self.line_nees_sum, self.lines)
    }

    /// The part of the matched lines that were matched to a wrong wall.
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

/// Judges every scan of the runs with `seeds`, until `cancel` is stopped, as the filter with encoders, compass and laser
/// sees it; `None` without a run.
pub fn extraction(world: &LoopWorld, seeds: Range<u64>, cancel: &CancelToken) -> Option<Extraction> {
    for_each(seeds, cancel, |seed| judged(world, seed)).into_iter().reduce(Extraction::and)
}

/// The same of one run.
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

/// Who knows the truth, and judges by it what is seen in a scan.
struct Judge<'a> {
    truth: Pose<Map, Body, f64>,
    /// Which wall each beam is aimed at, by number.
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

/// The normalised error squared of a line, χ² with 2 degrees of freedom.
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

/// Whether enough beams in a row are aimed at the wall, over enough of it.
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
