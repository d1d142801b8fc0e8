//! Converts sensor messages to the driver's measurements.

use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Body, Pose};
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

/// Scan of a laser with these extrinsics; ranges are validated per beam.
///
/// # Errors
/// [`MessageError::NotFinite`] for invalid beam angles.
pub(crate) fn scan(
    message: LaserScan,
    laser_extrinsics: LaserExtrinsics,
) -> Result<Stamped<SensorMessage>, MessageError> {
    let LaserExtrinsics { body_from_laser, is_upside_down } = laser_extrinsics;
    let side = if is_upside_down { -1.0 } else { 1.0 };
    let bearing = |angle: f32| side * f64::from(angle);
    let (angle_min, angle_increment) = (bearing(message.angle_min), bearing(message.angle_increment));
    if !angle_min.is_finite() || !angle_increment.is_finite() {
        return Err(MessageError::NotFinite);
    }
    // Drivers without a range limit report 0, infinity or NaN.
    let known = |reach: f32| Some(f64::from(reach)).filter(|reach| *reach > 0.0);
    let scan = driver::LaserScan {
        angle_min,
        angle_increment,
        range_min: known(message.range_min).unwrap_or(0.0).min(MAX_RANGE),
        range_max: known(message.range_max).unwrap_or(MAX_RANGE).min(MAX_RANGE),
        body_from_laser,
        ranges: message.ranges.into_iter().map(f64::from).collect(),
    };
    Ok(Stamped::new(stamp_of(message.header.stamp), SensorMessage::Scan(scan)))
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
