//! `surepose replay`: runs the estimator on a recording and compares it with the reference.

mod consistency;
mod track;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use surepose::estimation::Belief;
use surepose_config::{Config, ScanMethod};
use surepose_figures as picture;
use surepose_io::wall_map::WallMap;
use surepose_recorder::is_recording;
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
use crate::{interrupt, progress, recording};

use track::write_track;

/// Run the estimator on a recording and compare the estimate with the reference of the recording
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose replay mrclam MRCLAM_Dataset7 --robot 3
  surepose replay carmen freiburg-101-corrected.log.gz --out freiburg
  surepose replay wean robotdata1.log.gz --map wean.dat.gz --start 40,41.4,-96 --out pictures
  surepose replay wean robotdata1.log.gz --map wean.dat.gz
  surepose replay ticks exp1.dat.gz
  surepose replay mcap rosbag2/drive_0.mcap --map building.toml --compass --remap truth:=/mocap/pose
  surepose replay mrclam MRCLAM_Dataset7 --robot 3 --set robot.track_m=0.27 --json
  surepose replay mcap drive                            a recording of `run --record drive`: repeats it to the bit
  surepose replay mcap drive --set law.k_v=3 --json     names the first step that differs, and its input

Exit codes: 0 done; 1 a recording of --record is not repeated to the bit, the estimate is inconsistent (NEES mean above 10 or median above 6), less than 20 % of the recording \
could be judged, the robot was not localized, the recording has no odometry step, or no measurement was accepted; 2 usage or configuration error; 3 recording or map \
unreadable or malformed; 130 interrupted (carmen, ticks and wean: the part replayed until then is evaluated).")]
pub(crate) struct ReplayCommand {
    /// The format of the recording
    format: Format,
    /// The recording: a file, or a directory if the format has several files
    path: PathBuf,
    /// A wall map (.toml), or an occupancy grid from which walls are extracted (.yaml, or the grid of Wean Hall); without it, `carmen` builds a map from every second scan and is evaluated on the others
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// The start pose, in meters, meters and degrees, for recordings without reference, or to replace it; without it, `wean` localizes globally and exits with 1 while several poses are possible
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<PoseArg>,
    /// Use the absolute heading of the topic imu (mcap only)
    #[arg(long)]
    compass: bool,
    /// Use the yaw rate of the topic imu (mcap only)
    #[arg(long)]
    gyroscope: bool,
    /// Rename a topic (mcap only), for example odom:=/base/odom; needed if the topics are not odom, scan, imu and truth and their type is not unique. May be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<String>,
    /// The number of the robot (mrclam only); default 1
    #[arg(long, value_parser = whole(0..=u32::MAX), allow_negative_numbers = true)]
    robot: Option<u32>,
    /// A directory for the trajectory (TUM and CSV, with errors and NEES over time) and pictures of it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Another recording of `run --record` or `ros2 --record`: name the first step at which the replay differs from it
    #[arg(long, value_name = "DIR")]
    against: Option<PathBuf>,
    #[command(flatten)]
    config: ConfigArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// UTIAS MRCLAM: velocity commands, landmark observations, motion capture
    Mrclam,
    /// CARMEN log: odometry, laser scans, poses corrected by SLAM
    Carmen,
    /// Wheel ticks and laser scans; the map is built during the replay
    Ticks,
    /// CMU Wean Hall: odometry and laser scans on a given map
    Wean,
    /// ROS 2 messages in an MCAP file of rosbag2: odometry, laser scans with --map, heading with --compass
    Mcap,
}

