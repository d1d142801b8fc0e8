//! Definitions of the message types, in the language of ROS 2, so that every reader decodes them.

/// `builtin_interfaces/msg/Time` and `std_msgs/msg/Header`.
const HEADER: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

const POSE: &str = "\
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
";

const POSE_WITH_COVARIANCE: &str = "\
================================================================================
MSG: geometry_msgs/PoseWithCovariance
geometry_msgs/Pose pose
float64[36] covariance
";

const TWIST: &str = "\
================================================================================
MSG: geometry_msgs/Twist
geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
";

const TWIST_WITH_COVARIANCE: &str = "\
================================================================================
MSG: geometry_msgs/TwistWithCovariance
geometry_msgs/Twist twist
float64[36] covariance
";

/// Topic of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Topic {
    Session,
    Event,
    Odometry,
    Scan,
    Belief,
    Command,
    Goal,
    Decision,
}

impl Topic {
    pub(crate) const ALL: [Self; 8] = [
        Self::Session,
        Self::Event,
        Self::Odometry,
        Self::Scan,
        Self::Belief,
        Self::Command,
        Self::Goal,
        Self::Decision,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Session => "/surepose/session",
            Self::Event => "/surepose/event",
            Self::Odometry => "/odom",
            Self::Scan => "/scan",
            Self::Belief => "/pose",
            Self::Command => "/cmd_vel",
            Self::Goal => "/goal_pose",
            Self::Decision => "/surepose/decision",
        }
    }

    /// Type of its messages.
    pub(crate) fn kind(self) -> &'static str {
        match self {
            Self::Session => "surepose_msgs/msg/Session",
            Self::Event => "surepose_msgs/msg/Event",
            Self::Odometry => "nav_msgs/msg/Odometry",
            Self::Scan => "sensor_msgs/msg/LaserScan",
            Self::Belief => "geometry_msgs/msg/PoseWithCovarianceStamped",
            Self::Command => "geometry_msgs/msg/TwistStamped",
            Self::Goal => "geometry_msgs/msg/PoseStamped",
            Self::Decision => "std_msgs/msg/String",
        }
    }

    /// Definition of the type.
    pub(crate) fn definition(self) -> String {
        match self {
            Self::Session => include_str!("../msg/Session.msg").to_owned(),
            Self::Event => [
                include_str!("../msg/Event.msg"),
                "================================================================================\n\
                 MSG: surepose_msgs/Reading\n",
                include_str!("../msg/Reading.msg"),
            ]
            .concat(),
            Self::Odometry => [
                "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
                 geometry_msgs/TwistWithCovariance twist\n",
                HEADER,
                POSE_WITH_COVARIANCE,
                POSE,
                TWIST_WITH_COVARIANCE,
                TWIST,
            ]
            .concat(),
            Self::Scan => [
                "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
                 float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n\
                 float32[] ranges\nfloat32[] intensities\n",
                HEADER,
            ]
            .concat(),
            Self::Belief => [
                "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
                HEADER,
                POSE_WITH_COVARIANCE,
                POSE,
            ]
            .concat(),
            Self::Command => ["std_msgs/Header header\ngeometry_msgs/Twist twist\n", HEADER, TWIST].concat(),
            Self::Goal => ["std_msgs/Header header\ngeometry_msgs/Pose pose\n", HEADER, POSE].concat(),
            Self::Decision => "string data\n".to_owned(),
        }
    }
}
