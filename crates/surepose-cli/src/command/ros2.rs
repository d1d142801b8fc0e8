//! `surepose ros2`: runs the ROS 2 node, on a robot or with a simulated robot.

mod ros_args;

use std::path::PathBuf;
use std::thread;

use clap::{Args, ValueEnum};
use surepose::estimation::Belief;
use surepose_config::{Config, ScanMethod};
use surepose_io::wall_map::WallMap;
use surepose_recorder::FlightRecorder;
use surepose_ros2::network::Network;
use surepose_ros2::node::{self, NodeSettings};
use surepose_ros2::robot::{self, RobotSettings};
use surepose_ros2::{Names, NodeDriverSettings, NodeError, START_STD};
use surepose_sim::robot::Scenario;

use crate::error::CliError;
use crate::exit::Exit;
use crate::maps::walls_to_read;
use crate::output::{Output, say, text, warning};
use crate::settings::{LawArgs, PoseArg, whole};
use crate::{certification, interrupt, recording};

use ros_args::RosArgs;

/// Run the ROS 2 node: parks a robot at the goal pose that RViz ("2D Goal Pose") or the action navigate_to_pose sends
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose ros2 --simulate                              a simulated robot in the arena of the paper
  surepose ros2 --map building.toml --start 1,2,90      a robot with odometry and laser, from a known pose
  surepose ros2 --map building.toml --record drive      records; `surepose replay mcap drive` repeats the drive to the bit
  surepose ros2 --map building.toml --compass           a robot with a compass, with global localization
  surepose ros2 --config robot.toml --remap odom:=/diff_drive/odom --cmd-vel twist
  surepose ros2 --map building.toml --ros-args -r __ns:=/robot1 -p law.k_v:=2 --params-file robot.yaml

Parameters: a later source wins: defaults, --config, --params-file, -p, --set. The names are those of the configuration.

Subscribes to odom (nav_msgs/Odometry), goal_pose and initialpose (as RViz publishes them); with --map to scan \
(sensor_msgs/LaserScan); with --compass to imu (sensor_msgs/Imu, absolute heading), with --gyroscope to its yaw rate; with either to /tf_static, which gives \
the mounting of laser and compass unless [laser] or compass.offset_deg sets it. Serves the action navigate_to_pose (nav2_msgs) and the service \
reinitialize_global_localization (std_srvs/Empty). Publishes cmd_vel while a goal is active, pose, walls, /tf (map to the \
odometry frame) and /diagnostics. ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE have their usual meaning. No ROS \
installation is needed.

