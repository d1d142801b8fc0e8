//! Converts sensor messages to the driver's measurements.

use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Body, Pose};
use surepose::lidar::MAX_SWEEP_DURATION;
use surepose::time::Stamped;
use surepose_config::CompassParameters;

use crate::convert::{MessageError, heading_of, pose_of, stamp_of};
use crate::driver::{self, Odom, SensorMessage};
use crate::extrinsics::LaserExtrinsics;
use crate::message::{Imu, LaserScan, Odometry};

/// Longest range of a laser \[m].
const MAX_RANGE: f64 = 200.0;

/// Pose of an odometry message.
///
/// # Errors
/// [`MessageError`] for an invalid pose.
pub(crate) fn odometry(message: &Odometry) -> Result<Stamped<Pose<Odom, Body, f64>>, MessageError> {
    Ok(Stamped::new(stamp_of(message.header.stamp), pose_of(&message.pose.pose)?))
}

/// Largest difference between the number of beams and that by the angles, unless 5 % are more: drivers round.
const MAX_BEAM_DIFFERENCE: f64 = 2.0;

/// Scan of a laser with these extrinsics.
///
/// Invalid scans are passed on: the navigator counts them, and stops a robot whose laser is blind. Angles that
/// contradict the number of beams become NaN.
pub(crate) fn scan(message: LaserScan, laser_extrinsics: LaserExtrinsics) -> Stamped<SensorMessage> {
    let LaserExtrinsics { body_from_laser, is_upside_down } = laser_extrinsics;
    let side = if is_upside_down { -1.0 } else { 1.0 };
    let bearing = |angle: f32| side * f64::from(angle);
    let (angle_min, angle_increment) = (bearing(message.angle_min), bearing(message.angle_increment));
    let angle_increment = if has_consistent_angles(&message) { angle_increment } else { f64::NAN };
    let sweep = f64::from(message.time_increment) * message.ranges.len().saturating_sub(1) as f64;
    // A driver that states a longer sweep fills the field in wrongly.
    let is_sweep = (0.0..=MAX_SWEEP_DURATION).contains(&sweep);
    // Drivers without a range limit report 0, infinity or NaN.
    let known = |reach: f32| Some(f64::from(reach)).filter(|reach| *reach > 0.0);
    let scan = driver::LaserScan {
        angle_min,
        angle_increment,
        range_min: known(message.range_min).unwrap_or(0.0).min(MAX_RANGE),
        range_max: known(message.range_max).unwrap_or(MAX_RANGE).min(MAX_RANGE),
        body_from_laser,
        time_increment: if is_sweep { f64::from(message.time_increment) } else { 0.0 },
        ranges: message.ranges.into_iter().map(f64::from).collect(),
    };
    Stamped::new(stamp_of(message.header.stamp), SensorMessage::Scan(scan))
}

/// Whether the angles of a scan give about the number of its beams. A driver that leaves `angle_max` 0 is not judged.
fn has_consistent_angles(message: &LaserScan) -> bool {
    let span = f64::from(message.angle_max) - f64::from(message.angle_min);
    let beams = (span / f64::from(message.angle_increment)).abs() + 1.0;
    let difference = (beams - message.ranges.len() as f64).abs();
    message.angle_max == 0.0 || difference <= MAX_BEAM_DIFFERENCE.max(0.05 * beams)
}

/// Heading of a compass with its stated variance, or else with the configured one.
///
/// # Errors
/// [`MessageError`] for a missing or invalid orientation.
pub(crate) fn heading(
    message: &Imu,
    laser_extrinsics: &CompassParameters,
) -> Result<Stamped<SensorMessage>, MessageError> {
    let [unknown, .., variance] = message.orientation_covariance;
    if unknown < 0.0 {
        return Err(MessageError::NotMeasured);
    }
    let std = if variance > 0.0 { variance.sqrt() } else { laser_extrinsics.std };
    let heading = heading_of(&message.orientation)? - laser_extrinsics.offset;
    let measurement = Measurement::Heading(HeadingMeasurement { heading, std });
    Ok(Stamped::new(stamp_of(message.header.stamp), SensorMessage::Measurement(measurement)))
}
