//! Does the map explain the scan, if the robot stands here? Beam by beam, without looking for lines.

use crate::estimation::{Belief, PoseMeasurement};
use crate::geometry::{Body, Laser, Map, Point, Pose};
use crate::linalg::{Covariance, InvalidCovariance};
use crate::map::Wall;
use crate::scalar::Float;

use super::beam::{Beam, BeamNoise};
use super::beam_stats::BeamStats;
use super::inverse_range_line::InverseRangeLine;
use super::pose_normal_equations::PoseNormalEquations;
use super::scan::{RangeFinder, Scan, ScanError};

/// Beams off by less than this are explained, in standard deviations: one of 370 is off by more.
const HIT_GATE: f64 = 3.0;

/// What a beam may cost that ends before the wall: −2 log of how much likelier the wall itself is than a thing on no map.
///
/// The beam model of [Thrun2005] Sec. 6.3, in which the largest of its parts stands for their sum: a range of σ 3 cm has
/// a density of 13 per metre at its wall; people, who hide a fifth of the beams, spread over some 4 m, 0.05 per metre.
const MAX_SHORT_COST: f64 = 11.0;

/// What a beam may cost that ends beyond the wall, which no thing in the way can do: one beam of a hundred, somewhere.
const MAX_BEHIND_WALL_COST: f64 = 17.0;

/// A scan, or an even selection of its beams, to be held against the map from many poses.
///
/// The work of one [`BeamSubset::from`] is `BEAMS` times the number of walls.
#[derive(Clone, Copy, Debug)]
pub struct BeamSubset<S, const BEAMS: usize> {
    beams: [Beam<S>; BEAMS],
    len: usize,
    /// The longest beam \[m].
    pub(super) max_range: S,
    noise: BeamNoise<S>,
    body_from_laser: Pose<Body, Laser, S>,
}

impl<S: Float, const BEAMS: usize> BeamSubset<S, BEAMS> {
    /// Up to `BEAMS` beams of `scan`, evenly spread; beams that did not come back say nothing.
    ///
    /// # Errors
    /// [`ScanError`]; a scan may have any number of beams.
    pub fn from_scan(laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> Result<Self, ScanError> {
        laser.check()?;
        scan.check(usize::MAX)?;
        let mut subset = Self::new(laser);
        for (number, range) in Self::sampled(scan) {
            if laser.is_return(range) {
                let (sin, cos) = scan.angle(number).sin_cos();
                let inverse = S::from_f64(1.0) / range;
                subset.push(Beam { cos, sin, range, inverse, number: number as u16 });
                subset.max_range = subset.max_range.max(range);
            }
        }
        Ok(subset)
    }

    /// No beams of this laser.
    pub(super) fn new(laser: &RangeFinder<S>) -> Self {
        let (noise, body_from_laser) = (BeamNoise::from_laser(laser), laser.body_from_laser);
        Self { beams: [Beam::default(); BEAMS], len: 0, max_range: S::from_f64(0.0), noise, body_from_laser }
    }

    /// The numbers and ranges of up to `BEAMS` beams, evenly spread.
    pub(super) fn sampled<'a>(scan: &Scan<'a, S>) -> impl Iterator<Item = (usize, S)> + use<'a, S, BEAMS> {
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
    pub fn decimated(&self) -> Self {
        let mut decimated = *self;
        decimated.len = 0;
        for beam in self.beams[..self.len].iter().step_by(2) {
            decimated.beams[decimated.len] = *beam;
            decimated.len += 1;
        }
        decimated
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
    pub fn evaluate(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
    ) -> BeamStats<S> {
        self.stats(&self.ray_cast(pose, &self.uncertainty(covariance), walls))
    }

    /// The pose that the explained beams ask for, seen from what is believed, and how the scan agrees with `walls` there.
    ///
    /// # Errors
    /// [`InvalidCovariance`] where something is not finite.
    pub fn measure_pose(
        &self,
        belief: &Belief<S>,
        walls: &[Wall<S>],
    ) -> (BeamStats<S>, Result<PoseMeasurement<S>, InvalidCovariance>) {
        let pose = belief.pose;
        let mut equations = PoseNormalEquations::new();
        let stats = self.linearize(pose, &belief.covariance, walls, pose.origin(), &mut equations);
        (stats, equations.solve(pose))
    }

    /// How the scan agrees with `walls`, seen from `pose`, and, added to `equations`, what its explained beams say of a pose
    /// at `center` that moves with it.
    pub(crate) fn linearize(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
        center: Point<Map, S>,
        equations: &mut PoseNormalEquations<S>,
    ) -> BeamStats<S> {
        let uncertainty = self.uncertainty(covariance);
        let expected_hits = self.ray_cast(pose, &uncertainty, walls);
        let map_from_laser = pose * self.body_from_laser;
        let (sin, cos) = map_from_laser.heading.sin_cos();
        // How the laser moves when the pose at the center turns.
        let lever = (center.y - map_from_laser.y, map_from_laser.x - center.x);
        for (beam, expected) in self.beams[..self.len].iter().zip(&expected_hits) {
            let (u, slope, cost) = expected.most_likely();
            if cost < S::from_f64(HIT_GATE * HIT_GATE) {
                // u = a·cos φ + b·sin φ grows by u·(a, b) with a step of the laser and by ∂u/∂φ with its turn.
                let (a, b) = (u * beam.cos - slope * beam.sin, u * beam.sin + slope * beam.cos);
                let step = (u * (a * cos - b * sin), u * (a * sin + b * cos));
                let row = [step.0, step.1, slope + step.0 * lever.0 + step.1 * lever.1];
                // What the pose may be off by counts as noise of the beam as well: a beam given to the wrong of two walls near
                // an edge then pulls less, and what is known of the pose is understated rather than overstated.
                let weight = S::from_f64(1.0).div_or_zero(uncertainty.variance(u, slope));
                equations.add(row, beam.inverse - u, weight);
            }
        }
        self.stats(&expected_hits)
    }

    /// The ends of the beams, seen from the robot.
    pub(crate) fn endpoints(&self) -> impl Iterator<Item = Point<Body, S>> + '_ {
        let endpoints = self.beams[..self.len].iter();
        endpoints.map(|beam| self.body_from_laser * Point::new(beam.range * beam.cos, beam.range * beam.sin))
    }

