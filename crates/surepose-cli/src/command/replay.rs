//! `surepose replay`: the estimator on a recording, judged against its reference.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use surepose::estimation::Belief;
use surepose_config::{Config, ScanMethod};
use surepose_figures as picture;
use surepose_io::wall_map::WallMap;
use surepose_replay::{
    BuildingMap, LaserReplaySettings, ReplayError, ReplayReport, carmen, cmu_wean, mines_rover, mrclam,
};
use surepose_ros2::bag::{self, Notice};
use surepose_ros2::{NodeDriverSettings, START_STD};
use surepose_sim::CancelToken;

use crate::error::CliError;
use crate::exit::Exit;
use crate::maps::{MapFile, read_map_file, walls_in, walls_to_read};
use crate::output::{Output, object, say, table, warning, worded};
use crate::output_dir::OutputDir;
use crate::settings::{ConfigArgs, PoseArg, names_of, whole};
use crate::{interrupt, progress};

/// Run the estimator on a recording and judge it against the recording's reference.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose replay mrclam MRCLAM_Dataset7 --robot 3
  surepose replay carmen freiburg-101-corrected.log.gz
  surepose replay wean robotdata1.log.gz --map wean.dat.gz --start 40,41.4,-96 --out pictures
  surepose replay wean robotdata1.log.gz --map wean.dat.gz
  surepose replay ticks exp1.dat.gz
  surepose replay mcap rosbag2/drive_0.mcap --map building.toml --compass --remap truth:=/mocap/pose
  surepose replay mrclam MRCLAM_Dataset7 --robot 3 --set robot.track_m=0.27 --json

Exit codes: 0 done; 1 not found where it was to be looked for, no step of odometry, no measurement accepted, or a position \
farther off than dead reckoning's; 130 interrupted (of carmen, ticks and wean, what was done until then is judged).")]
pub(crate) struct ReplayCommand {
    /// The format of the recording
    format: Format,
    /// The recording: a file, or a folder where the format has several
    path: PathBuf,
    /// A wall map, or the occupancy grid to make it from (`.yaml`, or Wean Hall's own); without one, `carmen` makes its own from every second scan and is judged on the others
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Where the robot starts, where the recording does not tell: metres, metres, degrees; without it, `wean` looks for the place, and exits with 1 while several explain the scans
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<PoseArg>,
    /// Hear the absolute heading of imu in a mcap recording
    #[arg(long)]
    compass: bool,
    /// What a topic of a mcap recording is called, where it is not odom, scan, imu or truth, or not the only one of its type: odom:=/base/odom. May be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<String>,
    /// Which robot of a mrclam recording, which has several; the first unless given
    #[arg(long, value_parser = whole(0..=u32::MAX), allow_negative_numbers = true)]
    robot: Option<u32>,
    /// A folder for a picture of `wean`'s scans and the robot's way on its map
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    config: ConfigArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// UTIAS MRCLAM: commanded velocities, landmarks, motion capture
    Mrclam,
    /// CARMEN: odometry, laser, poses corrected by SLAM
    Carmen,
    /// Wheel ticks and laser, without a map: the walls are made on the way
    Ticks,
    /// CMU Wean Hall: odometry and laser on a given map
    Wean,
    /// ROS 2 messages in MCAP, as rosbag2 writes them: odometry, and with --map a laser, with --compass a heading
    Mcap,
}

