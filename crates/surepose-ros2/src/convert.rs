//! Converts between ROS messages and core types, and rejects invalid messages.
//!
//! Frames are those of REP 105: x forward, y left, angles counter-clockwise, meters and radians, as in the core.

use ros2_client::builtin_interfaces::Time;
use surepose::estimation::Belief;
use surepose::geometry::{Angle, Frame, Pose};
use surepose::kinematics::Twist;
use surepose::linalg::Covariance;
use surepose::time::Stamp;
use surepose_io::owned_map::GoalProblem;

use crate::message::{self, Header, Point, Quaternion, Vector3};

/// Reason for which a message was rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MessageError {
    /// A coordinate is NaN or infinite.
    #[error("coordinates: not finite")]
    NotFinite,
    /// A position farther than 10 km from the origin, where rounding is noticeable.
    #[error("position: too far from the origin (expected at most 10 km)")]
    FarAway,
    /// A quaternion without unit length, such as zeros of an unset message.
    #[error("orientation: invalid quaternion (expected length 1); (0, 0, 0, 1) is the identity")]
    NotARotation,
    /// An invalid covariance.
    #[error("covariance: not symmetric, or a negative variance")]
    NotACovariance,
    /// The message is in another frame.
    #[error("frame: wrong frame (got '{got}', expected '{expected}')")]
    WrongFrame {
        /// The frame of the map.
        expected: String,
        /// Frame of the message.
        got: String,
    },
    /// The stamp is not later than the previous one.
    #[error("stamp: not later than the previous one")]
    OutOfOrder,
    /// The orientation is not measured: its covariance is −1.
    #[error("orientation: not measured (got covariance -1)")]
    NotMeasured,
    /// The laser's plane is not level.
    #[error(
        "laser: scan plane not level (got {degrees:.0}° by /tf_static, expected at most 10°); override with [laser] x_m, y_m, heading_deg"
    )]
    Leaning {
        /// Angle between its plane and the horizontal \[°].
        degrees: f64,
    },
    /// A goal that the walls of the map rule out.
    #[error("wall: the goal {0}")]
    Goal(GoalProblem),
}

impl MessageError {
    /// Name of the reason in the counts.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::NotFinite => "not_finite",
            Self::FarAway => "far_away",
            Self::NotARotation => "not_a_rotation",
            Self::NotACovariance => "not_a_covariance",
            Self::WrongFrame { .. } => "wrong_frame",
            Self::OutOfOrder => "out_of_order",
            Self::NotMeasured => "not_measured",
            Self::Leaning { .. } => "leaning",
            Self::Goal(_) => "wall",
        }
    }
}

/// Largest coordinate \[m].
const MAX_COORDINATE: f64 = 1e4;

/// Tolerance of a quaternion's squared length.
const SQUARED_LENGTH_SLACK: f64 = 0.1;

/// Converts a ROS time to a stamp.
pub fn stamp_of(time: Time) -> Stamp {
    Stamp::from_nanoseconds(time.to_nanos())
}

/// Converts a stamp to a ROS time.
pub fn time_of(stamp: Stamp) -> Time {
    Time::from_nanos(stamp.nanoseconds())
}

/// Header with `stamp` and `frame`.
pub fn header(stamp: Stamp, frame: &str) -> Header {
    Header { stamp: time_of(stamp), frame_id: frame.to_owned() }
}

/// Yaw of a rotation.
///
/// # Errors
/// [`MessageError::NotFinite`] and [`MessageError::NotARotation`].
pub fn heading_of(rotation: &Quaternion) -> Result<Angle<f64>, MessageError> {
    let Quaternion { x, y, z, w } = *rotation;
    if ![x, y, z, w].iter().all(|part| part.is_finite()) {
        return Err(MessageError::NotFinite);
    }
    if (x * x + y * y + z * z + w * w - 1.0).abs() > SQUARED_LENGTH_SLACK {
        return Err(MessageError::NotARotation);
    }
    Ok(Angle::from_vector(w * w + x * x - y * y - z * z, 2.0 * (w * z + x * y)))
}

/// Quaternion of a heading.
pub fn rotation_of(heading: Angle<f64>) -> Quaternion {
    let half = 0.5 * heading.radians();
    Quaternion { x: 0.0, y: 0.0, z: half.sin(), w: half.cos() }
}

/// Projects a pose in space to the plane.
///
/// # Errors
/// [`MessageError`] for an invalid pose.
pub fn pose_of<To: Frame, From: Frame>(pose: &message::Pose) -> Result<Pose<To, From, f64>, MessageError> {
    let Point { x, y, .. } = pose.position;
    if !x.is_finite() || !y.is_finite() {
        return Err(MessageError::NotFinite);
    }
    if x.abs().max(y.abs()) > MAX_COORDINATE {
        return Err(MessageError::FarAway);
    }
    Ok(Pose::new(x, y, heading_of(&pose.orientation)?))
}

/// Converts a pose in the plane to a message.
pub fn pose_message<To: Frame, From: Frame>(pose: Pose<To, From, f64>) -> message::Pose {
    let position = Point { x: pose.x, y: pose.y, z: 0.0 };
    message::Pose { position, orientation: rotation_of(pose.heading) }
}

/// Converts a pose to a transform.
pub fn transform<To: Frame, From: Frame>(pose: Pose<To, From, f64>) -> message::Transform {
    let translation = Vector3 { x: pose.x, y: pose.y, z: 0.0 };
    message::Transform { translation, rotation: rotation_of(pose.heading) }
}