Exit codes: 0 stopped by Ctrl-C, after a stop command to the wheels; 2 usage, configuration or environment error; \
3 map unreadable or malformed.")]
#[allow(clippy::struct_excessive_bools, reason = "each is an option of the command line")]
pub(crate) struct Ros2Command {
    /// A wall map (.toml), or an occupancy grid of map_server (.yaml) from which walls are extracted; without it, the map frame starts at the first pose of odometry
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// The start pose on the map, accurate to 10 cm and 6°, in meters, meters and degrees; without it, the robot is localized globally
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<PoseArg>,
    /// Use the absolute heading of imu; 0 is east or the x axis of the map, corrected by compass.offset_deg
    #[arg(long)]
    compass: bool,
    /// Use the yaw rate of imu, so that the heading between scans does not depend on wheels that may slip
    #[arg(long)]
    gyroscope: bool,
    /// Hold the reached pose, also after a disturbance, until a new goal or a cancel request
    #[arg(long)]
    hold: bool,
    /// The distance from the path of the robot center at which unmapped obstacles seen by the laser stop the robot; default the radius of the footprint plus 8 cm, 0 disables
    #[arg(long, value_name = "M", alias = "room", value_parser = safety_radius, allow_negative_numbers = true)]
    safety_radius: Option<f64>,
    /// The message type of cmd_vel, from geometry_msgs
    #[arg(long, value_enum, default_value_t = CommandType::Stamped)]
    cmd_vel: CommandType,
    /// Simulate a robot that publishes odom, scan and imu, in real time, in the configured arena
    #[arg(long)]
    simulate: bool,
    /// The seed of the noise of the simulated robot
    #[arg(long, default_value_t = 1, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true, requires = "simulate")]
    seed: u64,
    /// The namespace of the node and its topics
    #[arg(long, value_name = "NAME", default_value = "/")]
    namespace: String,
    /// Rename a topic, action or service: odom:=/base/odom. May be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<String>,
    /// The name of the map frame
    #[arg(long, value_name = "NAME", default_value = "map", value_parser = frame)]
    map_frame: String,
    /// A directory for a recording of every input, belief and command of the navigator (MCAP of rosbag2), which `surepose replay mcap DIR` repeats to the bit
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
    /// Arguments of ROS, up to --: -r FROM:=TO, -r __ns:=NAME, -r __node:=NAME, -p NAME:=VALUE, --params-file FILE, --log-level LEVEL
    #[arg(long, num_args = 0.., allow_hyphen_values = true, value_terminator = "--", value_name = "ARGUMENT")]
    ros_args: Vec<String>,
    #[command(flatten)]
    config: LawArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CommandType {
    /// TwistStamped, the default of ROS 2 Jazzy and later
    Stamped,
    /// Twist
    Twist,
}

impl Ros2Command {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let ros_args = RosArgs::parse(&self.ros_args)?;
        let names = self.names(&ros_args)?;
        let config = self.config.file_over(Config::default())?;
        let config = self.config.options_over(ros_args.over(config, &names)?)?;
        let network = Network::from_env(|name| std::env::var(name).ok())
            .map_err(|error| usage(&error, "correct or unset the environment variable"))?;
        let (simulated, mut settings) = self.settings(config, names, network)?;
        for said in &settings.warnings {
            warning(said);
        }
        let record = self.record.as_deref();
        let recorder = record.map(|path| recording::create(path, &settings.driver.session())).transpose()?;
        settings.recorder = recorder.as_ref().map(FlightRecorder::handle);
        interrupt::listen();
        let simulation = simulated.map(|robot| {
            thread::spawn(move || {
                let ran = robot::run(&robot, interrupt::asked);
                // The node keeps running without the simulated robot, so the failure is reported.
                ran.inspect_err(|error| warning(&format!("simulated robot: not running: {error}")))
            })
        });
        say(&format_args!("running in ROS domain {}; stop with Ctrl-C", network.domain));
        let is_said =
            |line: &str| !ros_args.is_quiet || line.starts_with("warning") || line.contains("rejected");
        let said = |line: &str| {
            if is_said(line) {
                say(&line);
            }
        };
        let ran = node::run(settings, interrupt::asked, said).map_err(|error| failure(&error));
        // The robot rests: the recording ends after its last event.
        let recorded = recorder.map_or(Ok(()), |recorder| recording::finish(record, recorder));
        if ran.is_err() {
            // The thread of the simulated robot ends with the process.
            return ran.map(|()| Exit::Done);
        }
        // A panic in the thread has already been reported.
        if let Some(Ok(simulated)) = simulation.map(thread::JoinHandle::join) {
            simulated.map_err(|error| failure(&error))?;
        }
        if output.json {
            text("{\"outcome\":\"stopped\"}\n")?;
        }
        recorded?;
        Ok(Exit::Done)
    }

    /// Returns the names of the node; those after --ros-args win.
    fn names(&self, ros_args: &RosArgs) -> Result<Names, CliError> {
        let namespace = ros_args.namespace.as_ref().unwrap_or(&self.namespace);
        let remappings = [&self.remap[..], &ros_args.remappings[..]].concat();
        let names = Names::new(namespace, &remappings);
        let names = match &ros_args.node {
            Some(node) => names.and_then(|names| names.with_node(node)),
            None => names,
        };
        names.map_err(|error| usage(&error, "see --help for the names of the node"))
    }

