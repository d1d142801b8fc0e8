//! Does the map explain the scan, if the robot stands here? Beam by beam, without looking for lines.

use crate::covariance::{Covariance, NotACovariance};
use crate::estimate::{Belief, PoseFix};
use crate::frame::{Body, Laser, Map};
use crate::pose::{Point, Pose};
use crate::scalar::Float;

use super::agreement::Agreement;
use super::beam::{Beam, BeamNoise};
use super::pull::Pull;
use super::ray_line::RayLine;
use super::scan::{RangeFinder, Scan, ScanRefusal};
use super::wall::Wall;

/// Beams off by less than this are explained, in standard deviations: one of 370 is off by more.
const EXPLAINED: f64 = 3.0;

/// What a beam may cost that ends before the wall: −2 log of how much likelier the wall itself is than a thing on no map.
///
/// The beam model of [Thrun2005] Sec. 6.3, in which the largest of its parts stands for their sum: a range of σ 3 cm has
/// a density of 13 per metre at its wall; people, who hide a fifth of the beams, spread over some 4 m, 0.05 per metre.
const BEFORE: f64 = 11.0;

/// What a beam may cost that ends beyond the wall, which no thing in the way can do: one beam of a hundred, somewhere.
const BEYOND: f64 = 17.0;

/// A scan, or an even selection of its beams, to be held against the map from many poses.
///
/// The work of one [`Glance::from`] is `BEAMS` times the number of walls.
#[derive(Clone, Copy, Debug)]
pub struct Glance<S, const BEAMS: usize> {
    beams: [Beam<S>; BEAMS],
    len: usize,
    /// The longest beam \[m].
    pub(super) reach: S,
    noise: BeamNoise<S>,
    body_from_laser: Pose<Body, Laser, S>,
}

