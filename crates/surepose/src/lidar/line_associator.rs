//! Association of extracted lines with walls of the map.

use core::f64::consts::{FRAC_1_PI, PI};

use crate::estimation::{Belief, Ekf, Gate, LineMeasurement};
use crate::geometry::{Angle, Body, Laser, Line, Map, Point, Pose};
use crate::map::Wall;
use crate::scalar::Float;

use super::fixed_vec::FixedVec;
use super::line_extractor::{ExtractedLine, MAX_LINES};

/// Maximum number of candidate walls of one line.
const MAX_CANDIDATES: usize = 8;

/// Minimum fraction of a line that must overlap its wall.
const MIN_COVERAGE: f64 = 0.8;

/// Margin by which a wall may extend beyond its end in the map \[m], in addition to the uncertainty of the belief.
const END_MARGIN: f64 = 0.1;

/// Associates lines with walls of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineAssociator<S> {
    /// Gate of the normalized innovation of a line.
    pub gate: Gate<S>,
    /// Minimum difference of the normalized innovations of the second-best and the best wall.
    pub ambiguity_margin: S,
    /// Variances of distance \[m²] and direction \[rad²] that constant errors of laser and map add in the association; 0 for
    /// none. They are not in the measurements.
    pub model_variance: [S; 2],
}

/// Association of one line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Association<S> {
    /// The line is a wall of the map.
    Wall {
        /// Index of the wall.
        number: usize,
        /// Measurement for the filter.
        sighting: LineMeasurement<S>,
    },
    /// Several walls explain the line about equally well.
    Ambiguous,
    /// No wall of the map explains the line.
    Unknown,
}

/// Associations of all lines of a scan.
#[derive(Clone, Copy, Debug)]
pub struct Associations<S> {
    associations: [Association<S>; MAX_LINES],
    len: usize,
}

impl<S: Float> Associations<S> {
    /// No associations.
    pub(super) fn new() -> Self {
        Self { associations: [Association::Unknown; MAX_LINES], len: 0 }
    }
}

impl<S> Associations<S> {
    /// Association of each line, in the order of the lines.
    pub fn as_slice(&self) -> &[Association<S>] {
        &self.associations[..self.len]
    }

    /// Measurements of the lines with a wall.
    pub fn measurements(&self) -> impl Iterator<Item = &LineMeasurement<S>> {
        self.as_slice().iter().filter_map(|association| match association {
            Association::Wall { sighting, .. } => Some(sighting),
            _ => None,
        })
    }
}

impl<S: Float> Default for LineAssociator<S> {
    /// Gate at 99.9 %; the best wall must be 100 times as likely as the second best.
    fn default() -> Self {
        let exact = [S::from_f64(0.0); 2];
        Self { gate: Gate::new(0.999), ambiguity_margin: S::from_f64(9.2), model_variance: exact }
    }
}

/// A line without an association so far.
#[derive(Clone, Copy)]
struct PendingLine<S> {
    /// Measurement of the line; its wall is filled in.
    seen: LineMeasurement<S>,
    /// Indices of the candidate walls.
    candidates: FixedVec<usize, MAX_CANDIDATES>,
    /// More candidates exist than fit. All walls are tested again when the belief is sharper.
    overflowed: bool,
    beams: u16,
}

/// Decision on a pending line with the present belief.
enum Selection {
    None,
    Unique(usize),
    Ambiguous,
}

