//! Deskewing: a scan that took time becomes one that was taken at one moment.
//!
//! A spinning laser measures its beams one after the other, while the robot moves. At 1 rad/s a sweep of 0.1 s displaces a
//! wall 3 m away by up to 0.3 m from its first beam to its last. Odometry between the beams is known well: each beam is moved
//! to where the laser would have measured its end at the reference time.

use crate::estimation::{SWEEP_KNOTS, SweepMotion};
use crate::geometry::{Angle, Laser, Point, Pose};
use crate::scalar::Float;

use super::scan::{RangeFinder, Scan, ScanError};

/// Memory for a deskewed scan of up to `BEAMS` beams; it keeps no state from one scan to the next.
#[derive(Clone, Debug)]
pub struct Deskewer<S, const BEAMS: usize> {
    ranges: [S; BEAMS],
    bearings: [Angle<S>; BEAMS],
}

impl<S: Float, const BEAMS: usize> Default for Deskewer<S, BEAMS> {
    fn default() -> Self {
        Self { ranges: [S::from_f64(0.0); BEAMS], bearings: [Angle::zero(); BEAMS] }
    }
}

impl<S: Float, const BEAMS: usize> Deskewer<S, BEAMS> {
    /// The scan that `laser` would have taken at the reference time of `motion`.
    ///
    /// Between two poses of `motion` the pose is interpolated linearly. A robot with speed v, turn rate ω and acceleration a
    /// deviates from that by at most (|vω| + |a|)·(T/8)²/8 in a sweep of duration T: 0.02 mm at 0.5 m/s, 1 rad/s and
    /// 0.5 m/s² in 0.1 s. A beam without a return is turned, and keeps its range.
    ///
    /// # Errors
    /// [`ScanError`] for a scan or laser that is invalid.
    pub fn deskew<'a>(
        &'a mut self,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        motion: &SweepMotion<S>,
    ) -> Result<Scan<'a, S>, ScanError> {
        laser.check()?;
        scan.check(BEAMS)?;
        let laser_from_body = laser.body_from_laser.inverse();
        let knots = motion.reference_from_body.map(|pose| laser_from_body * pose * laser.body_from_laser);
        let count = scan.ranges.len();
        let knots_per_beam = (SWEEP_KNOTS - 1) as f64 / count.saturating_sub(1).max(1) as f64;
        let slots = self.ranges.iter_mut().zip(&mut self.bearings);
        for ((number, range), (moved_range, moved_bearing)) in scan.ranges.iter().enumerate().zip(slots) {
            let laser_then = interpolate(&knots, number as f64 * knots_per_beam);
            let bearing = scan.angle(number) + laser_then.heading;
            (*moved_range, *moved_bearing) = (*range, bearing);
            if laser.is_return(*range) {
                let (sin, cos) = bearing.sin_cos();
                let end = Point::new(laser_then.x + *range * cos, laser_then.y + *range * sin);
                (*moved_range, *moved_bearing) = Point::<Laser, S>::default().polar_to(end);
            }
        }
        Ok(Scan {
            ranges: self.ranges.get(..count).unwrap_or(&[]),
            bearings: self.bearings.get(..count),
            angle_min: scan.angle_min,
            angle_increment: scan.angle_increment,
            time_increment: 0.0,
            geometry: scan.geometry,
        })
    }
}

/// Pose of the laser at a time in units of the knots' spacing.
fn interpolate<S: Float>(knots: &[Pose<Laser, Laser, S>; SWEEP_KNOTS], time: f64) -> Pose<Laser, Laser, S> {
    let index = (time as usize).min(SWEEP_KNOTS - 2);
    let (before, after) = (knots[index], knots[index + 1]);
    let part = S::from_f64(time - index as f64);
    let turn = (after.heading - before.heading).radians();
    Pose::new(
        before.x + (after.x - before.x) * part,
        before.y + (after.y - before.y) * part,
        before.heading.rotated_by(turn * part),
    )
}