    pub(super) fn uncertainty(&self, covariance: &Covariance<S, 3>) -> BeamUncertainty<S> {
        BeamUncertainty {
            noise: self.noise,
            position: covariance.entry(0, 0) + covariance.entry(1, 1),
            heading: covariance.entry(2, 2),
        }
    }

    pub(super) fn ray_cast(
        &self,
        pose: Pose<Map, Body, S>,
        uncertainty: &BeamUncertainty<S>,
        walls: &[Wall<S>],
    ) -> [ExpectedHit<S>; BEAMS] {
        let beams = &self.beams[..self.len];
        let zero = S::from_f64(0.0);
        let mut expected_hits = [ExpectedHit {
            certain: zero,
            cost: S::from_f64(MAX_SHORT_COST),
            slope: zero,
            possible: zero,
            possible_cost: S::from_f64(MAX_SHORT_COST),
            possible_slope: zero,
        }; BEAMS];
        let map_from_laser = pose * self.body_from_laser;
        let laser_from_map = map_from_laser.inverse();
        let max_distance =
            self.max_range + S::from_f64(HIT_GATE) * (uncertainty.noise.range + uncertainty.position).sqrt();
        for wall in walls {
            // Behind the end of the longest beam a wall is as good as none: every beam ends before it.
            if wall.distance(map_from_laser.origin()) > max_distance {
                continue;
            }
            let [a, b] = wall.ends().map(|end| beam_to(laser_from_map * end));
            // The wall from right to left, as the laser sees it.
            let (right, left) = if sin_between(&a, &b) > zero { (a, b) } else { (b, a) };
            let line = InverseRangeLine::through(&right, &left);
            let (right_edge, left_edge) = (uncertainty.edge_angle(&right), uncertainty.edge_angle(&left));
            for (expected, beam) in expected_hits.iter_mut().zip(beams) {
                let (from_right, to_left) = (sin_between(&right, beam), sin_between(beam, &left));
                if from_right > -right_edge && to_left > -left_edge {
                    let (u, slope) = line.at(beam);
                    let is_certain = from_right > right_edge && to_left > left_edge;
                    // What lies behind a wall that is surely in the way does not matter.
                    if u > expected.certain {
                        let cost = uncertainty.cost(beam, u, slope);
                        if is_certain {
                            (expected.certain, expected.cost, expected.slope) = (u, cost, slope);
                        }
                        if expected.possible < expected.certain || cost < expected.possible_cost {
                            (expected.possible, expected.possible_cost, expected.possible_slope) =
                                (u, cost, slope);
                        }
                    }
                }
            }
        }
        expected_hits
    }

    fn stats(&self, expected_hits: &[ExpectedHit<S>; BEAMS]) -> BeamStats<S> {
        let mut result = BeamStats { beams: self.len as u16, ..BeamStats::default() };
        for (beam, expected) in self.beams[..self.len].iter().zip(expected_hits) {
            let (u, _, cost) = expected.most_likely();
            if cost < S::from_f64(HIT_GATE * HIT_GATE) {
                result.hits += 1;
            } else if beam.inverse > u {
                result.short += 1;
            } else {
                result.behind_wall += 1;
            }
            result.neg2_log_likelihood = result.neg2_log_likelihood + cost;
        }
        result
    }
}

/// What is known of a beam's end so far.
#[derive(Clone, Copy)]
pub(super) struct ExpectedHit<S> {
    /// The inverse range of the nearest wall that is surely in its way, 0 for none, what that costs, and how the inverse
    /// range changes with the bearing.
    pub(super) certain: S,
    cost: S,
    slope: S,
    /// The wall that may be in its way and explains it best, likewise.
    possible: S,
    possible_cost: S,
    possible_slope: S,
}

