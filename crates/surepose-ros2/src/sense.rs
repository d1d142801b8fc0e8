//! What sensors' messages say to the pilot.

use surepose::{Body, Compass, Measurement, Pose, Stamped};
use surepose_data::config::CompassMounting;

use crate::convert::{Refused, heading_of, pose_of, stamp_of};
use crate::message::{Imu, LaserScan, Odometry};
use crate::mounting::Mounting;
use crate::pilot::{self, Heard, Odom};

/// No laser sees farther \[m].
const FARTHEST: f64 = 200.0;

/// Where odometry says that the robot is.
///
/// # Errors
/// [`Refused`], where that is no pose.
pub(crate) fn odometry(message: &Odometry) -> Result<Stamped<Pose<Odom, Body, f64>>, Refused> {
    Ok(Stamped::new(stamp_of(message.header.stamp), pose_of(&message.pose.pose)?))
}

/// What a laser that sits so saw; what its ranges are worth is judged beam by beam.
///
/// # Errors
/// [`Refused::NotFinite`] for bearings that are none.
pub(crate) fn scan(message: LaserScan, mounting: Mounting) -> Result<Stamped<Heard>, Refused> {
    let Mounting { body_from_laser, is_upside_down } = mounting;
    let side = if is_upside_down { -1.0 } else { 1.0 };
    let bearing = |angle: f32| side * f64::from(angle);
    let (first_bearing, bearing_step) = (bearing(message.angle_min), bearing(message.angle_increment));
    if !first_bearing.is_finite() || !bearing_step.is_finite() {
        return Err(Refused::NotFinite);
    }
    // A driver that says nothing of its reach says zero, infinite or NaN.
    let known = |reach: f32| Some(f64::from(reach)).filter(|reach| *reach > 0.0);
    let scan = pilot::LaserScan {
        first_bearing,
        bearing_step,
        nearest: known(message.range_min).unwrap_or(0.0).min(FARTHEST),
        farthest: known(message.range_max).unwrap_or(FARTHEST).min(FARTHEST),
        body_from_laser,
        ranges: message.ranges.into_iter().map(f64::from).collect(),
    };
    Ok(Stamped::new(stamp_of(message.header.stamp), Heard::Scan(scan)))
}

/// Where a compass says that the robot faces, with the variance that it states, or else with that of `mounting`.
///
/// # Errors
/// [`Refused`], where it measures no orientation, or says none.
pub(crate) fn heading(message: &Imu, mounting: &CompassMounting) -> Result<Stamped<Heard>, Refused> {
    let [unknown, .., variance] = message.orientation_covariance;
    if unknown < 0.0 {
        return Err(Refused::NotMeasured);
    }
    let std = if variance > 0.0 { variance.sqrt() } else { mounting.std };
    let heading = heading_of(&message.orientation)? - mounting.offset;
    let measurement = Measurement::Compass(Compass { heading, std });
    Ok(Stamped::new(stamp_of(message.header.stamp), Heard::Measurement(measurement)))
}