impl<S: Float, const BEAMS: usize> Glance<S, BEAMS> {
    /// Up to `BEAMS` beams of `scan`, evenly spread; beams that did not come back say nothing.
    ///
    /// # Errors
    /// [`ScanRefusal`]; a scan may have any number of beams.
    pub fn of(laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> Result<Self, ScanRefusal> {
        laser.check()?;
        scan.check(usize::MAX)?;
        let mut glance = Self::none(laser);
        for (number, range) in Self::chosen(scan) {
            if laser.came_back(range) {
                let (sin, cos) = scan.bearing(number).sin_cos();
                let inverse = S::of(1.0) / range;
                glance.push(Beam { cos, sin, range, inverse, number: number as u16 });
                glance.reach = glance.reach.max(range);
            }
        }
        Ok(glance)
    }

    /// No beams of this laser.
    pub(super) fn none(laser: &RangeFinder<S>) -> Self {
        let (noise, body_from_laser) = (BeamNoise::of(laser), laser.body_from_laser);
        Self { beams: [Beam::default(); BEAMS], len: 0, reach: S::of(0.0), noise, body_from_laser }
    }

    /// The numbers and ranges of up to `BEAMS` beams, evenly spread.
    pub(super) fn chosen<'a>(scan: &Scan<'a, S>) -> impl Iterator<Item = (usize, S)> + use<'a, S, BEAMS> {
        let stride = scan.ranges.len().div_ceil(BEAMS.max(1)).max(1);
        scan.ranges.iter().copied().enumerate().step_by(stride)
    }

    /// With a beam more; without, where there is no room.
    pub(super) fn push(&mut self, beam: Beam<S>) {
        if let Some(slot) = self.beams.get_mut(self.len) {
            *slot = beam;
            self.len += 1;
        }
    }

    /// Every second beam: half the work, for a first sight.
    #[must_use]
    pub fn halved(&self) -> Self {
        let mut half = *self;
        half.len = 0;
        for beam in self.beams[..self.len].iter().step_by(2) {
            half.beams[half.len] = *beam;
            half.len += 1;
        }
        half
    }

    /// How many beams there are.
    pub fn beams(&self) -> usize {
        self.len
    }

    /// How the scan agrees with `walls`, seen from `pose`, which is known as well as `covariance` says.
    ///
    /// A beam ends at the nearest wall in its way: the one whose inverse range there is largest. What the pose may be
    /// off is taken as a beam's own error, along it and, seen from the wall, across it: more than it is, by a factor
    /// of two at most. A beam so near the edge of a wall that it may slip past ends there or at the wall behind,
    /// whichever explains it better.
    pub fn from(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
    ) -> Agreement<S> {
        self.compare(&self.fates(pose, &self.vague(covariance), walls))
    }

    /// The pose that the explained beams ask for, seen from what is believed, and how the scan agrees with `walls` there.
    ///
    /// # Errors
    /// [`NotACovariance`] where something is not finite.
    pub fn fix(
        &self,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> (Agreement<S>, Result<PoseFix<S>, NotACovariance>) {
        let pose = belief.pose;
        let mut pull = Pull::none();
        let agreement = self.pulled_from(pose, &belief.covariance, walls, pose.origin(), &mut pull);
        (agreement, pull.fix(pose))
    }

    /// How the scan agrees with `walls`, seen from `pose`, and, added to `pull`, what its explained beams say of a pose
    /// at `center` that moves with it.
    pub(crate) fn pulled_from(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
        center: Point<Map, S>,
        pull: &mut Pull<S>,
    ) -> Agreement<S> {
        let vague = self.vague(covariance);
        let fates = self.fates(pose, &vague, walls);
        let eye = pose * self.body_from_laser;
        let (sin, cos) = eye.heading.sin_cos();
        // How the eye moves when the pose at the center turns.
        let swing = (center.y - eye.y, eye.x - center.x);
        for (beam, fate) in self.beams[..self.len].iter().zip(&fates) {
            let (u, slope, misfit) = fate.settled();
            if misfit < S::of(EXPLAINED * EXPLAINED) {
                // u = a·cos φ + b·sin φ grows by u·(a, b) with a step of the eye and by ∂u/∂φ with its turn.
                let (a, b) = (u * beam.cos - slope * beam.sin, u * beam.sin + slope * beam.cos);
                let step = (u * (a * cos - b * sin), u * (a * sin + b * cos));
                let row = [step.0, step.1, slope + step.0 * swing.0 + step.1 * swing.1];
                // What the pose may be off by counts as noise of the beam as well: a beam given to the wrong of two walls near
                // an edge then pulls less, and what is known of the pose is understated rather than overstated.
                let weight = S::of(1.0).over_positive(vague.variance(u, slope));
                pull.add(row, beam.inverse - u, weight);
            }
        }
        self.compare(&fates)
    }

    /// The ends of the beams, seen from the robot.
    pub(crate) fn ends(&self) -> impl Iterator<Item = Point<Body, S>> + '_ {
        let ends = self.beams[..self.len].iter();
        ends.map(|beam| self.body_from_laser * Point::new(beam.range * beam.cos, beam.range * beam.sin))
    }

    pub(super) fn vague(&self, covariance: &Covariance<S, 3>) -> Vague<S> {
        Vague {
            noise: self.noise,
            place: covariance.entry(0, 0) + covariance.entry(1, 1),
            heading: covariance.entry(2, 2),
        }
    }

    pub(super) fn fates(
        &self,
        pose: Pose<Map, Body, S>,
        vague: &Vague<S>,
        walls: &[Wall<S>],
    ) -> [BeamEnd<S>; BEAMS] {
        let beams = &self.beams[..self.len];
        let zero = S::of(0.0);
        let mut fates = [BeamEnd {
            surely: zero,
            misfit: S::of(BEFORE),
            slope: zero,
            at: zero,
            misfit_at: S::of(BEFORE),
            slope_at: zero,
        }; BEAMS];
        let eye = pose * self.body_from_laser;
        let laser_from_map = eye.inverse();
        let within = self.reach + S::of(EXPLAINED) * (vague.noise.range + vague.place).sqrt();
        for wall in walls {
            // Behind the end of the longest beam a wall is as good as none: every beam ends before it.
            if wall.distance(eye.origin()) > within {
                continue;
            }
            let [a, b] = wall.ends().map(|end| end_beam(laser_from_map * end));
            // The wall from right to left, as the laser sees it.
            let (right, left) = if turn(&a, &b) > zero { (a, b) } else { (b, a) };
            let line = RayLine::through(&right, &left);
            let (right_edge, left_edge) = (vague.edge(&right), vague.edge(&left));
            for (fate, beam) in fates.iter_mut().zip(beams) {
                let (from_right, to_left) = (turn(&right, beam), turn(beam, &left));
                if from_right > -right_edge && to_left > -left_edge {
                    let (u, slope) = line.at(beam);
                    let is_sure = from_right > right_edge && to_left > left_edge;
                    // What lies behind a wall that is surely in the way does not matter.
                    if u > fate.surely {
                        let misfit = vague.misfit(beam, u, slope);
                        if is_sure {
                            (fate.surely, fate.misfit, fate.slope) = (u, misfit, slope);
                        }
                        if fate.at < fate.surely || misfit < fate.misfit_at {
                            (fate.at, fate.misfit_at, fate.slope_at) = (u, misfit, slope);
                        }
                    }
                }
            }
        }
        fates
    }

    fn compare(&self, fates: &[BeamEnd<S>; BEAMS]) -> Agreement<S> {
        let mut result = Agreement { beams: self.len as u16, ..Agreement::default() };
        for (beam, fate) in self.beams[..self.len].iter().zip(fates) {
            let (u, _, misfit) = fate.settled();
            if misfit < S::of(EXPLAINED * EXPLAINED) {
                result.explained += 1;
            } else if beam.inverse > u {
                result.before += 1;
            } else {
                result.beyond += 1;
            }
            result.misfit = result.misfit + misfit;
        }
        result
    }
}

/// What is known of a beam's end so far.
#[derive(Clone, Copy)]
pub(super) struct BeamEnd<S> {
    /// The inverse range of the nearest wall that is surely in its way, 0 for none, what that costs, and how the inverse
    /// range changes with the bearing.
    pub(super) surely: S,
    misfit: S,
    slope: S,
    /// The wall that may be in its way and explains it best, likewise.
    at: S,
    misfit_at: S,
    slope_at: S,
}

