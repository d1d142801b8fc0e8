//! Which wall of the map is each seen line?

use core::f64::consts::{FRAC_1_PI, PI};

use crate::angle::Angle;
use crate::estimate::{Belief, Ekf, Gate, WallSighting};
use crate::frame::{Body, Laser, Map};
use crate::line::Line;
use crate::pose::{Point, Pose};
use crate::scalar::Float;

use super::extract::{MOST_LINES, SeenLine};
use super::list::List;
use super::wall::Wall;

/// The most walls that one line is held for at a time.
const MOST_CANDIDATES: usize = 8;

/// How much of a line must lie where the wall is.
const COVERED: f64 = 0.8;

/// How far a wall may reach beyond its end in the map \[m], on top of how far the belief may be off.
const LONGER: f64 = 0.1;

/// Decides which wall each line is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matcher<S> {
    /// How far off a line may be.
    pub gate: Gate<S>,
    /// How much less likely the second wall must be than the first: difference of their normalised innovations.
    pub distinct: S,
}

/// What became of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fate<S> {
    /// It is this wall of the map, by number.
    Wall {
        /// Which one.
        number: usize,
        /// What the filter is to be told.
        sighting: WallSighting<S>,
    },
    /// It may be any of several walls, and saying which would be guessing.
    Ambiguous,
    /// No wall of the map explains it.
    Unknown,
}

/// What became of all lines of a scan.
#[derive(Clone, Copy, Debug)]
pub struct Matched<S> {
    fates: [Fate<S>; MOST_LINES],
    len: usize,
}

impl<S: Float> Matched<S> {
    /// No lines.
    pub(super) fn none() -> Self {
        Self { fates: [Fate::Unknown; MOST_LINES], len: 0 }
    }
}

impl<S> Matched<S> {
    /// The fate of each line, in their order.
    pub fn fates(&self) -> &[Fate<S>] {
        &self.fates[..self.len]
    }

    /// The sightings of the lines that were matched.
    pub fn sightings(&self) -> impl Iterator<Item = &WallSighting<S>> {
        self.fates().iter().filter_map(|fate| match fate {
            Fate::Wall { sighting, .. } => Some(sighting),
            _ => None,
        })
    }
}

impl<S: Float> Default for Matcher<S> {
    /// The gate at 99.9 %, and walls told apart where one is 100 times as likely as the other.
    fn default() -> Self {
        Self { gate: Gate::new(0.999), distinct: S::of(9.2) }
    }
}

/// A line whose wall is not decided yet.
#[derive(Clone, Copy)]
struct Open<S> {
    /// What the filter would be told; its wall is filled in.
    seen: WallSighting<S>,
    /// The walls it may be, by number.
    candidates: List<usize, MOST_CANDIDATES>,
    /// There were more walls than can be held: all are asked again when the belief is sharper.
    crowded: bool,
    beams: u16,
}

/// What can be said of an open line now.
enum Choice {
    Nothing,
    One(usize),
    Several,
}

impl<S: Float> Matcher<S> {
    /// Matches `lines` with `walls`, given what is believed of the pose at the time of the scan.
    ///
    /// The line that most beams see and that can be one wall only is taken first; what it says of the pose sharpens
    /// the gates of those that are left. So walls that are close together or parallel are told apart by their
    /// neighbours where the belief alone cannot. A wall is given away once. Lines for which two walls are left are
    /// [`Fate::Ambiguous`].
    pub fn matched(
        &self,
        ekf: &Ekf<S>,
        belief: &Belief<S>,
        body_from_laser: &Pose<Body, Laser, S>,
        lines: &[SeenLine<S>],
        walls: &[Wall<S>],
    ) -> Matched<S> {
        let lines = &lines[..lines.len().min(MOST_LINES)];
        let mut now =
            View { matcher: self, ekf, belief: *belief, body_from_laser, walls, given: List::new() };
        let mut open = [None; MOST_LINES];
        for (slot, line) in open.iter_mut().zip(lines) {
            *slot = Some(now.first_look(line));
        }
        let mut result = Matched { len: lines.len(), ..Matched::none() };
        loop {
            let mut next = None;
            let mut most = 0;
            for (k, line) in lines.iter().enumerate() {
                let Some(Open { beams, .. }) = open[k] else { continue };
                if beams <= most {
                    continue;
                }
                if let Some(Choice::One(number)) = open[k].as_mut().map(|open| now.verdict(open, line)) {
                    most = beams;
                    next = Some((k, number));
                }
            }
            let Some((k, number)) = next else { break };
            if let (Some(taken), Some(wall)) = (open[k].take(), walls.get(number)) {
                let sighting = WallSighting { wall: *wall.line(), ..taken.seen };
                now.learn(&sighting);
                result.fates[k] = Fate::Wall { number, sighting };
            }
            now.given.push(number);
            for line in open.iter_mut().flatten() {
                line.candidates.retain(|other| *other != number);
            }
        }
        for (k, line) in lines.iter().enumerate() {
            let verdict = open[k].as_mut().map(|open| now.verdict(open, line));
            if let Some(Choice::Several) = verdict {
                result.fates[k] = Fate::Ambiguous;
            }
        }
        result
    }
}

