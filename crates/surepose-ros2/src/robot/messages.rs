//! Messages of the simulated robot.

use surepose::geometry::{Angle, Body, Laser, Pose};
use surepose::kinematics::Twist;
use surepose::time::Stamp;
use surepose_sim::SimulatedScan;

use crate::convert::{header, pose_message, rotation_of, transform, twist_message};
use crate::driver::Odom;
use crate::message::{
    Imu, LaserScan, Odometry, PoseWithCovariance, TfMessage, Transform, TransformStamped,
    TwistWithCovariance, Vector3,
};

/// Shortest and longest range of its laser \[m].
const REACH: [f32; 2] = [0.05, 30.0];

/// Frames of its odometry, its body, its laser and its compass.
const ODOM: &str = "odom";
const BASE: &str = "base_link";
const LASER: &str = "laser";

pub(crate) fn odometry(stamp: Stamp, pose: Pose<Odom, Body, f64>, twist: Twist<f64>) -> Odometry {
    let unknown = [[0.0; 6]; 6];
    Odometry {
        header: header(stamp, ODOM),
        child_frame_id: BASE.to_owned(),
        pose: PoseWithCovariance { pose: pose_message(pose), covariance: unknown },
        twist: TwistWithCovariance { twist: twist_message(twist), covariance: unknown },
    }
}

/// Transform from odometry frame to body.
pub(super) fn rolled(stamp: Stamp, pose: Pose<Odom, Body, f64>) -> TfMessage {
    static_transform(stamp, ODOM, BASE, transform(pose))
}

/// Static transform from body to laser.
pub(crate) fn mounted(body_from_laser: Pose<Body, Laser, f64>) -> TfMessage {
    static_transform(Stamp::default(), BASE, LASER, transform(body_from_laser))
}

fn static_transform(stamp: Stamp, parent: &str, child: &str, transform: Transform) -> TfMessage {
    let static_transform =
        TransformStamped { header: header(stamp, parent), child_frame_id: child.to_owned(), transform };
    TfMessage { transforms: vec![static_transform] }
}

/// IMU message of a compass: only the heading is measured.
pub(crate) fn heading(stamp: Stamp, heading: Angle<f64>, std: f64) -> Imu {
    let (mut orientation_covariance, mut unknown) = ([0.0; 9], [0.0; 9]);
    orientation_covariance[8] = std * std;
    unknown[0] = -1.0;
    Imu {
        header: header(stamp, BASE),
        orientation: rotation_of(heading),
        orientation_covariance,
        angular_velocity: Vector3::along_z(0.0),
        angular_velocity_covariance: unknown,
        linear_acceleration: Vector3::along_z(0.0),
        linear_acceleration_covariance: unknown,
    }
}

pub(crate) fn scan(stamp: Stamp, scan: &SimulatedScan) -> LaserScan {
    let SimulatedScan { angle_min, angle_increment, ranges, time_increment } = scan;
    let last = angle_min + angle_increment * ranges.len().saturating_sub(1) as f64;
    let [range_min, range_max] = REACH;
    LaserScan {
        header: header(stamp, LASER),
        angle_min: *angle_min as f32,
        angle_max: last as f32,
        angle_increment: *angle_increment as f32,
        time_increment: *time_increment as f32,
        scan_time: 0.0,
        range_min,
        range_max,
        ranges: ranges.iter().map(|range| *range as f32).collect(),
        intensities: Vec::new(),
    }
}
