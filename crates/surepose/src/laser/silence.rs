//! Beams that did not come back, where a wall should have sent them back: a robot that was carried out of sight of all
//! walls sees nothing that contradicts it.

use crate::estimate::Belief;
use crate::scalar::Float;

use super::beam::Beam;
use super::glance::Glance;
use super::scan::{RangeFinder, Scan, ScanRefusal};
use super::wall::Wall;

/// Up to this part of the longest range that came back, walls send beams back: farther ones may be too dark for that.
const WITHIN: f64 = 0.8;

/// The beams of a scan that went into the void.
#[derive(Clone, Copy, Debug)]
pub struct Silence<S, const BEAMS: usize> {
    beams: Glance<S, BEAMS>,
}

impl<S: Float, const BEAMS: usize> Silence<S, BEAMS> {
    /// The beams of `scan` that [`Glance::of`] left out because nothing came back; what is no number is broken, not silent.
    ///
    /// # Errors
    /// [`ScanRefusal`]; a scan may have any number of beams.
    pub fn of(laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> Result<Self, ScanRefusal> {
        laser.check()?;
        scan.check(usize::MAX)?;
        let mut beams = Glance::none(laser);
        for (number, range) in Glance::<S, BEAMS>::chosen(scan) {
            if laser.came_back(range) {
                beams.reach = beams.reach.max(range);
            } else if range > laser.farthest {
                let (sin, cos) = scan.bearing(number).sin_cos();
                let zero = S::of(0.0);
                beams.push(Beam { cos, sin, range, inverse: zero, number: number as u16 });
            }
        }
        Ok(Self { beams })
    }

    /// How many of them a wall should have sent back, seen from what is believed.
    ///
    /// How far the laser sees is what it has just shown: none are missing from a scan in which nothing came back, which is
    /// broken rather than elsewhere.
    pub fn missing(&self, belief: &Belief<S>, walls: &[Wall<S>]) -> u16 {
        let within = S::of(1.0).over_positive(S::of(WITHIN) * self.beams.reach);
        if within <= S::of(0.0) {
            return 0;
        }
        let vague = self.beams.vague(&belief.covariance);
        let fates = self.beams.fates(belief.pose, &vague, walls);
        fates[..self.beams.beams()].iter().filter(|fate| fate.surely > within).count() as u16
    }
}

#[cfg(test)]
mod tests {
    use super::Silence;
    use crate::{Angle, Belief, Point, Pose, RangeFinder, Scan, Wall};

    /// Walls 2 m ahead and, seen at 45° to the left, √2 m away; beams to the right, ahead and to the left, 45° apart.
    fn missing(ranges: &[f64; 5]) -> u16 {
        let laser = RangeFinder {
            body_from_laser: Pose::identity(),
            range_std: 0.03,
            bearing_std: 0.004,
            nearest: 0.05,
            farthest: 20.0,
        };
        let first_bearing = Angle::from_degrees(-90.0);
        let scan = Scan { first_bearing, bearing_step: core::f64::consts::FRAC_PI_4, ranges };
        let walls = [((2.0, -0.5), (2.0, 0.5)), ((0.5, 1.5), (1.5, 0.5))];
        let walls = walls.map(|(a, b)| Wall::between(Point::new(a.0, a.1), Point::new(b.0, b.1)).unwrap());
        let belief = Belief::new(Pose::new(0.0, 0.0, Angle::zero()), [0.01; 3]);
        Silence::<f64, 8>::of(&laser, &scan).unwrap().missing(&belief, &walls)
    }

    #[test]
    fn walls_send_beams_back_as_far_as_the_laser_was_seen_to_see() {
        let void = f64::INFINITY;
        assert_eq!(missing(&[5.0, void, void, void, void]), 2);
        assert_eq!(missing(&[5.0, void, 2.0, void, void]), 1);
        assert_eq!(missing(&[2.0, void, void, void, void]), 1, "2 m may be too far, then");
        assert_eq!(missing(&[5.0, void, f64::NAN, f64::NAN, void]), 0, "broken is not silent");
        assert_eq!(missing(&[void; 5]), 0, "nothing shows that the laser sees at all");
    }
}
