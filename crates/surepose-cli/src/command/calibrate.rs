//! `surepose calibrate`: estimates the parameters of a robot from a recording.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use surepose::param::Choice;
use surepose_config::Config;
use surepose_io::mines_rover::{self, ROVER};
use surepose_mapping::calibrate::{CalibrationError, CalibrationRecording, Options, STAGES, calibrate};
use surepose_ros2::bag::{self, Recorded};
use surepose_sim::CancelToken;

use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, object, say, table, warning, wrapped};
use crate::output_dir::OutputDir;
use crate::settings::{ConfigArgs, names_of};
use crate::{interrupt, progress};

/// Calibrate wheels, odometry noise, laser pose and latencies from a recording, and delay, limits and least speeds of the base, with standard errors
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose calibrate ticks exp1.dat.gz --out calibration
  surepose calibrate mcap rosbag2/drive_0.mcap --config robot.toml --compass --out calibration

The laser sets the scale of all lengths. A parameter that the motion does not excite is reported as such, without a value: \
record a few minutes in view of walls, with turns in both directions and changing speeds.

mcap: `odom` must come from the wheels alone, and [robot] must hold the wheel parameters of the base; they convert odometry \
back into wheel angles. Copy the calibrated values into the configuration of the base as well, because the base computes \
odometry. With --compass the headings of `imu` are used; the compass offset also needs the topic `truth`. If `cmd_vel` was recorded, \
the delay, the lag, the limits of acceleration and the least executable speeds of the base are estimated, too.

Exit codes: 0 done; 2 usage or configuration error; 3 recording unreadable, malformed or not sufficient for calibration; \
130 interrupted.")]
pub(crate) struct CalibrateCommand {
    /// The format of the recording
    format: Format,
    /// The recording
    path: PathBuf,
    /// A directory for the calibrated configuration
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Use the absolute heading of the topic imu (mcap only)
    #[arg(long)]
    compass: bool,
    /// Rename a topic (mcap only), for example odom:=/base/odom; needed if the topics are not odom, scan, imu and truth and their type is not unique. May be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<String>,
    #[command(flatten)]
    config: ConfigArgs,
}

/// Formats with wheel odometry and laser scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Wheel ticks and laser scans of the mines rover
    Ticks,
    /// ROS 2 messages in an MCAP file of rosbag2: odometry and laser scans, heading with --compass
    Mcap,
}

impl CalibrateCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let folder = self.out.as_deref().map(OutputDir::at).transpose()?;
        let (recording, options) = match self.format {
            Format::Ticks => self.ticks()?,
            Format::Mcap => self.mcap()?,
        };
        let (cancel, bar) = (CancelToken::default(), progress::bar(output, "fitting"));
        let part = || cancel.completed() as f64 / STAGES as f64;
        let fit = || calibrate(&recording, &options, &cancel);
        let found = match progress::attended(&bar, part, || cancel.cancel(), fit)? {
            // A partial fit has no result.
            Err(CalibrationError::Stopped) => return interrupt::nothing(output),
            found => found.map_err(|why| CliError::Recording { path: self.path, what: why.to_string() })?,
        };
        // A result is printed even if its file cannot be written.
        let written = folder.map_or(Ok(()), |folder| folder.text("calibration.toml", &found.configuration()));
        let parameters = found.parameters();
        let mut report = object(&parameters);
        let stamped = found.laser_stamp().map(Choice::name);
        report.extend(stamped.map(|name| ("laser_stamp".to_owned(), name.into())));
        output.result(&report, || {
            let mut table = table(&["parameter", "value", "standard error", "unit"]);
            for (name, estimate) in &parameters {
                let number =
                    |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
                let unknown = estimate.not_excited.map(|motion| format!("not excited: requires {motion}"));
                let value = unknown.unwrap_or_else(|| number(estimate.value));
                table.add_row([
                    (*name).to_owned(),
                    value,
                    number(estimate.std_error),
                    estimate.unit.to_owned(),
                ]);
            }
            if let Some(name) = stamped {
                table.add_row(["laser_stamp".to_owned(), name.to_owned(), String::new(), String::new()]);
            }
            wrapped(table)
        })?;
        written?;
        Ok(Exit::Done)
    }
    fn ticks(&self) -> Result<(CalibrationRecording, Options), CliError> {
        if self.compass || !self.remap.is_empty() || self.config.is_given() {
            return Err(CliError::Usage {
                what: "--config, --set, --compass, --remap: not used with ticks, whose robot is known"
                    .to_owned(),
                help: "leave out --config, --set, --compass and --remap".to_owned(),
            });
        }
        let log = mines_rover::read(&self.path)?;
        let recording = CalibrationRecording {
            ticks_per_turn: ROVER.ticks_per_turn,
            ticks: log.odometry,
            scans: log.scans,
            headings: Vec::new(),
            commands: Vec::new(),
        };
        Ok((recording, Options::rover()))
    }

    fn mcap(&self) -> Result<(CalibrationRecording, Options), CliError> {
        let config = self.config.over(Config::default())?;
        let names = names_of(&self.remap)?;
        let Recorded { recording, options, skipped, mounted, truncations } =
            bag::recorded(&self.path, &config, &names, self.compass)
                .map_err(|error| CliError::Recording { path: self.path.clone(), what: error.to_string() })?;
        if let Some(line) = mounted {
            say(&line);
        }
        for truncation in &truncations {
            warning(&truncation.to_string());
        }
        if !skipped.is_empty() {
            let counted: Vec<_> = skipped.iter().map(|(why, count)| format!("{count} {why}")).collect();
            warning(&format!("skipped messages: {}", counted.join(", ")));
        }
        Ok((recording, options))
    }
}
