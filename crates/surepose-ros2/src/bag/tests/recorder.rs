//! Records the simulated robot for the tests.

use std::collections::BTreeMap;
use std::path::PathBuf;

use byteorder::LittleEndian;
use serde::Serialize;
use surepose::geometry::{Body, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist};
use surepose::time::Stamp;
use surepose_sim::robot::Scenario;
use surepose_sim::{Seed, World};

use crate::convert::{header, pose_message};
use crate::driver::Odom;
use crate::message::PoseStamped;
use crate::robot::messages;

use surepose_io::mcap::{McapCompression, McapWriter};

/// Writes a recording.
pub(super) struct Recorder {
    pub(super) writer: McapWriter,
    pub(super) channels: BTreeMap<String, u16>,
    /// Topic, type, time and bytes of each message.
    pub(super) messages: Vec<(String, String, Stamp, Vec<u8>)>,
}

impl Recorder {
    pub(super) fn new() -> Self {
        Self {
            writer: McapWriter::new(McapCompression::Zstd),
            channels: BTreeMap::new(),
            messages: Vec::new(),
        }
    }

    pub(super) fn write(&mut self, topic: &str, kind: &str, time: Stamp, message: &impl Serialize) {
        let mut data = vec![0, 1, 0, 0];
        data.extend(cdr_encoding::to_vec::<_, LittleEndian>(message).unwrap());
        self.write_bytes(topic, kind, time, &data);
    }

    pub(super) fn write_bytes(&mut self, topic: &str, kind: &str, time: Stamp, data: &[u8]) {
        let channel = *self.channels.entry(topic.to_owned()).or_insert_with(|| {
            let schema = self.writer.add_schema(kind, "");
            self.writer.add_channel(schema, topic)
        });
        self.messages.push((topic.to_owned(), kind.to_owned(), time, data.to_owned()));
        self.writer.write(channel, time.nanoseconds() as u64, data);
    }

    pub(super) fn finished(self) -> Vec<u8> {
        self.writer.finished()
    }
}

/// Records a round of the simulated robot for `seconds`.
pub(super) fn round(seconds: f64, odometry_topic: &str) -> Recorder {
    let scenario = Scenario::default();
    let base = scenario.world().drive;
    recorded_by(&Robot { scenario, base, hangs: false, pause: 0.0 }, seconds, odometry_topic, |_| {
        Twist::new(0.2, 0.2)
    })
}

/// Time at which odometry pauses \[s].
const PAUSE: f64 = 5.0;

/// Records the robot on a circle, with odometry that pauses for `pause` seconds.
pub(super) fn with_gap(pause: f64) -> Recorder {
    let scenario = Scenario::default();
    let base = scenario.world().drive;
    let robot = Robot { scenario, base, hangs: false, pause };
    recorded_by(&robot, 20.0, "/odom", |_| Twist::new(0.2, 0.4))
}

/// Robot that is recorded.
pub(super) struct Robot {
    pub(super) scenario: Scenario,
    /// Wheel parameters of its odometry.
    pub(super) base: DiffDrive<f64>,
    /// Whether its laser is upside down.
    pub(super) hangs: bool,
    /// Duration for which odometry pauses, from 5 s on \[s].
    pub(super) pause: f64,
}

/// Twist with alternating turns at time `t` \[s].
pub(super) fn winding(t: f64) -> Twist<f64> {
    Twist::new(0.15 + 0.1 * (0.3 * t).sin(), 0.5 * (0.17 * t).sin())
}

/// Records the simulated robot with commands by the time, for `seconds`.
pub(super) fn recorded_by(
    robot: &Robot,
    seconds: f64,
    odometry_topic: &str,
    told: impl Fn(f64) -> Twist<f64>,
) -> Recorder {
    let Robot { scenario, base, hangs, pause } = robot;
    let mut world = World::new(scenario.world(), scenario.start(), Seed(5));
    let mut odometry: Pose<Odom, Body, f64> = Pose::identity();
    let mut recorder = Recorder::new();
    let origin = Stamp::from_seconds(1.7e9);
    let at = |moment: Stamp| origin.after(moment.seconds());
    while world.now().seconds() < seconds {
        let drive = world.model().drive;
        let sensed = world.step(drive.wheel_rates_from_twist(told(world.now().seconds())), 0.05);
        let rims = base.wheel_travel_from_angle(drive.wheel_angle_from_travel(sensed.rims));
        odometry = odometry.integrate(base.motion_from_travel(rims), Integration::Arc);
        let now = at(sensed.stamp);
        let rolled = messages::odometry(now, odometry, Twist::zero());
        if !(PAUSE..PAUSE + pause).contains(&world.now().seconds()) {
            recorder.write(odometry_topic, "nav_msgs/msg/Odometry", now, &rolled);
        }
        let truth = PoseStamped { header: header(now, "map"), pose: pose_message(world.pose()) };
        recorder.write("/truth", "geometry_msgs/msg/PoseStamped", now, &truth);
        for heading in &sensed.headings {
            let imu = messages::heading(at(heading.stamp), heading.value, 0.1_f64.to_radians());
            recorder.write("/imu", "sensor_msgs/msg/Imu", now, &imu);
        }
        for scan in &sensed.scans {
            let mut scan = messages::scan(at(scan.stamp), &scan.value);
            if *hangs {
                // An upside-down laser has left and right swapped.
                scan.ranges.reverse();
                (scan.angle_min, scan.angle_max) = (-scan.angle_max, -scan.angle_min);
            }
            recorder.write("/scan", "sensor_msgs/msg/LaserScan", now, &scan);
        }
    }
    recorder
}

/// Temporary file, removed on drop.
pub(super) struct File(pub(super) PathBuf);

impl File {
    pub(super) fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("surepose-{}-{name}.mcap", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}
