//! `surepose ros2`: the node on a robot, or with a simulated robot beside it.

use std::path::PathBuf;
use std::thread;

use clap::{Args, ValueEnum};
use surepose::estimation::Belief;
use surepose_config::{Config, ScanMethod};
use surepose_io::wall_map::WallMap;
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
use crate::{certification, interrupt};

/// Run as a ROS 2 node: park a robot where RViz's "2D Goal Pose", or navigate_to_pose, says.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose ros2 --simulate                              a simulated robot in the paper's arena, to try it
  surepose ros2 --map building.toml --start 1,2,90      a robot with odometry and laser, at a known place
  surepose ros2 --map building.toml --compass           the same with a compass, looking for its place by itself
  surepose ros2 --config robot.toml --remap odom:=/diff_drive/odom --cmd-vel twist

Hears odom (nav_msgs/Odometry), with --map also scan (sensor_msgs/LaserScan) \
and /tf_static, which says where the laser sits if [laser] does not; with --compass imu (sensor_msgs/Imu, \
an absolute heading); goal_pose, initialpose (as RViz sends them), the action navigate_to_pose (nav2_msgs) and the \
service reinitialize_global_localization (std_srvs/Empty). Says cmd_vel, while it has a goal; pose, walls, /tf (map to \
odometry's frame) and /diagnostics. ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE mean what they mean to ROS. It needs \
no ROS installation.

Exit codes: 0 stopped by Ctrl-C, after telling the wheels to rest; 2 wrong command line, configuration or environment; \
3 a map that cannot be read.")]
pub(crate) struct Ros2Command {
    /// A wall map (TOML), or an occupancy grid (map_server's YAML) to trace the walls of; without one, the map is where odometry starts
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Where the robot starts on the map, to 10 cm and 6°: metres, metres, degrees; without it, it looks for itself
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<PoseArg>,
    /// Hear an absolute heading on imu: east or the map's x axis is 0, but for compass.offset_deg
    #[arg(long)]
    compass: bool,
    /// Hold a pose that was reached, also after a push, until another goal or a cancel
    #[arg(long)]
    hold: bool,
    /// Stop before what the laser sees and no map knows, so near to the way of the robot's middle; half the track and 10 cm unless given, 0 for not at all
    #[arg(long, value_name = "M", alias = "room", value_parser = safety_radius, allow_negative_numbers = true)]
    safety_radius: Option<f64>,
    /// The type of cmd_vel, of geometry_msgs
    #[arg(long, value_enum, default_value_t = CommandType::Stamped)]
    cmd_vel: CommandType,
    /// Simulate a robot with odom, scan and imu in the arena that the configuration names, in real time
    #[arg(long)]
    simulate: bool,
    /// What the simulated robot's noise is drawn from
    #[arg(long, default_value_t = 1, value_parser = whole(0..=u64::MAX), allow_negative_numbers = true, requires = "simulate")]
    seed: u64,
    /// The namespace of the node and its topics
    #[arg(long, value_name = "NAME", default_value = "/")]
    namespace: String,
    /// Another name for one of the node's own: odom:=/base/odom. May be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<String>,
    /// The frame of the map
    #[arg(long, value_name = "NAME", default_value = "map", value_parser = frame)]
    map_frame: String,
    #[command(flatten)]
    config: LawArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CommandType {
    /// TwistStamped, as robots take it since Jazzy
    Stamped,
    /// Twist
    Twist,
}

impl Ros2Command {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let config = self.config.over(Config::default())?;
        let names = Names::new(&self.namespace, &self.remap)
            .map_err(|error| usage(&error, "see --help for the node's names"))?;
        let network = Network::from_env(|name| std::env::var(name).ok())
            .map_err(|error| usage(&error, "set the variable, or unset it"))?;
        let (simulated, settings) = self.settings(config, names, network)?;
        for said in &settings.warnings {
            warning(said);
        }
        interrupt::listen();
        let simulation = simulated.map(|robot| {
            thread::spawn(move || {
                let ran = robot::run(&robot, interrupt::asked);
                // The node goes on without it, and whoever waits for the robot shall know.
                ran.inspect_err(|error| warning(&format!("there is no simulated robot: {error}")))
            })
        });
        say(&format_args!("in ROS domain {}; Ctrl-C ends it", network.domain));
        let ran = node::run(settings, interrupt::asked, |line| say(&line)).map_err(|error| failure(&error));
        if ran.is_err() {
            // The simulated robot goes with the program.
            return ran.map(|()| Exit::Done);
        }
        // A thread that panicked has said so.
        if let Some(Ok(simulated)) = simulation.map(thread::JoinHandle::join) {
            simulated.map_err(|error| failure(&error))?;
        }
        if output.json {
            text("{\"outcome\":\"stopped\"}\n")?;
        }
        Ok(Exit::Done)
    }

    /// The simulated robot, where one is asked for, and the node.
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
            return Err(CliError::Usage { what: "there is no map to start on".to_owned(), help });
        }
        let scenario = self.simulate.then(|| Scenario::configured(config.clone()));
        let mut driver = match &scenario {
            // The robot knows its arena, unless it is told otherwise.
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
                    safety_radius,
                    hold: false,
                }
            }
        };
        driver.hold = self.hold;
        driver.safety_radius = self.safety_radius.unwrap_or(driver.safety_radius);
        driver.start = self.start.map(|start| Belief::new(start.pose(), START_STD)).or(driver.start);
        let simulated = scenario.map(|scenario| {
            let (names, map_frame) = (names.clone(), self.map_frame.clone());
            RobotSettings { scenario, seed: self.seed, names, stamped, map_frame, network }
        });
        let map_frame = self.map_frame.clone();
        Ok((simulated, NodeSettings { driver, names, map_frame, stamped, network, warnings }))
    }
}

