//! Simulated robot: subscribes to velocity commands, publishes odometry, scans and headings.
//!
//! Its world is that of `surepose run`, in real time: motors with lag, slip, quantized encoders, noisy sensors.

mod cmd_vel_subscriber;
pub(crate) mod messages;

use std::time::{Duration, Instant};

use cmd_vel_subscriber::CmdVelSubscriber;
use futures::select;
use futures::stream::StreamExt;
use ros2_client::builtin_interfaces::Time;
use ros2_client::{Node, NodeOptions, Publisher};
use surepose::geometry::{Angle, Body, Pose};
use surepose::kinematics::{Integration, Twist};
use surepose::time::{Stamp, Stamped};
use surepose_sim::robot::Scenario;
use surepose_sim::{Seed, SimulatedScan, World};

use crate::convert::{header, pose_message};
use crate::dds::{self, NodeError, advertise, latched, publish_result, reliable, sensor, spinning};
use crate::driver::Odom;
use crate::message::{Imu, LaserScan, Odometry, PoseStamped, TfMessage};
use crate::names::Names;
use crate::network::Network;

/// Odometry period \[s].
const PERIOD: f64 = 0.02;

/// Time without a command after which the wheels stop.
const COMMAND_TIMEOUT: Duration = Duration::from_millis(500);

/// Settings of a simulated robot.
#[derive(Clone, Debug)]
pub struct RobotSettings {
    /// Arena, robot and start pose.
    pub scenario: Scenario,
    /// Seed of all noise.
    pub seed: u64,
    /// Names of its topics.
    pub names: Names,
    /// Whether `cmd_vel` is a `TwistStamped` or a `Twist`.
    pub stamped: bool,
    /// Frame of the true pose.
    pub map_frame: String,
    /// The network.
    pub network: Network,
}

/// Runs the robot in real time until `stops` returns true.
///
/// # Errors
/// [`NodeError`], before the robot moves.
pub fn run(settings: &RobotSettings, stops: impl Fn() -> bool) -> Result<(), NodeError> {
    let context = settings.network.join()?;
    let options = NodeOptions::new().enable_rosout(false);
    let mut node = dds::node(&context, &settings.names, "simulated_robot", options)?;
    let publishers = RobotPublishers::new(&mut node, settings)?;
    let cmd_vel = CmdVelSubscriber::new(&mut node, &settings.names, settings.stamped)?;
    let spinning = spinning(&mut node)?;
    smol::block_on(async {
        let mut twists = cmd_vel.twists().fuse();
        let mut timer_ticks = smol::Timer::interval(Duration::from_secs_f64(PERIOD)).fuse();
        let mut robot = Robot::new(settings);
        while !stops() {
            select! {
                twist = twists.select_next_some() => robot.apply(twist),
                _ = timer_ticks.select_next_some() => robot.advance(&publishers),
            }
        }
    });
    drop((node, spinning));
    Ok(())
}

/// Simulated robot with its wall clock.
struct Robot {
    world: World,
    compass_std: f64,
    /// Delays of compass and laser \[s]: the stamps are those of arrival.
    latencies: (f64, f64),
    odometry: Pose<Odom, Body, f64>,
    cmd_vel: Twist<f64>,
    last_command: Instant,
    born: (Instant, Time),
}

impl Robot {
    fn new(settings: &RobotSettings) -> Self {
        let scenario = &settings.scenario;
        Self {
            world: World::new(scenario.world(), scenario.start(), Seed(settings.seed)),
            compass_std: scenario.config.compass().std,
            latencies: (scenario.config.compass().latency, scenario.config.laser().latency),
            odometry: Pose::identity(),
            cmd_vel: Twist::zero(),
            last_command: Instant::now(),
            born: (Instant::now(), Time::now()),
        }
    }

    fn apply(&mut self, twist: Twist<f64>) {
        (self.cmd_vel, self.last_command) = (twist, Instant::now());
    }