/// Converts a twist in the plane to a message.
pub fn twist_message(twist: Twist<f64>) -> message::Twist {
    message::Twist { linear: Vector3::along_x(twist.v), angular: Vector3::along_z(twist.omega) }
}

/// Indices of x, y and yaw in a 6 × 6 covariance.
const ROWS: [usize; 3] = [0, 1, 5];

/// Converts a belief to a pose with covariance.
pub fn belief_message(belief: &Belief<f64>) -> message::PoseWithCovariance {
    let mut covariance = [[0.0; 6]; 6];
    for (i, row) in ROWS.iter().enumerate() {
        for (j, column) in ROWS.iter().enumerate() {
            if let Some(entry) = covariance.get_mut(*row).and_then(|row| row.get_mut(*column)) {
                *entry = belief.covariance.entry(i, j);
            }
        }
    }
    message::PoseWithCovariance { pose: pose_message(belief.pose), covariance }
}

/// Converts a pose with covariance to a belief.
///
/// A covariance of zeros, as in an unset message, gives the standard deviations `usual`: x \[m], y \[m], heading \[rad].
///
/// # Errors
/// [`MessageError`] for an invalid pose or covariance.
pub fn belief_of(told: &message::PoseWithCovariance, usual: [f64; 3]) -> Result<Belief<f64>, MessageError> {
    let pose = pose_of(&told.pose)?;
    let entry = |i: usize, j: usize| told.covariance.get(i).and_then(|row| row.get(j)).copied();
    let mut matrix = surepose::linalg::Matrix([[0.0; 3]; 3]);
    for (row, i) in matrix.0.iter_mut().zip(ROWS) {
        for (value, j) in row.iter_mut().zip(ROWS) {
            *value = entry(i, j).filter(|value| value.is_finite()).ok_or(MessageError::NotFinite)?;
        }
    }
    if matrix.0.iter().flatten().all(|value| *value == 0.0) {
        return Ok(Belief::new(pose, usual));
    }
    let covariance = Covariance::from_matrix(&matrix).map_err(|_| MessageError::NotACovariance)?;
    Ok(Belief { pose, covariance })
}

#[cfg(test)]
mod tests {
    use surepose::geometry::{Body, Map};

    use super::*;

    fn turned(x: f64, y: f64, z: f64, w: f64) -> Result<f64, MessageError> {
        heading_of(&Quaternion { x, y, z, w }).map(Angle::degrees)
    }

    #[test]
    fn pose_round_trip() {
        for degrees in [-179.0, -90.0, 0.0, 30.0, 180.0] {
            let pose: Pose<Map, Body, f64> = Pose::new(1.5, -2.0, Angle::from_degrees(degrees));
            let back: Pose<Map, Body, f64> = pose_of(&pose_message(pose)).unwrap();
            assert!((back.x, back.y) == (pose.x, pose.y));
            assert!((back.heading - pose.heading).radians().abs() < 1e-12);
        }
    }

    #[test]
    fn tilted_compass_gives_its_heading() {
        // Rotation by 40° about z, then by 5° about the body's x axis.
        let (z, x) = (20_f64.to_radians(), 2.5_f64.to_radians());
        let heading = turned(z.cos() * x.sin(), z.sin() * x.sin(), z.sin() * x.cos(), z.cos() * x.cos());
        assert!((heading.unwrap() - 40.0).abs() < 1e-9);
    }

    #[test]
    fn invalid_poses_are_rejected() {
        assert_eq!(turned(0.0, 0.0, 0.0, 0.0), Err(MessageError::NotARotation));
        assert_eq!(turned(0.0, 0.0, f64::NAN, 1.0), Err(MessageError::NotFinite));
        assert_eq!(turned(0.0, 0.0, 2.0, 1.0), Err(MessageError::NotARotation));
        let mut pose = pose_message::<Map, Body>(Pose::identity());
        for (x, why) in [
            (f64::INFINITY, MessageError::NotFinite),
            (f64::NAN, MessageError::NotFinite),
            (2e4, MessageError::FarAway),
        ] {
            pose.position.x = x;
            assert_eq!(pose_of::<Map, Body>(&pose), Err(why));
        }
    }

    #[test]
    fn belief_round_trip() {
        let matrix =
            surepose::linalg::Matrix([[0.04, 0.01, 0.002], [0.01, 0.09, -0.003], [0.002, -0.003, 0.01]]);
        let covariance = Covariance::from_matrix(&matrix).unwrap();
        let belief = Belief { pose: Pose::new(1.0, 2.0, Angle::zero()), covariance };
        let mut told = belief_message(&belief);
        let back = belief_of(&told, [1.0; 3]).unwrap();
        for (i, j) in [(0, 0), (0, 1), (1, 2), (2, 2)] {
            assert!((back.covariance.entry(i, j) - matrix.0[i][j]).abs() < 1e-12);
        }
        told.covariance[0][0] = -1.0;
        assert_eq!(belief_of(&told, [1.0; 3]), Err(MessageError::NotACovariance));
        told.covariance[0][0] = f64::NAN;
        assert_eq!(belief_of(&told, [1.0; 3]), Err(MessageError::NotFinite));
        told.covariance = [[0.0; 6]; 6];
        assert!((belief_of(&told, [0.1, 0.2, 0.3]).unwrap().covariance.std(1) - 0.2).abs() < 1e-12);
    }
}
