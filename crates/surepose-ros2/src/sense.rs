//! Converts sensor messages to the driver's measurements.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Body, Pose};
use surepose::lidar::MAX_SWEEP_DURATION;
use surepose::time::Stamped;
use surepose_config::CompassParameters;

use crate::convert::{MessageError, heading_of, pose_of, stamp_of};
use crate::driver::{self, Odom, SensorMessage};
use crate::extrinsics::LaserExtrinsics;
use crate::message::{self, Imu, LaserScan, Odometry};

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

/// Heading of the body by a compass that is mounted with `body_from_compass`.
///
/// Its standard deviation is the stated one, or else the configured one.
///
/// # Errors
/// [`MessageError`] for a missing or invalid orientation.
pub(crate) fn heading(
    message: &Imu,
    body_from_compass: &UnitQuaternion<f64>,
    compass: &CompassParameters,
) -> Result<Stamped<SensorMessage>, MessageError> {
    let [unknown, .., variance] = message.orientation_covariance;
    if unknown < 0.0 {
        return Err(MessageError::NotMeasured);
    }
    let std = if variance > 0.0 { variance.sqrt() } else { compass.std };
    let heading = heading_of(&body_orientation(&message.orientation, body_from_compass)?)? - compass.offset;
    let measurement = Measurement::Heading(HeadingMeasurement { heading, std });
    Ok(Stamped::new(stamp_of(message.header.stamp), SensorMessage::Measurement(measurement)))
}

/// Yaw rate of the body by a gyroscope that is mounted with `body_from_gyroscope`.
///
/// # Errors
/// [`MessageError`] for a missing or invalid angular velocity.
pub(crate) fn yaw_rate(
    message: &Imu,
    body_from_gyroscope: &UnitQuaternion<f64>,
) -> Result<Stamped<SensorMessage>, MessageError> {
    let [unknown, ..] = message.angular_velocity_covariance;
    if unknown < 0.0 {
        return Err(MessageError::NotMeasured);
    }
    let message::Vector3 { x, y, z } = message.angular_velocity;
    if ![x, y, z].iter().all(|rate| rate.is_finite()) {
        return Err(MessageError::NotFinite);
    }
    let rate = (body_from_gyroscope * Vector3::new(x, y, z)).z;
    Ok(Stamped::new(stamp_of(message.header.stamp), SensorMessage::YawRate(rate)))
}

/// Orientation of the body, from that of a compass on it.
fn body_orientation(
    world_from_compass: &message::Quaternion,
    body_from_compass: &UnitQuaternion<f64>,
) -> Result<message::Quaternion, MessageError> {
    if *body_from_compass == UnitQuaternion::identity() {
        return Ok(world_from_compass.clone());
    }
    // The rotation is validated before it is normalized.
    heading_of(world_from_compass)?;
    let message::Quaternion { x, y, z, w } = *world_from_compass;
    let turned = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * body_from_compass.inverse();
    Ok(message::Quaternion { x: turned.i, y: turned.j, z: turned.k, w: turned.w })
}

#[cfg(test)]
mod tests {
    use surepose::geometry::Angle;
    use surepose::time::Stamp;

    use crate::convert::header;

    use super::*;

    /// A gyroscope that is mounted upside down measures the opposite yaw rate.
    #[test]
    fn yaw_rate_is_that_of_the_body() {
        for (roll, expected) in [(0.0, 0.3), (180.0, -0.3)] {
            let message = Imu {
                angular_velocity: message::Vector3 { x: 0.0, y: 0.0, z: 0.3 },
                ..imu(message::Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 })
            };
            let mounting = UnitQuaternion::from_euler_angles(f64::to_radians(roll), 0.0, 0.0);
            let measured = yaw_rate(&message, &mounting).unwrap().value;
            assert!(matches!(measured, SensorMessage::YawRate(rate) if (rate - expected).abs() < 1e-12));
        }
        let missing = Imu {
            angular_velocity_covariance: [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..imu(message::Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 })
        };
        assert!(matches!(yaw_rate(&missing, &UnitQuaternion::identity()), Err(MessageError::NotMeasured)));
    }

    fn imu(orientation: message::Quaternion) -> Imu {
        let nothing = message::Vector3 { x: 0.0, y: 0.0, z: 0.0 };
        Imu {
            header: header(Stamp::default(), ""),
            orientation,
            orientation_covariance: [0.0; 9],
            angular_velocity: nothing.clone(),
            angular_velocity_covariance: [0.0; 9],
            linear_acceleration: nothing,
            linear_acceleration_covariance: [0.0; 9],
        }
    }

    /// The body faces 40°; the compass is mounted with a yaw of 90° and upside down.
    #[test]
    fn heading_is_that_of_the_body() {
        let compass = CompassParameters { std: 0.1, offset: Angle::zero(), latency: 0.0 };
        let world_from_body = UnitQuaternion::from_euler_angles(0.0, 0.0, 40_f64.to_radians());
        for (roll, yaw) in [(0.0, 0.0), (0.0, 90.0), (180.0, 90.0), (180.0, -30.0)] {
            let body_from_compass =
                UnitQuaternion::from_euler_angles(f64::to_radians(roll), 0.0, f64::to_radians(yaw));
            let turned = world_from_body * body_from_compass;
            let message = imu(message::Quaternion { x: turned.i, y: turned.j, z: turned.k, w: turned.w });
            let measured = heading(&message, &body_from_compass, &compass).unwrap().value;
            let SensorMessage::Measurement(Measurement::Heading(measured)) = measured else {
                panic!("{measured:?}")
            };
            assert!((measured.heading.degrees() - 40.0).abs() < 1e-9, "{roll} {yaw}: {measured:?}");
        }
    }
}