    /// Advances the world to the current time and publishes its measurements.
    fn advance(&mut self, publishers: &RobotPublishers) {
        while self.world.now().seconds() + PERIOD <= self.born.0.elapsed().as_secs_f64() {
            if self.last_command.elapsed() > COMMAND_TIMEOUT {
                self.cmd_vel = Twist::zero();
            }
            let drive = self.world.model().drive;
            let sensed = self.world.step(drive.wheel_rates_from_twist(self.cmd_vel), PERIOD);
            self.odometry = self.odometry.integrate(drive.motion_from_travel(sensed.rims), Integration::Arc);
            let twist = drive.twist_from_wheel_speeds(sensed.rims.scaled(1.0 / PERIOD));
            publishers.odometry(self.stamp(sensed.stamp), self.odometry, twist);
            publishers.truth(self.stamp(sensed.stamp), &self.world);
            for heading in &sensed.headings {
                publishers.heading(
                    self.stamp(heading.stamp).after(self.latencies.0),
                    heading.value,
                    self.compass_std,
                );
            }
            for scan in &sensed.scans {
                publishers.scan(Stamped::new(self.stamp(scan.stamp).after(self.latencies.1), &scan.value));
            }
        }
    }

    /// ROS time of a simulated time.
    fn stamp(&self, moment: Stamp) -> Stamp {
        Stamp::from_nanoseconds(self.born.1.to_nanos().saturating_add(moment.nanoseconds()))
    }
}

/// Publishers of the robot.
struct RobotPublishers {
    odometry: Publisher<Odometry>,
    transforms: Publisher<TfMessage>,
    scans: Publisher<LaserScan>,
    headings: Publisher<Imu>,
    truth: Publisher<PoseStamped>,
    map_frame: String,
    /// Latched publisher of the laser extrinsics.
    _joints: Publisher<TfMessage>,
}

impl RobotPublishers {
    fn new(node: &mut Node, settings: &RobotSettings) -> Result<Self, NodeError> {
        let names = &settings.names;
        let static_transforms =
            advertise(node, &names.of("tf_static")?, ("tf2_msgs", "TFMessage"), latched(1))?;
        publish_result(
            static_transforms.publish(messages::mounted(settings.scenario.config.laser().body_from_laser)),
        );
        Ok(Self {
            odometry: advertise(node, &names.of("odom")?, ("nav_msgs", "Odometry"), reliable(10))?,
            transforms: advertise(node, &names.of("tf")?, ("tf2_msgs", "TFMessage"), reliable(100))?,
            scans: advertise(node, &names.of("scan")?, ("sensor_msgs", "LaserScan"), sensor(5))?,
            headings: advertise(node, &names.of("imu")?, ("sensor_msgs", "Imu"), sensor(5))?,
            truth: advertise(node, &names.of("truth")?, ("geometry_msgs", "PoseStamped"), reliable(10))?,
            map_frame: settings.map_frame.clone(),
            _joints: static_transforms,
        })
    }

    fn odometry(&self, stamp: Stamp, pose: Pose<Odom, Body, f64>, twist: Twist<f64>) {
        publish_result(self.odometry.publish(messages::odometry(stamp, pose, twist)));
        publish_result(self.transforms.publish(messages::rolled(stamp, pose)));
    }

    fn truth(&self, stamp: Stamp, world: &World) {
        let pose = pose_message(world.pose());
        publish_result(self.truth.publish(PoseStamped { header: header(stamp, &self.map_frame), pose }));
    }

    fn heading(&self, stamp: Stamp, heading: Angle<f64>, std: f64) {
        publish_result(self.headings.publish(messages::heading(stamp, heading, std)));
    }

    fn scan(&self, scan: Stamped<&SimulatedScan>) {
        publish_result(self.scans.publish(messages::scan(scan.stamp, scan.value)));
    }
}