fn safety_radius(text: &str) -> Result<f64, String> {
    let safety_radius = text.parse::<f64>().ok().filter(|radius| (0.0..=5.0).contains(radius));
    safety_radius.ok_or_else(|| "write metres, from 0 to 5".to_owned())
}

/// tf2 knows no frame whose name begins with `/`.
fn frame(text: &str) -> Result<String, String> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    if text.is_empty() || text.starts_with('/') || !text.chars().all(fits) {
        return Err("write letters, digits, _, -, . and /, and no / at the beginning: map".to_owned());
    }
    Ok(text.to_owned())
}

/// How far beyond the reach of all walls a start is taken for a slip \[m]; a robot may well stand beside the only one.
const FAR: f64 = 5.0;

/// Says so where the robot is to start far beyond all walls of the map: what it sees will fit none of them.
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
        "the start ({}, {}) lies far outside the map, whose walls reach from ({left:.2}, {bottom:.2}) to \
         ({right:.2}, {top:.2})",
        start.x, start.y
    ))
}

fn usage(error: &dyn std::fmt::Display, help: &str) -> CliError {
    CliError::Usage { what: error.to_string(), help: help.to_owned() }
}

fn failure(error: &NodeError) -> CliError {
    usage(error, "is the network up, and is the domain free? See ROS_DOMAIN_ID")
}

#[cfg(test)]
mod tests {
    use surepose_io::wall_map::{MapWall, WallMap};

    use super::{PoseArg, outside};

    #[test]
    fn a_start_far_beyond_all_walls_is_told() {
        let wall = |from, to| MapWall { name: None, from, to, covariance: None };
        let walls = vec![wall([-1.0, 0.0], [3.0, 0.0]), wall([3.0, 0.0], [3.0, 2.5])];
        let map = WallMap { name: None, walls };
        let at = |x, y| outside(&map, PoseArg { x, y, heading_deg: 0.0 });
        assert_eq!((at(0.0, 1.0), at(3.0, -1.0)), (None, None));
        let said = at(100.0, 1.0).expect("outside");
        assert!(
            said.contains("(100, 1) lies far outside") && said.contains("(-1.00, 0.00) to (3.00, 2.50)"),
            "{said}"
        );
        assert!(at(0.0, -5.1).is_some());
        assert_eq!(outside(&WallMap::default(), PoseArg { x: 9.0, y: 9.0, heading_deg: 0.0 }), None);
    }
}