impl ReplayCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        self.check()?;
        let report = match self.format {
            Format::Mrclam => {
                let config = self.config.over(mrclam::MrclamSettings::preset())?;
                mrclam::replay(
                    &self.path,
                    self.robot.unwrap_or(1),
                    &mrclam::MrclamSettings::from_config(&config),
                )
            }
            Format::Carmen => {
                let settings =
                    carmen::CarmenSettings::from_config(&self.config.over(carmen::CarmenSettings::preset())?);
                let map = self.map.as_deref().map(walls_in).transpose()?;
                let log = surepose_io::carmen::read(&self.path)?;
                let replay = |cancel: &CancelToken| carmen::replay_log(&log, map.as_ref(), &settings, cancel);
                watched(output, log.scans.len(), replay)?
            }
            Format::Ticks => {
                let settings = LaserReplaySettings::from_config(&self.config.over(mines_rover::preset())?);
                let log = surepose_io::mines_rover::read(&self.path)?;
                let replay = |cancel: &CancelToken| mines_rover::replay_log(&log, &settings, cancel);
                Ok(watched(output, log.scans.len(), replay)?.report)
            }
            Format::Wean => Ok(self.wean(output)?),
            Format::Mcap => Ok(self.mcap()?),
        };
        let report = report.map_err(|error| match error {
            ReplayError::Data(error) => CliError::Data(error),
            ReplayError::NoStart => CliError::Recording { path: self.path.clone(), what: error.to_string() },
        })?;
        let mut json = object(&report);
        interrupt::mark(&mut json);
        output.result(&json, || {
            let mut table = table(&[]);
            for row in worded(&json, &WORDS) {
                table.add_row(row);
            }
            table
        })?;
        if interrupt::asked() {
            return Ok(Exit::Interrupted);
        }
        if let Some(why) = skipped(&report) {
            warning(&why);
        }
        let failing = failing(&report);
        if let Some(why) = failing {
            warning(why);
        }
        // Somewhere is no place: what was asked for was not found.
        let placed = report.hypotheses_left.is_none_or(|left| left == 1 && report.found_s.is_some());
        Ok(if placed && failing.is_none() { Exit::Done } else { Exit::Negative })
    }

    /// Follows the robot through Wean Hall, looks for it first where nobody says where it starts, and draws it.
    fn wean(&self, output: Output) -> Result<ReplayReport, CliError> {
        let config = self.config.over(cmu_wean::preset())?;
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;
        let building = match self.map.as_deref().map(read_map_file).transpose()? {
            Some(MapFile::Grid(grid)) => BuildingMap::from_grid(grid),
            Some(MapFile::Walls(map)) => BuildingMap::from_wall_map(&map),
            None => BuildingMap::from_wall_map(&WallMap::default()),
        };
        let log = surepose_io::cmu_wean::read(&self.path)?;
        let (start, settings) = (self.start.map(PoseArg::pose), cmu_wean::settings(&config));
        let replay = |cancel: &CancelToken| cmu_wean::replay(&log, &building, start, &settings, cancel);
        let followed = watched(output, log.scans.len(), replay)?;
        if let Some(folder) = folder {
            folder.picture("replay", &picture::building_map(&building, &log, &followed))?;
        }
        Ok(followed.report)
    }

    /// Lets the node's driver hear the recording.
    fn mcap(&self) -> Result<ReplayReport, CliError> {
        let names = names_of(&self.remap)?;
        let map = self.map.as_deref().map(walls_to_read).transpose()?;
        let (map, scan_method) =
            map.map_or((None, ScanMethod::Lines), |(map, scan_method)| (Some(map), scan_method));
        let settings = NodeDriverSettings {
            config: self.config.over(Config::default())?,
            map,
            scan_method,
            start: self.start.map(|start| Belief::new(start.pose(), START_STD)),
            compass: self.compass,
            safety_radius: 0.0,
            hold: false,
        };
        let notify = |notice: Notice| match notice {
            Notice::LaserMount(line) => say(&line),
            Notice::Truncated(truncation) => warning(&truncation.to_string()),
        };
        bag::replay(&self.path, &settings, &names, notify)
            .map_err(|error| CliError::Recording { path: self.path.clone(), what: error.to_string() })
    }

    /// Refuses options that the format has no use for, and asks for those that it needs.
    fn check(&self) -> Result<(), CliError> {
        let usage =
            |what: &str, help: &str| Err(CliError::Usage { what: what.to_owned(), help: help.to_owned() });
        match self.format {
            Format::Carmen | Format::Ticks | Format::Wean | Format::Mcap if self.robot.is_some() => {
                usage("only recordings of mrclam have several robots", "leave out --robot")
            }
            Format::Mrclam if self.map.is_some() => {
                usage("mrclam has landmarks, and no use for a wall map", "leave out --map")
            }
            Format::Ticks if self.map.is_some() => {
                usage("ticks makes its own map, from where the robot starts", "leave out --map")
            }
            Format::Wean if self.map.is_none() => {
                usage("wean has no map of its own", "give --map wean.dat.gz, the hall's own grid")
            }
            Format::Mrclam | Format::Carmen | Format::Ticks | Format::Mcap if self.out.is_some() => {
                usage("only wean's scans are drawn on a map", "leave out --out")
            }
            Format::Mrclam | Format::Carmen | Format::Ticks if self.start.is_some() => {
                usage("only wean and mcap need to be told where the robot starts", "leave out --start")
            }
            Format::Mcap => Ok(()),
            _ if self.compass || !self.remap.is_empty() => {
                usage("only recordings in mcap have topics", "leave out --compass and --remap")
            }
            _ => Ok(()),
        }
    }
}