    /// Returns the settings of the simulated robot (`None` without --simulate) and of the node.
    fn settings(
        &self,
        config: Config,
        names: Names,
        network: Network,
    ) -> Result<(Option<RobotSettings>, NodeSettings), CliError> {
        let stamped = self.cmd_vel == CommandType::Stamped;
        let mut warnings = certification::warnings(&config);
        let map = self.map.as_deref().map(walls_to_read).transpose()?;
        if let (Some((map, _)), Some(start)) = (&map, self.start) {
            warnings.extend(outside(map, start));
        }
        if map.is_none() && self.start.is_some() && !self.simulate {
            let help = "give --map, or leave out --start: without a map the robot starts at 0,0,0".to_owned();
            return Err(CliError::Usage { what: "--start: requires a map".to_owned(), help });
        }
        let scenario = self.simulate.then(|| Scenario::configured(config.clone()));
        let mut driver = match &scenario {
            // Without --map the walls of the arena are the map.
            Some(scenario) if map.is_none() => NodeDriverSettings::in_scenario(scenario),
            _ => {
                let (map, scan_method) =
                    map.map_or((None, ScanMethod::Lines), |(map, scan_method)| (Some(map), scan_method));
                let compass = self.compass || self.simulate;
                let safety_radius = config.default_safety_radius();
                NodeDriverSettings {
                    config,
                    map,
                    scan_method,
                    start: None,
                    compass,
                    gyroscope: false,
                    safety_radius,
                    hold: false,
                }
            }
        };
        driver.hold = self.hold;
        driver.gyroscope = self.gyroscope;
        driver.safety_radius = self.safety_radius.unwrap_or(driver.safety_radius);
        driver.start = self.start.map(|start| Belief::new(start.pose(), START_STD)).or(driver.start);
        let simulated = scenario.map(|scenario| {
            let (names, map_frame) = (names.clone(), self.map_frame.clone());
            RobotSettings { scenario, seed: self.seed, names, stamped, map_frame, network }
        });
        let map_frame = self.map_frame.clone();
        let recorder = None;
        Ok((simulated, NodeSettings { driver, names, map_frame, stamped, network, warnings, recorder }))
    }
}

fn safety_radius(text: &str) -> Result<f64, String> {
    let safety_radius = text.parse::<f64>().ok().filter(|radius| (0.0..=5.0).contains(radius));
    safety_radius.ok_or_else(|| "expected meters from 0 to 5".to_owned())
}

/// Parses a frame name; tf2 rejects names that begin with `/`.
fn frame(text: &str) -> Result<String, String> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    if text.is_empty() || text.starts_with('/') || !text.chars().all(fits) {
        return Err(
            "expected letters, digits, _, -, . and /, and no / at the beginning, for example map".to_owned()
        );
    }
    Ok(text.to_owned())
}

/// Distance outside the bounding box of the map beyond which a start pose is reported \[m].
const FAR: f64 = 5.0;

/// Warns about a start pose far outside the map; `None` if it is within [`FAR`] of the walls' bounding box.
fn outside(map: &WallMap, start: PoseArg) -> Option<String> {
    let reach = |axis: usize| {
        let ends = map.walls.iter().flat_map(|wall| [wall.from, wall.to]).map(|end| end[axis]);
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    };
    let ((left, right), (bottom, top)) = (reach(0), reach(1));
    let near = |low: f64, high: f64| low - FAR..=high + FAR;
    if map.walls.is_empty() || near(left, right).contains(&start.x) && near(bottom, top).contains(&start.y) {
        return None;
    }
    Some(format!(
        "--start: ({}, {}) is far outside the map, whose walls extend from ({left:.2}, {bottom:.2}) to \
         ({right:.2}, {top:.2})",
        start.x, start.y
    ))
}

fn usage(error: &dyn std::fmt::Display, help: &str) -> CliError {
    CliError::Usage { what: error.to_string(), help: help.to_owned() }
}

fn failure(error: &NodeError) -> CliError {
    usage(error, "check that the network is up and that the ROS domain (ROS_DOMAIN_ID) is free")
}

#[cfg(test)]
mod tests {
    use surepose_io::wall_map::{MapWall, WallMap};

    use super::{PoseArg, outside};

    #[test]
    fn start_far_outside_the_map_is_reported() {
        let wall = |from, to| MapWall { name: None, from, to, covariance: None };
        let walls = vec![wall([-1.0, 0.0], [3.0, 0.0]), wall([3.0, 0.0], [3.0, 2.5])];
        let map = WallMap { name: None, walls };
        let at = |x, y| outside(&map, PoseArg { x, y, heading_deg: 0.0 });
        assert_eq!((at(0.0, 1.0), at(3.0, -1.0)), (None, None));
        let said = at(100.0, 1.0).expect("outside");
        assert!(
            said.contains("(100, 1) is far outside") && said.contains("(-1.00, 0.00) to (3.00, 2.50)"),
            "{said}"
        );
        assert!(at(0.0, -5.1).is_some());
        assert_eq!(outside(&WallMap::default(), PoseArg { x: 9.0, y: 9.0, heading_deg: 0.0 }), None);
    }
}
