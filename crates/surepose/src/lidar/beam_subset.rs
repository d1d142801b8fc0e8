//! Beam-by-beam comparison of a scan with the map at a pose, without line extraction.

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

/// Gate of an explained beam, in standard deviations: 1 beam of 370 lies outside by noise alone.
const HIT_GATE: f64 = 3.0;

/// Maximum cost of a beam that ends before the wall: −2 log of the likelihood ratio of unmapped object to wall.
///
/// Beam model of [Thrun2005] Sec. 6.3, with the sum of its parts replaced by the largest. A range of σ 3 cm has a
/// density of 13 per meter at its wall. People hide a fifth of the beams over some 4 m, 0.05 per meter.
const MAX_SHORT_COST: f64 = 11.0;

/// Maximum cost of a beam that ends behind the wall: one beam of a hundred, uniformly distributed.
const MAX_BEHIND_WALL_COST: f64 = 17.0;

/// A scan, or an even selection of its beams, for comparison with the map from many poses.
///
/// One [`BeamSubset::evaluate`] costs `BEAMS` times the number of walls.
#[derive(Clone, Copy, Debug)]
pub struct BeamSubset<S, const BEAMS: usize> {
    beams: [Beam<S>; BEAMS],
    len: usize,
    /// Longest range \[m].
    pub(super) max_range: S,
    noise: BeamNoise<S>,
    body_from_laser: Pose<Body, Laser, S>,
}

impl<S: Float, const BEAMS: usize> BeamSubset<S, BEAMS> {
    /// Selects up to `BEAMS` beams of `scan`, evenly spread; beams without a return are left out.
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

    /// Empty subset for this laser.
    pub(super) fn new(laser: &RangeFinder<S>) -> Self {
        let (noise, body_from_laser) = (BeamNoise::from_laser(laser), laser.body_from_laser);
        Self { beams: [Beam::default(); BEAMS], len: 0, max_range: S::from_f64(0.0), noise, body_from_laser }
    }

