//! ROS 2 messages; the fields have the order of the `.msg` files, as on the wire.
//!
//! A `float64[36]` is an array of six rows of six, because serde supports no longer arrays; the wire format is equal.

use ros2_client::Message;
use ros2_client::builtin_interfaces::{Duration, Time};
use serde::{Deserialize, Serialize};

macro_rules! messages {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $type:ty),* $(,)? })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Debug, Serialize, Deserialize)]
        #[allow(missing_docs, reason = "the interface's own fields; its definition says what they mean")]
        pub struct $name { $(pub $field: $type),* }
        impl Message for $name {}
    )*};
}

messages! {
    /// `std_msgs/msg/Header`
    Header { stamp: Time, frame_id: String }
    /// `std_msgs/msg/ColorRGBA`
    ColorRgba { r: f32, g: f32, b: f32, a: f32 }
    /// `geometry_msgs/msg/Vector3`
    Vector3 { x: f64, y: f64, z: f64 }
    /// `geometry_msgs/msg/Point`
    Point { x: f64, y: f64, z: f64 }
    /// `geometry_msgs/msg/Quaternion`
    Quaternion { x: f64, y: f64, z: f64, w: f64 }
    /// `geometry_msgs/msg/Pose`
    Pose { position: Point, orientation: Quaternion }
    /// `geometry_msgs/msg/PoseStamped`
    PoseStamped { header: Header, pose: Pose }
    /// `geometry_msgs/msg/PoseWithCovariance`
    PoseWithCovariance { pose: Pose, covariance: [[f64; 6]; 6] }
    /// `geometry_msgs/msg/PoseWithCovarianceStamped`
    PoseWithCovarianceStamped { header: Header, pose: PoseWithCovariance }
    /// `geometry_msgs/msg/Twist`
    Twist { linear: Vector3, angular: Vector3 }
    /// `geometry_msgs/msg/TwistStamped`
    TwistStamped { header: Header, twist: Twist }
    /// `geometry_msgs/msg/TwistWithCovariance`
    TwistWithCovariance { twist: Twist, covariance: [[f64; 6]; 6] }
    /// `geometry_msgs/msg/Transform`
    Transform { translation: Vector3, rotation: Quaternion }
    /// `geometry_msgs/msg/TransformStamped`
    TransformStamped { header: Header, child_frame_id: String, transform: Transform }
    /// `tf2_msgs/msg/TFMessage`
    TfMessage { transforms: Vec<TransformStamped> }
    /// `nav_msgs/msg/Odometry`
    Odometry { header: Header, child_frame_id: String, pose: PoseWithCovariance, twist: TwistWithCovariance }
    /// `sensor_msgs/msg/LaserScan`
    LaserScan {
        header: Header,
        angle_min: f32,
        angle_max: f32,
        angle_increment: f32,
        time_increment: f32,
        scan_time: f32,
        range_min: f32,
        range_max: f32,
        ranges: Vec<f32>,
        intensities: Vec<f32>,
    }
    /// `sensor_msgs/msg/Imu`
    Imu {
        header: Header,
        orientation: Quaternion,
        orientation_covariance: [f64; 9],
        angular_velocity: Vector3,
        angular_velocity_covariance: [f64; 9],
        linear_acceleration: Vector3,
        linear_acceleration_covariance: [f64; 9],
    }
    /// `sensor_msgs/msg/CompressedImage`
    CompressedImage { header: Header, format: String, data: Vec<u8> }
    /// `visualization_msgs/msg/UVCoordinate`
    UvCoordinate { u: f32, v: f32 }
    /// `visualization_msgs/msg/MeshFile`
    MeshFile { filename: String, data: Vec<u8> }
    /// `visualization_msgs/msg/Marker`
    Marker {
        header: Header,
        ns: String,
        id: i32,
        kind: i32,
        action: i32,
        pose: Pose,
        scale: Vector3,
        color: ColorRgba,
        lifetime: Duration,
        frame_locked: bool,
        points: Vec<Point>,
        colors: Vec<ColorRgba>,
        texture_resource: String,
        texture: CompressedImage,
        uv_coordinates: Vec<UvCoordinate>,
        text: String,
        mesh_resource: String,
        mesh_file: MeshFile,
        mesh_use_embedded_materials: bool,
    }
    /// `diagnostic_msgs/msg/KeyValue`
    KeyValue { key: String, value: String }
    /// `diagnostic_msgs/msg/DiagnosticStatus`
    DiagnosticStatus { level: u8, name: String, message: String, hardware_id: String, values: Vec<KeyValue> }
    /// `diagnostic_msgs/msg/DiagnosticArray`
    DiagnosticArray { header: Header, status: Vec<DiagnosticStatus> }
    /// The request and the answer of `std_srvs/srv/Empty`: an empty structure has one byte on the wire.
    Empty { structure_needs_at_least_one_member: u8 }
    /// The goal of `nav2_msgs/action/NavigateToPose`
    NavigateToPoseGoal { pose: PoseStamped, behavior_tree: String }
    /// The result of `nav2_msgs/action/NavigateToPose`
    NavigateToPoseResult { error_code: u16, error_msg: String }
    /// The feedback of `nav2_msgs/action/NavigateToPose`
    NavigateToPoseFeedback {
        current_pose: PoseStamped,
        navigation_time: Duration,
        estimated_time_remaining: Duration,
        number_of_recoveries: i16,
        distance_remaining: f32,
    }
}

impl Vector3 {
    /// Vector along x.
    pub fn along_x(x: f64) -> Self {
        Self { x, y: 0.0, z: 0.0 }
    }

    /// Vector along z.
    pub fn along_z(z: f64) -> Self {
        Self { x: 0.0, y: 0.0, z }
    }
}