impl<S: Float> ExpectedHit<S> {
    /// Inverse range, slope and cost of the wall at which the beam ends.
    #[inline]
    fn most_likely(&self) -> (S, S, S) {
        if self.possible < self.certain || self.cost < self.possible_cost {
            (self.certain, self.slope, self.cost)
        } else {
            (self.possible, self.possible_slope, self.possible_cost)
        }
    }
}

/// How well the end of a beam is known.
pub(super) struct BeamUncertainty<S> {
    noise: BeamNoise<S>,
    /// The variance of the place \[m²] and of the heading \[rad²].
    position: S,
    heading: S,
}

impl<S: Float> BeamUncertainty<S> {
    /// What a beam costs that ends at a wall of inverse range `u` and slope `slope`, or elsewhere.
    #[inline]
    fn cost(&self, beam: &Beam<S>, u: S, slope: S) -> S {
        let off = beam.inverse - u;
        let squared = off.squared().div_or_zero(self.variance(u, slope));
        squared.min(if off > S::from_f64(0.0) {
            S::from_f64(MAX_SHORT_COST)
        } else {
            S::from_f64(MAX_BEHIND_WALL_COST)
        })
    }

    /// The variance of the inverse range where it is `u` and changes by `slope` per radian.
    #[inline]
    fn variance(&self, u: S, slope: S) -> S {
        let noise = BeamNoise {
            range: self.noise.range + self.position,
            bearing: self.noise.bearing + self.heading + self.position * u.squared(),
        };
        noise.variance(u, slope)
    }

    /// How near the end of a wall a beam may slip past it \[rad].
    fn edge_angle(&self, end: &Beam<S>) -> S {
        let variance = self.noise.bearing + self.heading + self.position * end.inverse.squared();
        S::from_f64(HIT_GATE) * variance.sqrt()
    }
}

/// A beam to `point`.
fn beam_to<S: Float>(point: Point<Laser, S>) -> Beam<S> {
    let range = point.distance(Point::new(S::from_f64(0.0), S::from_f64(0.0)));
    let inverse = S::from_f64(1.0).div_or_zero(range);
    Beam { cos: point.x * inverse, sin: point.y * inverse, range, inverse, number: 0 }
}

/// The sine of the turn from one beam to another: positive where it is to the left.
#[inline]
fn sin_between<S: Float>(from: &Beam<S>, to: &Beam<S>) -> S {
    from.cos * to.sin - from.sin * to.cos
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Angle, Point, Pose};
    use crate::linalg::Covariance;
    use crate::map::Wall;

    use super::{BeamStats, BeamSubset};
    use crate::lidar::{RangeFinder, Scan};

    fn laser() -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: Pose::new(0.1, 0.0, Angle::zero()),
            range_std: 0.03,
            bearing_std: 0.004,
            range_min: 0.05,
            range_max: 20.0,
        }
    }

    fn wall(from: (f64, f64), to: (f64, f64)) -> Wall<f64> {
        Wall::between(Point::new(from.0, from.1), Point::new(to.0, to.1)).unwrap()
    }

    /// Five beams, 45° apart, from right to left.
    fn evaluate(ranges: &[f64; 5], walls: &[Wall<f64>]) -> BeamStats<f64> {
        let scan = Scan::new(Angle::from_degrees(-90.0), 45.0_f64.to_radians(), ranges);
        let subset = BeamSubset::<f64, 8>::from_scan(&laser(), &scan).unwrap();
        let pose = Pose::new(0.9, 1.0, Angle::zero());
        subset.evaluate(pose, &Covariance::from_std([0.0; 3]), walls)
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
        let all = evaluate(&[1.0, root, 2.0, root, 0.5], &room);
        assert_eq!((all.beams, all.hits, all.short, all.behind_wall), (5, 5, 0, 0));
        assert!(all.neg2_log_likelihood < 1e-9);
        let mixed = evaluate(&[0.7, root, f64::NAN, root, 1.0], &room);
        assert_eq!((mixed.beams, mixed.hits, mixed.short, mixed.behind_wall), (4, 2, 1, 1));
        assert!((mixed.neg2_log_likelihood - 28.0).abs() < 1e-9, "{}", mixed.neg2_log_likelihood);
        assert!((mixed.hit_ratio() - 0.5).abs() < 1e-12);
        assert!((mixed.behind_wall_ratio() - 0.25).abs() < 1e-12);
        // Without a wall, whatever came back is before it.
        assert_eq!(evaluate(&[1.0; 5], &[]).short, 5);
    }

    #[test]
    fn nothing_seen_contradicts_nothing() {
        let none = evaluate(&[f64::INFINITY, f64::NAN, 0.0, -1.0, 1e9], &[wall((3.0, 2.0), (3.0, 0.0))]);
        assert_eq!(none.beams, 0);
        assert!(none.hit_ratio() >= 1.0 && none.behind_wall_ratio() <= 0.0);
    }
}
