//! Publishers of the node.

use ros2_client::builtin_interfaces::Duration;
use ros2_client::{Node, Publisher};
use surepose::geometry::Angle;
use surepose::kinematics::Twist;
use surepose::safety::Health;
use surepose::time::Stamp;

use crate::convert::{belief_message, header, rotation_of, transform};
use crate::dds::{NodeError, advertise, latched, publish_result, reliable};
use crate::driver::DriverReport;
use crate::message::{
    self, ColorRgba, CompressedImage, DiagnosticArray, Marker, MeshFile, Odometry, Point,
    PoseWithCovarianceStamped, TfMessage, TransformStamped, Vector3,
};
use crate::velocity::CmdVelPublisher;

use super::settings::NodeSettings;

/// Offset into the future of the stamp of map → odom \[s], so that tf2 look-ups need not wait for the next one.
const HOLDS: f64 = 0.2;

/// Type and action of `visualization_msgs/msg/Marker`: line segments, added or modified.
const LINE_LIST: i32 = 5;
const ADD: i32 = 0;

/// Line width of the walls \[m].
const WALL: f64 = 0.03;

/// Publishers.
pub(super) struct Publishers {
    cmd_vel: CmdVelPublisher,
    pose: Publisher<PoseWithCovarianceStamped>,
    transforms: Publisher<TfMessage>,
    walls: Publisher<Marker>,
    diagnostics: Publisher<DiagnosticArray>,
    map_frame: String,
    base_frame: String,
}

impl Publishers {
    pub(super) fn new(node: &mut Node, settings: &NodeSettings) -> Result<Self, NodeError> {
        let names = &settings.names;
        let pose = ("geometry_msgs", "PoseWithCovarianceStamped");
        Ok(Self {
            cmd_vel: CmdVelPublisher::new(node, names, settings.stamped)?,
            pose: advertise(node, &names.of("pose")?, pose, reliable(1))?,
            transforms: advertise(node, &names.of("tf")?, ("tf2_msgs", "TFMessage"), reliable(100))?,
            walls: advertise(node, &names.of("walls")?, ("visualization_msgs", "Marker"), latched(1))?,
            diagnostics: advertise(
                node,
                &names.of("diagnostics")?,
                ("diagnostic_msgs", "DiagnosticArray"),
                reliable(10),
            )?,
            map_frame: settings.map_frame.clone(),
            base_frame: String::new(),
        })
    }

    /// Publishes the command of a step, and pose and transform unless the robot is lost.
    pub(super) fn report(&mut self, report: &DriverReport, odometry: &Odometry) {
        self.base_frame.clone_from(&odometry.child_frame_id);
        if let Some(twist) = report.command {
            self.command(report.stamp, twist);
        }
        if report.health == Health::Lost {
            return;
        }
        let header = header(report.stamp, &self.map_frame);
        let pose = PoseWithCovarianceStamped { header, pose: belief_message(&report.belief) };
        publish_result(self.pose.publish(pose));
        let transform = TransformStamped {
            header: crate::convert::header(report.stamp.after(HOLDS), &self.map_frame),
            child_frame_id: odometry.header.frame_id.clone(),
            transform: transform(report.map_from_odom),
        };
        publish_result(self.transforms.publish(TfMessage { transforms: vec![transform] }));
    }

    /// Publishes a velocity command.
    pub(super) fn command(&self, stamp: Stamp, twist: Twist<f64>) {
        self.cmd_vel.command(stamp, &self.base_frame, twist);
    }

    pub(super) fn diagnose(&self, array: DiagnosticArray) {
        publish_result(self.diagnostics.publish(array));
    }

    /// Publishes the walls of the map as a marker.
    pub(super) fn walls(&self, settings: &NodeSettings) {
        let Some(map) = &settings.driver.map else { return };
        let end = |[x, y]: [f64; 2]| Point { x, y, z: 0.0 };
        let points = map.walls.iter().flat_map(|wall| [end(wall.from), end(wall.to)]).collect();
        let origin = message::Pose {
            position: Point { x: 0.0, y: 0.0, z: 0.0 },
            orientation: rotation_of(Angle::zero()),
        };
        let nowhere = || header(Stamp::default(), "");
        let marker = Marker {
            header: header(Stamp::default(), &settings.map_frame),
            ns: "surepose".to_owned(),
            id: 0,
            kind: LINE_LIST,
            action: ADD,
            pose: origin,
            scale: Vector3::along_x(WALL),
            color: ColorRgba { r: 0.2, g: 0.2, b: 0.25, a: 1.0 },
            lifetime: Duration::zero(),
            frame_locked: true,
            points,
            colors: Vec::new(),
            texture_resource: String::new(),
            texture: CompressedImage { header: nowhere(), format: String::new(), data: Vec::new() },
            uv_coordinates: Vec::new(),
            text: String::new(),
            mesh_resource: String::new(),
            mesh_file: MeshFile { filename: String::new(), data: Vec::new() },
            mesh_use_embedded_materials: false,
        };
        publish_result(self.walls.publish(marker));
    }
}