impl<S: Float> LineAssociator<S> {
    /// Associates `lines` with `walls`, given the belief at the time of the scan.
    ///
    /// The line with the most beams and a unique wall is associated first. Its measurement sharpens the belief and so
    /// the gates of the remaining lines. Walls that are close or parallel are thus distinguished by their neighbors
    /// where the prior belief alone cannot distinguish them. Each wall is associated once. Lines with two candidate
    /// walls left are [`Association::Ambiguous`].
    pub fn associate(
        &self,
        ekf: &Ekf<S>,
        belief: &Belief<S>,
        body_from_laser: &Pose<Body, Laser, S>,
        lines: &[ExtractedLine<S>],
        walls: &[Wall<S>],
    ) -> Associations<S> {
        let lines = &lines[..lines.len().min(MAX_LINES)];
        let mut state = AssociationState {
            associator: self,
            ekf,
            belief: *belief,
            body_from_laser,
            walls,
            assigned: FixedVec::new(),
        };
        let mut pending = [None; MAX_LINES];
        for (slot, line) in pending.iter_mut().zip(lines) {
            *slot = Some(state.pending_line(line));
        }
        let mut result = Associations { len: lines.len(), ..Associations::new() };
        loop {
            let mut next = None;
            let mut most_beams = 0;
            for (k, line) in lines.iter().enumerate() {
                let Some(PendingLine { beams, .. }) = pending[k] else { continue };
                if beams <= most_beams {
                    continue;
                }
                if let Some(Selection::Unique(number)) =
                    pending[k].as_mut().map(|pending| state.select(pending, line))
                {
                    most_beams = beams;
                    next = Some((k, number));
                }
            }
            let Some((k, number)) = next else { break };
            if let (Some(pending), Some(wall)) = (pending[k].take(), walls.get(number)) {
                let sighting = state.sighting(&pending, wall);
                state.apply(&sighting);
                result.associations[k] = Association::Wall { number, sighting };
            }
            state.assigned.push(number);
            for line in pending.iter_mut().flatten() {
                line.candidates.retain(|other| *other != number);
            }
        }
        for (k, line) in lines.iter().enumerate() {
            let select = pending[k].as_mut().map(|pending| state.select(pending, line));
            if let Some(Selection::Ambiguous) = select {
                result.associations[k] = Association::Ambiguous;
            }
        }
        result
    }
}

/// The walls and the present belief during association.
struct AssociationState<'a, S> {
    associator: &'a LineAssociator<S>,
    ekf: &'a Ekf<S>,
    belief: Belief<S>,
    body_from_laser: &'a Pose<Body, Laser, S>,
    walls: &'a [Wall<S>],
    /// Indices of the walls that are associated.
    assigned: FixedVec<usize, MAX_LINES>,
}