impl<S: Float> BeamEnd<S> {
    /// Inverse range, slope and cost of the wall at which the beam ends.
    #[inline]
    fn settled(&self) -> (S, S, S) {
        if self.at < self.surely || self.misfit < self.misfit_at {
            (self.surely, self.slope, self.misfit)
        } else {
            (self.at, self.slope_at, self.misfit_at)
        }
    }
}

/// How well the end of a beam is known.
pub(super) struct Vague<S> {
    noise: BeamNoise<S>,
    /// The variance of the place \[m²] and of the heading \[rad²].
    place: S,
    heading: S,
}

impl<S: Float> Vague<S> {
    /// What a beam costs that ends at a wall of inverse range `u` and slope `slope`, or elsewhere.
    #[inline]
    fn misfit(&self, beam: &Beam<S>, u: S, slope: S) -> S {
        let off = beam.inverse - u;
        let squared = off.squared().over_positive(self.variance(u, slope));
        squared.min(if off > S::of(0.0) { S::of(BEFORE) } else { S::of(BEYOND) })
    }

    /// The variance of the inverse range where it is `u` and changes by `slope` per radian.
    #[inline]
    fn variance(&self, u: S, slope: S) -> S {
        let noise = BeamNoise {
            range: self.noise.range + self.place,
            bearing: self.noise.bearing + self.heading + self.place * u.squared(),
        };
        noise.variance(u, slope)
    }

    /// How near the end of a wall a beam may slip past it \[rad].
    fn edge(&self, end: &Beam<S>) -> S {
        let variance = self.noise.bearing + self.heading + self.place * end.inverse.squared();
        S::of(EXPLAINED) * variance.sqrt()
    }
}

/// A beam to `point`.
fn end_beam<S: Float>(point: Point<Laser, S>) -> Beam<S> {
    let range = point.distance(Point::new(S::of(0.0), S::of(0.0)));
    let inverse = S::of(1.0).over_positive(range);
    Beam { cos: point.x * inverse, sin: point.y * inverse, range, inverse, number: 0 }
}

/// The sine of the turn from one beam to another: positive where it is to the left.
#[inline]
fn turn<S: Float>(from: &Beam<S>, to: &Beam<S>) -> S {
    from.cos * to.sin - from.sin * to.cos
}

#[cfg(test)]
mod tests {
    use super::{Agreement, Glance};
    use crate::{Angle, Covariance, Point, Pose, RangeFinder, Scan, Wall};

    fn laser() -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: Pose::new(0.1, 0.0, Angle::zero()),
            range_std: 0.03,
            bearing_std: 0.004,
            nearest: 0.05,
            farthest: 20.0,
        }
    }

    fn wall(from: (f64, f64), to: (f64, f64)) -> Wall<f64> {
        Wall::between(Point::new(from.0, from.1), Point::new(to.0, to.1)).unwrap()
    }

    /// Five beams, 45° apart, from right to left.
    fn look(ranges: &[f64; 5], walls: &[Wall<f64>]) -> Agreement<f64> {
        let scan =
            Scan { first_bearing: Angle::from_degrees(-90.0), bearing_step: 45.0_f64.to_radians(), ranges };
        let glance = Glance::<f64, 8>::of(&laser(), &scan).unwrap();
        let pose = Pose::new(0.9, 1.0, Angle::zero());
        glance.from(pose, &Covariance::from_std([0.0; 3]), walls)
    }

    /// From (1, 1): 1 m to the right and left, 2 m ahead, √2 between, behind a plate on the left.
    #[test]
    fn beams_end_at_the_first_wall_before_it_or_beyond_it() {
        let room = [
            wall((0.0, 0.0), (3.0, 0.0)),
            wall((3.0, 2.0), (3.0, 0.0)),
            wall((0.0, 2.0), (3.0, 2.0)),
            wall((0.9, 1.5), (1.1, 1.5)),
        ];
        let root = 2.0_f64.sqrt();
        let all = look(&[1.0, root, 2.0, root, 0.5], &room);
        assert_eq!((all.beams, all.explained, all.before, all.beyond), (5, 5, 0, 0));
        assert!(all.misfit < 1e-9);
        let mixed = look(&[0.7, root, f64::NAN, root, 1.0], &room);
        assert_eq!((mixed.beams, mixed.explained, mixed.before, mixed.beyond), (4, 2, 1, 1));
        assert!((mixed.misfit - 28.0).abs() < 1e-9, "{}", mixed.misfit);
        assert!((mixed.explained_share() - 0.5).abs() < 1e-12);
        assert!((mixed.beyond_share() - 0.25).abs() < 1e-12);
        // Without a wall, whatever came back is before it.
        assert_eq!(look(&[1.0; 5], &[]).before, 5);
    }

    #[test]
    fn nothing_seen_contradicts_nothing() {
        let none = look(&[f64::INFINITY, f64::NAN, 0.0, -1.0, 1e9], &[wall((3.0, 2.0), (3.0, 0.0))]);
        assert_eq!(none.beams, 0);
        assert!(none.explained_share() >= 1.0 && none.beyond_share() <= 0.0);
    }
}