/// The walls as the belief of the moment has them.
struct View<'a, S> {
    matcher: &'a Matcher<S>,
    ekf: &'a Ekf<S>,
    belief: Belief<S>,
    body_from_laser: &'a Pose<Body, Laser, S>,
    walls: &'a [Wall<S>],
    /// Walls that lines were given, by number.
    given: List<usize, MOST_LINES>,
}

impl<S: Float> View<'_, S> {
    fn first_look(&self, line: &SeenLine<S>) -> Open<S> {
        let seen = line.as_seen_by_body(self.body_from_laser);
        let mut open = Open { seen, candidates: List::new(), crowded: false, beams: line.beams };
        self.gather(&mut open, line);
        open
    }

    /// Notes which walls the line may be.
    fn gather(&self, open: &mut Open<S>, line: &SeenLine<S>) {
        open.candidates.clear();
        open.crowded = false;
        let (ends, margin) = self.stretch(line);
        for number in (0..self.walls.len()).filter(|number| !self.given.contains(number)) {
            if self.misfit(open, number, ends, margin).is_some() {
                open.crowded = open.crowded || open.candidates.is_full();
                open.candidates.push(number);
            }
        }
    }

    fn verdict(&self, open: &mut Open<S>, line: &SeenLine<S>) -> Choice {
        if open.crowded {
            self.gather(open, line);
        }
        let (ends, margin) = self.stretch(line);
        let mut best: Option<(S, usize)> = None;
        let mut second: Option<S> = None;
        for &number in open.candidates.iter() {
            let Some(misfit) = self.misfit(open, number, ends, margin) else { continue };
            match best {
                Some((least, _)) if misfit >= least => {
                    second = Some(second.map_or(misfit, |other| other.min(misfit)));
                }
                _ => {
                    second = best.map(|(least, _)| least);
                    best = Some((misfit, number));
                }
            }
        }
        match (best, second) {
            (None, _) => Choice::Nothing,
            (Some((least, _)), Some(next)) if next - least < self.matcher.distinct => Choice::Several,
            _ if open.crowded => Choice::Several,
            (Some((_, number)), _) => Choice::One(number),
        }
    }

    fn learn(&mut self, sighting: &WallSighting<S>) {
        let innovation = sighting.innovation(&self.belief);
        self.belief = self.ekf.correct(self.belief, &innovation, self.matcher.gate.threshold(2)).belief;
    }

    /// The ends of the line in the map, and how far off they may be.
    fn stretch(&self, line: &SeenLine<S>) -> ([Point<Map, S>; 2], S) {
        let map_from_laser = self.belief.pose * *self.body_from_laser;
        let (nx, ny) = line.line.normal();
        let r = line.line.distance;
        let ends = [line.extent.0, line.extent.1];
        let covariance = &self.belief.covariance;
        let reach = r.squared() + ends[0].squared().max(ends[1].squared());
        let variance = covariance.entry(0, 0) + covariance.entry(1, 1) + reach * covariance.entry(2, 2);
        let margin = S::of(LONGER) + S::of(3.0) * variance.sqrt();
        (ends.map(|t| map_from_laser * Point::new(r * nx - t * ny, r * ny + t * nx)), margin)
    }

    /// The normalised innovation of the line as this wall; `None` outside the gate or beside the wall.
    fn misfit(&self, open: &Open<S>, number: usize, ends: [Point<Map, S>; 2], margin: S) -> Option<S> {
        let wall = self.walls.get(number)?;
        let threshold = self.matcher.gate.threshold(2);
        let sighting = WallSighting { wall: *wall.line(), ..open.seen };
        // The direction alone is never farther off than direction and distance together, and is cheap to ask for.
        let turned =
            (sighting.seen.direction - (sighting.wall.direction - self.belief.pose.heading)).radians();
        let half_turns = (turned * S::of(FRAC_1_PI)).round();
        let off = turned - half_turns * S::of(PI);
        let variance = self.belief.covariance.entry(2, 2) + sighting.direction_variance;
        if off.squared() > threshold * variance || wall.covers(ends, margin) < S::of(COVERED) {
            return None;
        }
        let tried = self.ekf.correct(self.belief, &sighting.innovation(&self.belief), threshold);
        tried.accepted.then_some(tried.nis)
    }
}

impl<S: Float> SeenLine<S> {
    /// The line as seen from the body, with a wall still to be named.
    ///
    /// From a laser at (x, y) in the body, r grows by x·cos ψ + y·sin ψ, which mixes the error of ψ into that of r.
    fn as_seen_by_body(&self, body_from_laser: &Pose<Body, Laser, S>) -> WallSighting<S> {
        let seen = *body_from_laser * self.line;
        let (nx, ny) = seen.normal();
        let lever = body_from_laser.y * nx - body_from_laser.x * ny;
        let shared = self.covariance + lever * self.direction_variance;
        WallSighting {
            wall: Line::new(S::of(0.0), Angle::zero()),
            seen,
            distance_variance: self.distance_variance + lever * (self.covariance + shared),
            direction_variance: self.direction_variance,
            covariance: shared,
        }
    }
}
