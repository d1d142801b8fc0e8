//! Between messages and the core's words; what a message should not say is refused by name.
//!
//! Frames are those of REP 105: x forward, y left, angles counter-clockwise, metres and radians, as in the core.

use ros2_client::builtin_interfaces::Time;
use surepose::estimation::Belief;
use surepose::geometry::{Angle, Frame, Pose};
use surepose::kinematics::Twist;
use surepose::linalg::Covariance;
use surepose::time::Stamp;

use crate::message::{self, Header, Point, Quaternion, Vector3};

/// Why a message was not used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MessageError {
    /// It has a NaN or an infinite number where a place is expected.
    #[error("it has a number that is not finite")]
    NotFinite,
    /// A place farther away than 10 km, where rounding would be seen.
    #[error("it is farther away than 10 km")]
    FarAway,
    /// A quaternion without a direction: all zeros, as of a message that nobody filled in.
    #[error("its orientation is no rotation: a quaternion must have length 1, (0, 0, 0, 1) for no turn")]
    NotARotation,
    /// A covariance that is none.
    #[error("its covariance is none: not symmetric, or a variance is negative")]
    NotACovariance,
    /// It is given in another frame.
    #[error("it is in the frame '{got}', and '{expected}' is the only one that is understood")]
    WrongFrame {
        /// The frame of the map.
        expected: String,
        /// The message's.
        got: String,
    },
    /// Its stamp is not later than that of the last one.
    #[error("its stamp is not later than that of the one before")]
    OutOfOrder,
    /// An orientation that says of itself, by a covariance of −1, that it is not measured.
    #[error("its orientation is not measured, by its covariance of -1")]
    NotMeasured,
    /// What a laser that leans sees are not the walls at one height.
    #[error(
        "its laser leans by {degrees:.0}°, by /tf_static: its plane must be level, to 10°; [laser] x_m, y_m, heading_deg overrule that"
    )]
    Leaning {
        /// The angle between its plane and the level \[°].
        degrees: f64,
    },
    /// A goal where a robot cannot stand.
    #[error("{}", no_room(*.clearance, *.needed))]
    InsufficientClearance {
        /// How far it is from the next wall \[m]; negative outside the walls.
        clearance: f64,
        /// How far it must be \[m].
        needed: f64,
    },
}

impl MessageError {
    /// The name under which it is counted.
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
            Self::InsufficientClearance { .. } => "no_room",
        }
    }
}

fn no_room(clearance: f64, needed: f64) -> String {
    if clearance < 0.0 {
        return format!("it lies outside the map, {:.2} m beyond the nearest wall", clearance.abs());
    }
    format!("it is {clearance:.2} m from a wall of the map, and the robot's middle needs {needed:.2} m")
}

/// Nothing is farther away \[m].
const FARTHEST: f64 = 1e4;

/// A quaternion is one of a rotation if the square of its length is within this of 1.
const SQUARED_LENGTH_SLACK: f64 = 0.1;

/// The moment of a stamp, from ROS's origin of time.
pub fn stamp_of(time: Time) -> Stamp {
    Stamp::from_nanoseconds(time.to_nanos())
}

/// The stamp of a moment.
pub fn time_of(stamp: Stamp) -> Time {
    Time::from_nanos(stamp.nanoseconds())
}

/// The header of what holds at `stamp` in `frame`.
pub fn header(stamp: Stamp, frame: &str) -> Header {
    Header { stamp: time_of(stamp), frame_id: frame.to_owned() }
}

/// The turn about the vertical of a rotation.
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

/// The rotation of a heading.
pub fn rotation_of(heading: Angle<f64>) -> Quaternion {
    let half = 0.5 * heading.radians();
    Quaternion { x: 0.0, y: 0.0, z: half.sin(), w: half.cos() }
}

/// The plane pose of a pose in space.
///
/// # Errors
/// [`MessageError`], where it is none.
pub fn pose_of<To: Frame, From: Frame>(pose: &message::Pose) -> Result<Pose<To, From, f64>, MessageError> {
    let Point { x, y, .. } = pose.position;
    if !x.is_finite() || !y.is_finite() {
        return Err(MessageError::NotFinite);
    }
    if x.abs().max(y.abs()) > FARTHEST {
        return Err(MessageError::FarAway);
    }
    Ok(Pose::new(x, y, heading_of(&pose.orientation)?))
}

/// A pose in a plane as a pose in space.
pub fn pose_message<To: Frame, From: Frame>(pose: Pose<To, From, f64>) -> message::Pose {
    let position = Point { x: pose.x, y: pose.y, z: 0.0 };
    message::Pose { position, orientation: rotation_of(pose.heading) }
}

/// A transform from a pose.
pub fn transform<To: Frame, From: Frame>(pose: Pose<To, From, f64>) -> message::Transform {
    let translation = Vector3 { x: pose.x, y: pose.y, z: 0.0 };
    message::Transform { translation, rotation: rotation_of(pose.heading) }
}

/// A twist in the plane as one in space.
pub fn twist_message(twist: Twist<f64>) -> message::Twist {
    message::Twist { linear: Vector3::along_x(twist.v), angular: Vector3::along_z(twist.omega) }
}

/// Where x, y and the turn about z are in six by six.
const ROWS: [usize; 3] = [0, 1, 5];

/// A belief as a pose with its covariance in space.
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

/// What somebody says that the robot's pose is; a covariance of zeros, as of a message that nobody filled in, means as
/// well known as `usual`: standard deviations of x \[m], y \[m] and heading \[rad].
///
/// # Errors
/// [`MessageError`], where the pose is none or its covariance is none.
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
    fn poses_come_back_as_they_went() {
        for degrees in [-179.0, -90.0, 0.0, 30.0, 180.0] {
            let pose: Pose<Map, Body, f64> = Pose::new(1.5, -2.0, Angle::from_degrees(degrees));
            let back: Pose<Map, Body, f64> = pose_of(&pose_message(pose)).unwrap();
            assert!((back.x, back.y) == (pose.x, pose.y));
            assert!((back.heading - pose.heading).radians().abs() < 1e-12);
        }
    }

    #[test]
    fn a_tilted_compass_still_has_its_heading() {
        // A turn of 40° about z, then a tilt of 5° about the robot's own x.
        let (z, x) = (20_f64.to_radians(), 2.5_f64.to_radians());
        let heading = turned(z.cos() * x.sin(), z.sin() * x.sin(), z.sin() * x.cos(), z.cos() * x.cos());
        assert!((heading.unwrap() - 40.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_pose_is_refused_by_name() {
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
    fn beliefs_come_back_with_their_covariance() {
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
