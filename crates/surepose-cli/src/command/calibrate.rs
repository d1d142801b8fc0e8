//! `surepose calibrate`: what a recording says of the robot that made it.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use surepose_data::ticks::{self, ROVER};
use surepose_lab::calibrate::{Options, Recording, calibrate};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::folder::Folder;
use crate::output::{Output, object, table, wrapped};

/// Fit wheel radii, track, noise, laser mounting and latency to a recording, with standard errors.
#[derive(Debug, Args)]
#[command(after_help = "Example: surepose calibrate ticks exp1.dat.gz --out calibration

All lengths are in the laser's metres. What the motion did not excite is said so, not guessed.")]
pub(crate) struct CalibrateCommand {
    /// The format of the recording
    format: Format,
    /// The recording
    path: PathBuf,
    /// A folder for the configuration that was found
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Formats whose recordings have wheel counters and scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Wheel ticks and a laser, as the mines rover recorded them
    Ticks,
}

impl CalibrateCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, Failure> {
        let Format::Ticks = self.format;
        let folder = self.out.as_deref().map(Folder::at).transpose()?;
        let log = ticks::read(&self.path)?;
        let recording = Recording {
            ticks_per_turn: ROVER.ticks_per_turn,
            ticks: log.odometry,
            scans: log.scans,
            headings: Vec::new(),
        };
        let found = calibrate(&recording, &Options::rover())
            .map_err(|why| Failure::Recording { path: self.path, what: why.to_string() })?;
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
}