/// Shows how many of the `scans` are done while `replay` goes on, and ends it where the user asks for that.
fn watched<T: Send>(
    output: Output,
    scans: usize,
    replay: impl FnOnce(&CancelToken) -> T + Send,
) -> Result<T, CliError> {
    let (cancel, bar) = (CancelToken::default(), progress::bar(output, "replaying"));
    let part = || cancel.completed() as f64 / scans.max(1) as f64;
    progress::attended(&bar, part, || cancel.cancel(), || replay(&cancel))
}

/// What shows that the estimator was of no use.
fn failing(report: &ReplayReport) -> Option<&'static str> {
    // What no measurement moved is as good as dead reckoning, to the last digits.
    const SAME: f64 = 1e-6;
    // The quantile of χ² with 3 rows for one estimate of 10⁶ is 31.
    const SURE_OF_ITSELF: f64 = 100.0;
    if report.steps == 0 {
        return Some("the recording has not one step of odometry: nobody was followed");
    }
    if report.accepted == 0 {
        return Some("no measurement was accepted: this is dead reckoning");
    }
    if report.nees_median.is_some_and(|nees| nees > SURE_OF_ITSELF) {
        return Some(
            "the estimate is not where it is sure to be: is the map of this place, and are the settings of this robot?",
        );
    }
    let (estimated, reckoned) = (report.position_rmse_m?, report.dead_reckoning_position_rmse_m?);
    (estimated > reckoned + SAME).then_some("the estimate is farther off than dead reckoning alone")
}

/// What was left out of a recording, where that is more than a little of it.
fn skipped(report: &ReplayReport) -> Option<String> {
    // A tenth of the records.
    let much = report.steps / 10;
    let (why, count) = report.skipped.iter().max_by_key(|(_, count)| **count)?;
    (u64::from(*count) > much)
        .then(|| format!("{count} records are not used, for {why}: see `skipped` in --json"))
}

/// The report's keys in words.
const WORDS: [(&str, &str); 22] = [
    ("steps", "odometry records"),
    ("duration_s", "duration [s]"),
    ("distance_m", "way [m]"),
    ("wall_s", "computing time [s]"),
    ("position_rmse_m", "position error, RMS [m]"),
    ("heading_rmse_deg", "heading error, RMS [°]"),
    ("position_median_m", "position error, median [m]"),
    ("nees_mean", "NEES, mean (3 if consistent)"),
    ("nees_median", "NEES, median (2.37 if consistent)"),
    ("dead_reckoning_position_rmse_m", "dead reckoning's position error, RMS [m]"),
    ("dead_reckoning_heading_rmse_deg", "dead reckoning's heading error, RMS [°]"),
    ("beams_on_walls", "part of the beams on walls"),
    ("found_s", "found after [s]"),
    ("found_x_m", "found at x [m]"),
    ("found_y_m", "found at y [m]"),
    ("found_heading_deg", "found with heading [°]"),
    ("hypotheses_left", "places that explain the scans"),
    ("explained", "part of the surface seen that is on walls"),
    ("before_walls", "part of it before walls"),
    ("beyond_walls", "part of it beyond walls"),
    ("accepted", "measurements used"),
    ("rejected", "measurements refused"),
];