impl ReplayCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        self.check()?;
        if self.format == Format::Mcap && is_recording(&self.path) {
            self.check_bit_replay()?;
            return recording::replay(&self.path, self.against.as_deref(), &self.config, output);
        }
        if self.against.is_some() {
            let what = "--against: only recordings of --record are compared".to_owned();
            let help = "leave out --against, or give the directory of `surepose run --record DIR`".to_owned();
            return Err(CliError::Usage { what, help });
        }
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;
        let report = match self.format {
            Format::Mrclam => {
                let config = self.config.over(mrclam::MrclamSettings::preset())?;
                let settings = mrclam::MrclamSettings {
                    start: self.start.map(PoseArg::pose),
                    ..mrclam::MrclamSettings::from_config(&config)
                };
                mrclam::replay(&self.path, self.robot.unwrap_or(1), &settings)
            }
            Format::Carmen => {
                let settings = carmen::CarmenSettings {
                    start: self.start.map(PoseArg::pose),
                    ..carmen::CarmenSettings::from_config(
                        &self.config.over(carmen::CarmenSettings::preset())?,
                    )
                };
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
            Format::Wean => Ok(self.wean(output, folder.as_ref())?),
            Format::Mcap => Ok(self.mcap()?),
        };
        let report = report.map_err(|error| match error {
            ReplayError::Data(error) => CliError::Data(error),
            ReplayError::NoStart | ReplayError::NoOdometry | ReplayError::NoMap => {
                CliError::Recording { path: self.path.clone(), what: error.to_string() }
            }
        })?;
        let mut json = object(&report);
        interrupt::mark(&mut json);
        // A result is printed even if its files cannot be written.
        let written: Result<(), CliError> = folder.as_ref().map_or(Ok(()), |folder| {
            write_track(folder, &report.track)?;
            folder.summary(&json)
        });
        output.result(&json, || {
            let mut table = table(&[]);
            for row in worded(&json, &WORDS) {
                table.add_row(row);
            }
            table
        })?;
        written?;
        if interrupt::asked() {
            return Ok(Exit::Interrupted);
        }
        if let Some(why) = skipped(&report) {
            warning(&why);
        }
        let Some(why) = consistency::failure(&report) else { return Ok(Exit::Done) };
        warning(&why);
        Ok(Exit::Negative)
    }

    /// Replays a Wean Hall log, with global localization if no start pose is given, and draws the result.
    fn wean(&self, output: Output, folder: Option<&OutputDir>) -> Result<ReplayReport, CliError> {
        let config = self.config.over(cmu_wean::preset())?;
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

    /// Feeds the recording to the driver of the ROS 2 node.
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
            gyroscope: self.gyroscope,
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

    /// Rejects options that a recording of --record determines itself.
    fn check_bit_replay(&self) -> Result<(), CliError> {
        let options = [
            ("--map", self.map.is_some()),
            ("--start", self.start.is_some()),
            ("--compass", self.compass),
            ("--gyroscope", self.gyroscope),
            ("--remap", !self.remap.is_empty()),
            ("--out", self.out.is_some()),
        ];
        let Some((option, _)) = options.into_iter().find(|(_, is_given)| *is_given) else { return Ok(()) };
        let what = format!(
            "{option}: not used for a recording of --record, which has its own map, start and topics"
        );
        Err(CliError::Usage { what, help: format!("leave out {option}") })
    }

    /// Rejects options that the format does not use, and requires those that it needs.
    fn check(&self) -> Result<(), CliError> {
        let usage =
            |what: &str, help: &str| Err(CliError::Usage { what: what.to_owned(), help: help.to_owned() });
        match self.format {
            Format::Carmen | Format::Ticks | Format::Wean | Format::Mcap if self.robot.is_some() => {
                usage("--robot: only mrclam recordings have several robots", "leave out --robot")
            }
            Format::Mrclam if self.map.is_some() => {
                usage("--map: mrclam uses landmarks instead of a wall map", "leave out --map")
            }
            Format::Ticks if self.map.is_some() => {
                usage("--map: ticks builds its own map, starting at the first pose", "leave out --map")
            }
            Format::Wean if self.map.is_none() => usage(
                "--map: required for wean recordings",
                "add --map wean.dat.gz, the occupancy grid of Wean Hall",
            ),
            Format::Ticks if self.start.is_some() => {
                usage("--start: ticks starts at the origin of its own map", "leave out --start")
            }
            Format::Mcap => Ok(()),
            _ if self.compass || self.gyroscope || !self.remap.is_empty() => usage(
                "--compass, --gyroscope, --remap: only mcap recordings have topics",
                "leave out --compass, --gyroscope and --remap",
            ),
            _ => Ok(()),
        }
    }
}

/// Runs `replay` with a progress bar over `scans` scans, and cancels it on Ctrl-C.
fn watched<T: Send>(
    output: Output,
    scans: usize,
    replay: impl FnOnce(&CancelToken) -> T + Send,
) -> Result<T, CliError> {
    let (cancel, bar) = (CancelToken::default(), progress::bar(output, "replaying"));
    let part = || cancel.completed() as f64 / scans.max(1) as f64;
    progress::attended(&bar, part, || cancel.cancel(), || replay(&cancel))
}

/// Returns a warning if a skipped kind of record makes up more than a tenth of the steps; else `None`.
fn skipped(report: &ReplayReport) -> Option<String> {
    let stamps: u32 = STAMP_KINDS.iter().filter_map(|kind| report.skipped.get(kind)).sum();
    if stamps > 0 {
        return Some(format!(
            "{stamps} time stamps step back, are below 0 or are absent; the order of the lines counts, see `skipped` in the \
             output of --json"
        ));
    }
    // A tenth of the steps.
    let much = report.steps / 10;
    let (why, count) = report.skipped.iter().max_by_key(|(_, count)| **count)?;
    (u64::from(*count) > much)
        .then(|| format!("{count} records were skipped ({why}); see `skipped` in the output of --json"))
}

/// Irregular stamps among the skipped kinds; their records are used.
const STAMP_KINDS: [&str; 3] = ["stamp_stepped_back", "stamp_below_zero", "stamp_absent"];

/// Table labels of the keys of the report.
const WORDS: [(&str, &str); 28] = [
    ("steps", "odometry steps"),
    ("duration_s", "duration [s]"),
    ("distance_m", "path length [m]"),
    ("wall_s", "computing time [s]"),
    ("position_rmse_m", "position error, RMS [m]"),
    ("heading_rmse_deg", "heading error, RMS [°]"),
    ("position_median_m", "position error, median [m]"),
    ("nees_mean", "NEES, mean (3 if consistent)"),
    ("nees_median", "NEES, median (2.37 if consistent)"),
    ("dead_reckoning_position_rmse_m", "dead reckoning, position error, RMS [m]"),
    ("dead_reckoning_heading_rmse_deg", "dead reckoning, heading error, RMS [°]"),
    ("ape", "absolute pose error"),
    ("rpe", "relative pose error over 1 m"),
    ("judged_share", "judged fraction of the recording"),
    ("scan_lag_records", "lag of the scans [odometry records]"),
    ("scan_lag_std_records", "standard error of the lag"),
    ("relocalizations", "poses found by search"),
    ("beams_on_walls", "fraction of beams on walls"),
    ("found_s", "localized after [s]"),
    ("found_x_m", "localized at x [m]"),
    ("found_y_m", "localized at y [m]"),
    ("found_heading_deg", "localized heading [°]"),
    ("hypotheses_left", "remaining pose hypotheses"),
    ("explained", "observed surface on walls, fraction"),
    ("before_walls", "observed surface in front of walls, fraction"),
    ("beyond_walls", "observed surface behind walls, fraction"),
    ("accepted", "accepted measurements"),
    ("rejected", "rejected measurements"),
];
