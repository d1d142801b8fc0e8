//! Lines extracted from single scans.

use surepose::geometry::{Angle, Laser, Line, Point};
use surepose::lidar::{LineExtractor, RangeFinder, Scan};
use surepose_io::recording::ScanRecord as Recorded;

use super::model::{during, known_pose, motion};
use super::options::Options;
use super::parameter::{CalibrationParameter, Geometry};
use super::recording::{OdometryStep, locate};

/// Maximum number of beams of a scan.
const BEAMS: usize = 4096;

/// A wall segment observed in one scan.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineObservation {
    /// Index of the scan.
    pub(super) scan: usize,
    /// Stamp of the scan \[s].
    pub(super) stamp: f64,
    /// The line, in the laser frame.
    pub(super) line: Line<Laser, f64>,
    /// Inverse covariance of (r, ψ).
    pub(super) information: [[f64; 2]; 2],
    /// End points of the observed segment, in the laser frame.
    pub(super) ends: [Point<Laser, f64>; 2],
}

/// Extracts the lines of all scans, ordered by time; scans that the extractor rejects have none.
pub(super) fn line_observations(
    scans: &[Recorded],
    steps: &[OdometryStep],
    nominal: &Geometry<f64>,
    options: &Options,
) -> Vec<LineObservation> {
    let laser = RangeFinder {
        body_from_laser: nominal.body_from_laser(),
        range_std: options.range_std,
        bearing_std: options.bearing_std,
        range_min: options.range_min,
        range_max: options.range_max,
    };
    let mut extractor = Box::new(LineExtractor::<f64, BEAMS>::new());
    let mut found = Vec::new();
    let mut ranges = Vec::new();
    for (number, scan) in scans.iter().enumerate() {
        stand_still(scan, steps, nominal, options.sweep, &mut ranges);
        let still = Scan::new(Angle::from_radians(scan.angle_min), scan.angle_increment, &ranges);
        let Ok(extracted) = extractor.extract(&laser, &still) else { continue };
        found.extend(extracted.lines.iter().filter_map(|seen| {
            let rr = seen.distance_variance + options.wall_distance_std.powi(2);
            let pp = seen.direction_variance + options.wall_direction_std.powi(2);
            let rp = seen.covariance;
            let determinant = rr * pp - rp * rp;
            let (nx, ny) = seen.line.normal();
            let r = seen.line.distance;
            let end = |along: f64| Point::new(r * nx - along * ny, r * ny + along * nx);
            (determinant > 0.0).then(|| LineObservation {
                scan: number,
                stamp: scan.time,
                line: seen.line,
                information: [[pp / determinant, -rp / determinant], [-rp / determinant, rr / determinant]],
                ends: [end(seen.extent.0), end(seen.extent.1)],
            })
        }));
    }
    found
}

/// Writes into `ranges` the ranges of a robot at rest during the sweep (deskewing).
///
/// Each beam's end point is moved by the nominal odometry between its own time and that of the center beam.
/// The corrected points have uneven bearings. The range at an even bearing is interpolated between two points
/// less than 0.2 m apart. Otherwise the nearer point is used, if it is within half a step.
fn stand_still(
    scan: &Recorded,
    steps: &[OdometryStep],
    nominal: &Geometry<f64>,
    sweep: f64,
    ranges: &mut Vec<f64>,
) {
    ranges.clear();
    ranges.extend_from_slice(&scan.ranges);
    let middle = scan.time - nominal.get(CalibrationParameter::LaserLatency);
    let Some((first, fraction)) = (sweep != 0.0).then(|| locate(steps, middle)) else { return };
    let Some(step) = steps.get(first) else { return };
    let motion = motion(nominal, step.turned);
    let origin = known_pose([0.0; 3]);
    let end = origin.integrate(motion, surepose::kinematics::Integration::Arc);
    let ahead = during(origin, end, fraction) * nominal.body_from_laser();
    let mut ends = Vec::with_capacity(scan.ranges.len());
    let steps = scan.ranges.len().saturating_sub(1).max(1) as f64;
    for (beam, range) in scan.ranges.iter().enumerate().filter(|(_, range)| range.is_finite()) {
        let bearing = scan.angle(beam);
        let later = (beam as f64 / steps - 0.5) * sweep;
        let then = during(origin, end, fraction + later / step.duration) * nominal.body_from_laser();
        let (sin, cos) = bearing.sin_cos();
        let at = ahead.inverse() * (then * Point::new(range * cos, range * sin));
        // Unwrapped from the beam's own bearing, so that beams behind the robot stay in order.
        let turned = (Angle::from_radians(at.y.atan2(at.x)) - Angle::from_radians(bearing)).radians();
        ends.push((bearing + turned, at));
    }
    ranges.fill(f64::INFINITY);
    let step = scan.angle_increment;
    for pair in ends.windows(2) {
        let [(from, a), (to, b)] = [pair[0], pair[1]];
        let position = |bearing: f64| (bearing - scan.angle_min) / step;
        let (from, to) = (position(from), position(to));
        if a.distance(b) > 0.2 || to - from > 3.0 || to <= from {
            for (position, end) in [(from, a), (to, b)] {
                let nearest = position.round();
                if (0.0..scan.ranges.len() as f64).contains(&nearest)
                    && ranges[nearest as usize].is_infinite()
                {
                    ranges[nearest as usize] = end.x.hypot(end.y);
                }
            }
            continue;
        }
        let mut index = from.ceil().max(0.0);
        while index <= to && index < scan.ranges.len() as f64 {
            let (sin, cos) = scan.angle(index as usize).sin_cos();
            // The ray t·(cos, sin) meets the line a + u·(b − a) where t = (a × e)/(d × e).
            let (ex, ey) = (b.x - a.x, b.y - a.y);
            let cross = cos * ey - sin * ex;
            if cross.abs() > 1e-9 {
                ranges[index as usize] = (a.x * ey - a.y * ex) / cross;
            }
            index += 1.0;
        }
    }
}