    /// Indices and ranges \[m] of up to `BEAMS` beams, evenly spread.
    pub(super) fn sampled<'a>(scan: &Scan<'a, S>) -> impl Iterator<Item = (usize, S)> + use<'a, S, BEAMS> {
        let stride = scan.ranges.len().div_ceil(BEAMS.max(1)).max(1);
        scan.ranges.iter().copied().enumerate().step_by(stride)
    }

    /// Appends a beam; a full subset is unchanged.
    pub(super) fn push(&mut self, beam: Beam<S>) {
        if let Some(slot) = self.beams.get_mut(self.len) {
            *slot = beam;
            self.len += 1;
        }
    }

    /// Every second beam, for a coarse first evaluation at half the cost.
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

    /// Number of beams.
    pub fn beams(&self) -> usize {
        self.len
    }

    /// Evaluates the agreement of the scan with `walls` at `pose`, whose uncertainty is `covariance`.
    ///
    /// A beam ends at the nearest wall on its ray, which is the wall with the largest inverse range there. The pose
    /// uncertainty adds to the error of each beam, along the beam and across it, overestimated by at most a factor of
    /// two. A beam near the edge of a wall ends there or at the wall behind, whichever costs less.
    pub fn evaluate(
        &self,
        pose: Pose<Map, Body, S>,
        covariance: &Covariance<S, 3>,
        walls: &[Wall<S>],
    ) -> BeamStats<S> {
        self.stats(&self.ray_cast(pose, &self.uncertainty(covariance), walls))
    }

    /// Pose measured by the explained beams, linearized at the belief, and the agreement with `walls` there.
    ///
    /// # Errors
    /// [`InvalidCovariance`] for values that are not finite.
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

    /// Evaluates the agreement with `walls` at `pose` and adds the explained beams to `equations`, the normal equations
    /// of a pose at `center` that moves with it.
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
        // Displacement of the laser per radian of turn of the pose at the center.
        let lever = (center.y - map_from_laser.y, map_from_laser.x - center.x);
        for (beam, expected) in self.beams[..self.len].iter().zip(&expected_hits) {
            let (u, slope, cost) = expected.most_likely();
            if cost < S::from_f64(HIT_GATE * HIT_GATE) {
                // u = a·cos φ + b·sin φ changes by u·(a, b) with a displacement of the laser and by ∂u/∂φ with its
                // turn.
                let (a, b) = (u * beam.cos - slope * beam.sin, u * beam.sin + slope * beam.cos);
                let step = (u * (a * cos - b * sin), u * (a * sin + b * cos));
                let row = [step.0, step.1, slope + step.0 * lever.0 + step.1 * lever.1];
                // The pose uncertainty counts as noise of the beam as well. A beam near an edge that is given to the
                // wrong wall then has less weight, and the information on the pose is underestimated rather than
                // overestimated.
                let weight = S::from_f64(1.0).div_or_zero(uncertainty.variance(u, slope));
                equations.add(row, beam.inverse - u, weight);
            }
        }
        self.stats(&expected_hits)
    }

    /// End points of the beams in the body frame.
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
            // A wall beyond the end of the longest beam has no effect: every beam ends before it.
            if wall.distance(map_from_laser.origin()) > max_distance {
                continue;
            }
            let [a, b] = wall.ends().map(|end| beam_to(laser_from_map * end));
            // The ends of the wall from right to left in the view of the laser.
            let (right, left) = if sin_between(&a, &b) > zero { (a, b) } else { (b, a) };
            let line = InverseRangeLine::through(&right, &left);
            let (right_edge, left_edge) = (uncertainty.edge_angle(&right), uncertainty.edge_angle(&left));
            for (expected, beam) in expected_hits.iter_mut().zip(beams) {
                let (from_right, to_left) = (sin_between(&right, beam), sin_between(beam, &left));
                if from_right > -right_edge && to_left > -left_edge {
                    let (u, slope) = line.at(beam);
                    let is_certain = from_right > right_edge && to_left > left_edge;
                    // A wall behind one that certainly blocks the beam has no effect.
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

/// Walls found on the ray of a beam.
#[derive(Clone, Copy)]
pub(super) struct ExpectedHit<S> {
    /// Inverse range \[1/m] of the nearest wall that certainly blocks the beam, 0 for none. Its cost and its change
    /// with the bearing follow.
    pub(super) certain: S,
    cost: S,
    slope: S,
    /// Inverse range of the uncertain wall with the least cost; its cost and its slope follow.
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

/// Uncertainty of the end of a beam.
pub(super) struct BeamUncertainty<S> {
    noise: BeamNoise<S>,
    /// Variances of the position \[m²] and of the heading \[rad²].
    position: S,
    heading: S,
}

impl<S: Float> BeamUncertainty<S> {
    /// Cost of a beam for a wall of inverse range `u` and slope `slope`, or for an unmapped object.
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

    /// Variance of the inverse range where it is `u` and changes by `slope` per radian.
    #[inline]
    fn variance(&self, u: S, slope: S) -> S {
        let noise = BeamNoise {
            range: self.noise.range + self.position,
            bearing: self.noise.bearing + self.heading + self.position * u.squared(),
        };
        noise.variance(u, slope)
    }

    /// Angle to the end of a wall below which a beam may miss the wall \[rad].
    fn edge_angle(&self, end: &Beam<S>) -> S {
        let variance = self.noise.bearing + self.heading + self.position * end.inverse.squared();
        S::from_f64(HIT_GATE) * variance.sqrt()
    }
}

/// Beam from the laser to `point`.
fn beam_to<S: Float>(point: Point<Laser, S>) -> Beam<S> {
    let range = point.distance(Point::new(S::from_f64(0.0), S::from_f64(0.0)));
    let inverse = S::from_f64(1.0).div_or_zero(range);
    Beam { cos: point.x * inverse, sin: point.y * inverse, range, inverse, number: 0 }
}

/// Sine of the turn from one beam to another, positive to the left.
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

    /// Evaluates five beams, 45° apart, from right to left.
    fn evaluate(ranges: &[f64; 5], walls: &[Wall<f64>]) -> BeamStats<f64> {
        let scan = Scan::new(Angle::from_degrees(-90.0), 45.0_f64.to_radians(), ranges);
        let subset = BeamSubset::<f64, 8>::from_scan(&laser(), &scan).unwrap();
        let pose = Pose::new(0.9, 1.0, Angle::zero());
        subset.evaluate(pose, &Covariance::from_std([0.0; 3]), walls)
    }

    /// From (1, 1): walls 1 m to the right and left, 2 m ahead, √2 m between, and a plate on the left.
    #[test]
    fn beams_count_as_hit_short_or_behind_wall() {
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
        // Without walls every return is short.
        assert_eq!(evaluate(&[1.0; 5], &[]).short, 5);
    }

    #[test]
    fn scan_without_returns_has_hit_ratio_one() {
        let none = evaluate(&[f64::INFINITY, f64::NAN, 0.0, -1.0, 1e9], &[wall((3.0, 2.0), (3.0, 0.0))]);
        assert_eq!(none.beams, 0);
        assert!(none.hit_ratio() >= 1.0 && none.behind_wall_ratio() <= 0.0);
    }
}
