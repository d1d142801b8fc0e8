//! Beams that did not come back, where a wall should have sent them back: a robot that was carried out of sight of all
//! walls sees nothing that contradicts it.

use crate::estimation::Belief;
use crate::map::Wall;
use crate::scalar::Float;

use super::beam::Beam;
use super::beam_subset::BeamSubset;
use super::scan::{RangeFinder, Scan, ScanError};

/// Up to this part of the longest range that came back, walls send beams back: farther ones may be too dark for that.
const MAX_RANGE_FRACTION: f64 = 0.8;

/// The beams of a scan that went into the void.
#[derive(Clone, Copy, Debug)]
pub struct MissedReturns<S, const BEAMS: usize> {
    beams: BeamSubset<S, BEAMS>,
}

impl<S: Float, const BEAMS: usize> MissedReturns<S, BEAMS> {
    /// The beams of `scan` that [`BeamSubset::from_scan`] left out because nothing came back; what is no number is broken, not silent.
    ///
    /// # Errors
    /// [`ScanError`]; a scan may have any number of beams.
    pub fn from_scan(laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> Result<Self, ScanError> {
        laser.check()?;
        scan.check(usize::MAX)?;
        let mut beams = BeamSubset::new(laser);
        for (number, range) in BeamSubset::<S, BEAMS>::sampled(scan) {
            if laser.is_return(range) {
                beams.max_range = beams.max_range.max(range);
            } else if range > laser.range_max {
                let (sin, cos) = scan.angle(number).sin_cos();
                let zero = S::from_f64(0.0);
                beams.push(Beam { cos, sin, range, inverse: zero, number: number as u16 });
            }
        }
        Ok(Self { beams })
    }

    /// How many of them a wall should have sent back, seen from what is believed.
    ///
    /// How far the laser sees is what it has just shown: none are missing from a scan in which nothing came back, which is
    /// broken rather than elsewhere.
    pub fn count(&self, belief: &Belief<S>, walls: &[Wall<S>]) -> u16 {
        let max_distance =
            S::from_f64(1.0).div_or_zero(S::from_f64(MAX_RANGE_FRACTION) * self.beams.max_range);
        if max_distance <= S::from_f64(0.0) {
            return 0;
        }
        let uncertainty = self.beams.uncertainty(&belief.covariance);
        let expected_hits = self.beams.ray_cast(belief.pose, &uncertainty, walls);
        expected_hits[..self.beams.beams()].iter().filter(|expected| expected.certain > max_distance).count()
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

    /// Walls 2 m ahead and, seen at 45° to the left, √2 m away; beams to the right, ahead and to the left, 45° apart.
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
    fn walls_send_beams_back_as_far_as_the_laser_was_seen_to_see() {
        let void = f64::INFINITY;
        assert_eq!(missed_returns(&[5.0, void, void, void, void]), 2);
        assert_eq!(missed_returns(&[5.0, void, 2.0, void, void]), 1);
        assert_eq!(missed_returns(&[2.0, void, void, void, void]), 1, "2 m may be too far, then");
        assert_eq!(missed_returns(&[5.0, void, f64::NAN, f64::NAN, void]), 0, "broken is not silent");
        assert_eq!(missed_returns(&[void; 5]), 0, "nothing shows that the laser sees at all");
    }
}
