//! Beams without a return where the map predicts one. They are the only evidence against the pose of a robot that was
//! moved out of sight of all walls.

use crate::estimation::Belief;
use crate::map::Wall;
use crate::scalar::Float;

use super::beam::Beam;
use super::beam_subset::BeamSubset;
use super::scan::{RangeFinder, Scan, ScanError};

/// Maximum distance of a wall that must return a beam, as a fraction of the longest return: farther walls may be too
/// dark.
const MAX_RANGE_FRACTION: f64 = 0.8;

/// The beams of a scan without a return.
#[derive(Clone, Copy, Debug)]
pub struct MissedReturns<S, const BEAMS: usize> {
    beams: BeamSubset<S, BEAMS>,
}

impl<S: Float, const BEAMS: usize> MissedReturns<S, BEAMS> {
    /// Selects the beams of `scan` that [`BeamSubset::from_scan`] leaves out for lack of a return. NaN ranges count as
    /// invalid, not as missing returns.
    ///
    /// # Errors
    /// [`ScanError`]; a scan may have any number of beams.
    pub fn from_scan(laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> Result<Self, ScanError> {
        Self::select(laser, scan, |range| range > laser.range_max)
    }

    /// Selects all beams of `scan` without a return, whether it is missing or invalid.
    ///
    /// # Errors
    /// [`ScanError`]; a scan may have any number of beams.
    pub fn without_return(laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> Result<Self, ScanError> {
        Self::select(laser, scan, |_| true)
    }

    /// Selects the beams without a return whose range fulfills a condition.
    fn select(
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        is_selected: impl Fn(S) -> bool,
    ) -> Result<Self, ScanError> {
        laser.check()?;
        scan.check(usize::MAX)?;
        let mut beams = BeamSubset::new(laser);
        for (number, range) in BeamSubset::<S, BEAMS>::sampled(scan) {
            if laser.is_return(range) {
                beams.max_range = beams.max_range.max(range);
            } else if is_selected(range) {
                let (sin, cos) = scan.angle(number).sin_cos();
                let zero = S::from_f64(0.0);
                beams.push(Beam { cos, sin, range, inverse: zero, number: number as u16 });
            }
        }
        Ok(Self { beams })
    }

    /// Number of beams that a wall should have returned, given the belief.
    ///
    /// The range of the laser is taken from the returns of the same scan. A scan without any return counts 0: it
    /// indicates a broken laser rather than a wrong pose.
    pub fn count(&self, belief: &Belief<S>, walls: &[Wall<S>]) -> u16 {
        self.count_within(S::from_f64(MAX_RANGE_FRACTION) * self.beams.max_range, belief, walls)
    }

    /// Number of beams that a wall within `distance` \[m] should have returned, given the belief; 0 for a distance of 0.
    pub fn count_within(&self, distance: S, belief: &Belief<S>, walls: &[Wall<S>]) -> u16 {
        let max_distance = S::from_f64(1.0).div_or_zero(distance);
        if max_distance <= S::from_f64(0.0) {
            return 0;
        }
        let mut beams = self.beams;
        beams.max_range = beams.max_range.max(distance);
        let uncertainty = beams.uncertainty(&belief.covariance);
        let expected_hits = beams.ray_cast(belief.pose, &uncertainty, walls);
        expected_hits[..beams.beams()].iter().filter(|expected| expected.certain > max_distance).count()
            as u16
    }
}

#[cfg(test)]
mod tests {
    use crate::estimation::Belief;
    use crate::geometry::{Angle, Point, Pose};
    use crate::map::Wall;

    use super::MissedReturns;
    use crate::lidar::{RangeFinder, Scan};

    /// Walls 2 m ahead and √2 m away at 45° to the left; beams to the right, ahead and to the left, 45° apart.
    fn missed_returns(ranges: &[f64; 5]) -> u16 {
        let laser = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: 0.03,
            bearing_std: 0.004,
            range_min: 0.05,
            range_max: 20.0,
        };
        let angle_min = Angle::from_degrees(-90.0);
        let scan = Scan::new(angle_min, core::f64::consts::FRAC_PI_4, ranges);
        let walls = [((2.0, -0.5), (2.0, 0.5)), ((0.5, 1.5), (1.5, 0.5))];
        let walls = walls.map(|(a, b)| Wall::between(Point::new(a.0, a.1), Point::new(b.0, b.1)).unwrap());
        let belief = Belief::new(Pose::new(0.0, 0.0, Angle::zero()), [0.01; 3]);
        MissedReturns::<f64, 8>::from_scan(&laser, &scan).unwrap().count(&belief, &walls)
    }

    #[test]
    fn missed_returns_count_within_the_observed_range() {
        let void = f64::INFINITY;
        assert_eq!(missed_returns(&[5.0, void, void, void, void]), 2);
        assert_eq!(missed_returns(&[5.0, void, 2.0, void, void]), 1);
        assert_eq!(
            missed_returns(&[2.0, void, void, void, void]),
            1,
            "2 m exceeds 0.8 of the longest return"
        );
        assert_eq!(missed_returns(&[5.0, void, f64::NAN, f64::NAN, void]), 0, "NaN ranges are invalid");
        assert_eq!(missed_returns(&[void; 5]), 0, "a scan without returns counts 0");
    }
}