impl<S: Float> AssociationState<'_, S> {
    fn pending_line(&self, line: &ExtractedLine<S>) -> PendingLine<S> {
        let seen = line.in_body_frame(self.body_from_laser);
        let mut pending =
            PendingLine { seen, candidates: FixedVec::new(), overflowed: false, beams: line.beams };
        self.collect_candidates(&mut pending, line);
        pending
    }

    /// Collects the candidate walls of the line.
    fn collect_candidates(&self, pending: &mut PendingLine<S>, line: &ExtractedLine<S>) {
        pending.candidates.clear();
        pending.overflowed = false;
        let (ends, margin) = self.segment_in_map(line);
        for number in (0..self.walls.len()).filter(|number| !self.assigned.contains(number)) {
            if self.nis(pending, number, ends, margin).is_some() {
                pending.overflowed = pending.overflowed || pending.candidates.is_full();
                pending.candidates.push(number);
            }
        }
    }

    fn select(&self, pending: &mut PendingLine<S>, line: &ExtractedLine<S>) -> Selection {
        if pending.overflowed {
            self.collect_candidates(pending, line);
        }
        let (ends, margin) = self.segment_in_map(line);
        let mut best: Option<(S, usize)> = None;
        let mut second: Option<S> = None;
        for &number in pending.candidates.iter() {
            let Some(nis) = self.nis(pending, number, ends, margin) else { continue };
            match best {
                Some((least, _)) if nis >= least => {
                    second = Some(second.map_or(nis, |other| other.min(nis)));
                }
                _ => {
                    second = best.map(|(least, _)| least);
                    best = Some((nis, number));
                }
            }
        }
        match (best, second) {
            (None, _) => Selection::None,
            (Some((least, _)), Some(next)) if next - least < self.associator.ambiguity_margin => {
                Selection::Ambiguous
            }
            _ if pending.overflowed => Selection::Ambiguous,
            (Some((_, number)), _) => Selection::Unique(number),
        }
    }

    fn apply(&mut self, sighting: &LineMeasurement<S>) {
        let innovation = self.with_model_error(*sighting).innovation(&self.belief);
        self.belief = self.ekf.correct(self.belief, &innovation, self.associator.gate.threshold(2)).belief;
    }

    /// The line as a measurement of `wall`.
    ///
    /// # Departure
    /// The wall's covariance is constant, too. Of its position the filter considers it; that of its direction, which is
    /// small for a long wall, counts as noise.
    fn sighting(&self, pending: &PendingLine<S>, wall: &Wall<S>) -> LineMeasurement<S> {
        let [_, _, direction] = wall.covariance();
        LineMeasurement {
            wall: *wall.line(),
            direction_variance: pending.seen.direction_variance + direction,
            wall_variance: wall.position_variance(self.belief.pose.origin()),
            ..pending.seen
        }
    }

    /// The measurement with the constant errors of laser and map as noise.
    fn with_model_error(&self, sighting: LineMeasurement<S>) -> LineMeasurement<S> {
        let [distance, direction] = self.associator.model_variance;
        LineMeasurement {
            distance_variance: sighting.distance_variance + distance + sighting.wall_variance,
            direction_variance: sighting.direction_variance + direction,
            ..sighting
        }
    }

    /// End points of the line in the map, and their uncertainty \[m].
    fn segment_in_map(&self, line: &ExtractedLine<S>) -> ([Point<Map, S>; 2], S) {
        let map_from_laser = self.belief.pose * *self.body_from_laser;
        let (nx, ny) = line.line.normal();
        let r = line.line.distance;
        let ends = [line.extent.0, line.extent.1];
        let covariance = &self.belief.covariance;
        let reach = r.squared() + ends[0].squared().max(ends[1].squared());
        let variance = covariance.entry(0, 0) + covariance.entry(1, 1) + reach * covariance.entry(2, 2);
        let margin = S::from_f64(END_MARGIN) + S::from_f64(3.0) * variance.sqrt();
        (ends.map(|t| map_from_laser * Point::new(r * nx - t * ny, r * ny + t * nx)), margin)
    }

    /// Normalized innovation of the line as this wall; `None` outside the gate or without overlap.
    fn nis(&self, pending: &PendingLine<S>, number: usize, ends: [Point<Map, S>; 2], margin: S) -> Option<S> {
        let wall = self.walls.get(number)?;
        let threshold = self.associator.gate.threshold(2);
        let sighting = self.with_model_error(self.sighting(pending, wall));
        // The innovation of the direction alone is never larger than that of direction and distance, and is cheap.
        let turned =
            (sighting.seen.direction - (sighting.wall.direction - self.belief.pose.heading)).radians();
        let half_turns = (turned * S::from_f64(FRAC_1_PI)).round();
        let off = turned - half_turns * S::from_f64(PI);
        let variance = self.belief.covariance.entry(2, 2) + sighting.direction_variance;
        if off.squared() > threshold * variance || wall.overlap(ends, margin) < S::from_f64(MIN_COVERAGE) {
            return None;
        }
        let tried = self.ekf.correct(self.belief, &sighting.innovation(&self.belief), threshold);
        tried.accepted.then_some(tried.nis)
    }
}

impl<S: Float> ExtractedLine<S> {
    /// Transforms the line to the body frame; the wall is filled in later.
    ///
    /// With a laser at (x, y) in the body, r grows by x·cos ψ + y·sin ψ, which mixes the error of ψ into that of r.
    fn in_body_frame(&self, body_from_laser: &Pose<Body, Laser, S>) -> LineMeasurement<S> {
        let seen = *body_from_laser * self.line;
        let (nx, ny) = seen.normal();
        let lever = body_from_laser.y * nx - body_from_laser.x * ny;
        let shared = self.covariance + lever * self.direction_variance;
        LineMeasurement {
            wall: Line::new(S::from_f64(0.0), Angle::zero()),
            seen,
            distance_variance: self.distance_variance + lever * (self.covariance + shared),
            direction_variance: self.direction_variance,
            covariance: shared,
            wall_variance: S::from_f64(0.0),
        }
    }
}
