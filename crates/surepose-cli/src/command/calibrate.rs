//! `surepose calibrate`: what a recording says of the robot that made it.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
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

/// Fit wheel radii, track, noise, laser mounting and latency to a recording, with standard errors.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose calibrate ticks exp1.dat.gz --out calibration
  surepose calibrate mcap rosbag2/drive_0.mcap --config robot.toml --compass --out calibration

All lengths are in the laser's metres. What the motion did not excite is said so, not guessed: drive a few minutes in sight of \
walls, with turns both ways, at changing speeds.

mcap: `odom` must be of the wheels alone, and [robot] what its base takes the wheels for: by that it is turned back into how far \
they turned. Give the base what was found as well, for it is the base that makes odometry of it. With --compass the headings of \
`imu` count; the compass' offset needs a `truth`, too.

Exit codes: 0 done, 2 wrong command line, 3 a recording that cannot be read, or not be calibrated from, 130 interrupted.")]
pub(crate) struct CalibrateCommand {
    /// The format of the recording
    format: Format,
    /// The recording
    path: PathBuf,
    /// A folder for the configuration that was found
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Hear the absolute heading of imu in a mcap recording
    #[arg(long)]
    compass: bool,
    /// What a topic of a mcap recording is called, where it is not odom, scan, imu or truth, or not the only one of its type: odom:=/base/odom. May be repeated
    #[arg(long, value_name = "FROM:=TO")]
    remap: Vec<String>,
    #[command(flatten)]
    config: ConfigArgs,
}

/// Formats whose recordings have wheels and scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Wheel ticks and a laser, as the mines rover recorded them
    Ticks,
    /// ROS 2 messages in MCAP, as rosbag2 writes them: odometry and a laser, with --compass a heading
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
            // There is no half of a fit to be kept.
            Err(CalibrationError::Stopped) => return interrupt::nothing(output),
            found => found.map_err(|why| CliError::Recording { path: self.path, what: why.to_string() })?,
        };
        if let Some(folder) = &folder {
            folder.text("calibration.toml", &found.configuration())?;
        }
        let parameters = found.parameters();
        output.result(&object(&parameters), || {
            let mut table = table(&["parameter", "value", "standard error", "unit"]);
            for (name, estimate) in &parameters {
                let number =
                    |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
                let unknown = estimate.not_excited.map(|motion| format!("not excited: it takes {motion}"));
                let value = unknown.unwrap_or_else(|| number(estimate.value));
                table.add_row([
                    (*name).to_owned(),
                    value,
                    number(estimate.std_error),
                    estimate.unit.to_owned(),
                ]);
            }
            wrapped(table)
        })?;
        Ok(Exit::Done)
    }
    fn ticks(&self) -> Result<(CalibrationRecording, Options), CliError> {
        if self.compass || !self.remap.is_empty() || self.config.is_given() {
            return Err(CliError::Usage {
                what: "ticks are the rover's, whose robot is known, and have neither topics nor a compass"
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
            warning(&format!("messages that are not used: {}", counted.join(", ")));
        }
        Ok((recording, options))
    }
}
