//! What sensors' messages say to the driver.

use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Body, Pose};
use surepose::time::Stamped;
use surepose_config::CompassParameters;

use crate::convert::{MessageError, heading_of, pose_of, stamp_of};
use crate::driver::{self, Odom, SensorMessage};
use crate::extrinsics::LaserExtrinsics;
use crate::message::{Imu, LaserScan, Odometry};

/// No laser sees farther \[m].
const FARTHEST: f64 = 200.0;

/// Where odometry says that the robot is.
///
/// # Errors
/// [`MessageError`], where that is no pose.
pub(crate) fn odometry(message: &Odometry) -> Result<Stamped<Pose<Odom, Body, f64>>, MessageError> {
    Ok(Stamped::new(stamp_of(message.header.stamp), pose_of(&message.pose.pose)?))
}

/// What a laser that sits so saw; what its ranges are worth is judged beam by beam.
///
/// # Errors
/// [`MessageError::NotFinite`] for bearings that are none.
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
    // A driver that says nothing of its reach says zero, infinite or NaN.
    let known = |reach: f32| Some(f64::from(reach)).filter(|reach| *reach > 0.0);
    let scan = driver::LaserScan {
        angle_min,
        angle_increment,
        range_min: known(message.range_min).unwrap_or(0.0).min(FARTHEST),
        range_max: known(message.range_max).unwrap_or(FARTHEST).min(FARTHEST),
        body_from_laser,
        ranges: message.ranges.into_iter().map(f64::from).collect(),
    };
    Ok(Stamped::new(stamp_of(message.header.stamp), SensorMessage::Scan(scan)))
}

/// Where a compass says that the robot faces, with the variance that it states, or else with that of `laser_extrinsics`.
///
/// # Errors
/// [`MessageError`], where it measures no orientation, or says none.
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
