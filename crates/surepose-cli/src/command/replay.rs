//! `surepose replay`: the estimator on a recording, judged against its reference.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use surepose_data::wall_map;
use surepose_lab::replay::{ReplayError, carmen, mrclam};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{Output, object, shown, table};
use crate::settings::ConfigArgs;

/// Run the estimator on a recording and judge it against the recording's reference.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  surepose replay mrclam MRCLAM_Dataset7 --robot 3
  surepose replay carmen freiburg-101-corrected.log.gz
  surepose replay mrclam MRCLAM_Dataset7 --robot 3 --set robot.track_m=0.27 --json")]
pub(crate) struct ReplayCommand {
    /// The format of the recording
    format: Format,
    /// The recording: a file, or a folder where the format has several
    path: PathBuf,
    /// A wall map; without one, `carmen` makes its own from every second scan and is judged on the others
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Which robot, where the recording has several
    #[arg(long, default_value_t = 1)]
    robot: u32,
    #[command(flatten)]
    config: ConfigArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// UTIAS MRCLAM: commanded velocities, landmarks, motion capture
    Mrclam,
    /// CARMEN: odometry, laser, poses corrected by SLAM
    Carmen,
}

impl ReplayCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, Failure> {
        if self.map.is_some() && self.format == Format::Mrclam {
            return Err(Failure::Usage {
                what: "mrclam has landmarks, and no use for a wall map".to_owned(),
                help: "leave out --map".to_owned(),
            });
        }
        let report = match self.format {
            Format::Mrclam => {
                let config = self.config.over(mrclam::Settings::preset())?;
                mrclam::replay(&self.path, self.robot, &mrclam::Settings::of(&config))
            }
            Format::Carmen => {
                let config = self.config.over(carmen::Settings::preset())?;
                let map = self.map.as_deref().map(wall_map::read).transpose()?;
                carmen::replay(&self.path, map.as_ref(), &carmen::Settings::of(&config))
            }
        };
        let report = report.map_err(|error| match error {
            ReplayError::Data(error) => Failure::Data(error),
            ReplayError::NoStart => Failure::Recording { path: self.path.clone(), what: error.to_string() },
        })?;
        let json = object(&report);
        output.result(&json, || {
            let mut table = table(&[]);
            for (key, value) in &json {
                table.add_row([key.clone(), shown(value)]);
            }
            table
        });
        Ok(Exit::Done)
    }
}
