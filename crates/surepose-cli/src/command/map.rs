//! `surepose map`: creates wall maps from occupancy grids and recordings, and shows them.

mod output;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use output::{MapOutput, keep, name_of, pictures_of};
use surepose_figures::{self as picture, MapBackground};
use surepose_io::{carmen, map_server, wall_map};
use surepose_mapping::{MapReport, MappingResult, from_log};
use surepose_replay::carmen::{map_from_log, views};

use crate::error::CliError;
use crate::exit::Exit;
use crate::interrupt;
use crate::maps::{grid_in, walls_of};
use crate::output::{Output, object, table, warning};
use crate::output_dir::{OutputDir, write_file};

/// Create a wall map, or show one.
#[derive(Debug, Args)]
pub(crate) struct MapCommand {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Extract the walls of an occupancy grid of the ROS map_server
    #[command(after_help = "Examples:
  surepose map from-grid turtlebot3_world.yaml --out walls.toml
  surepose map from-grid turtlebot3_world.yaml --out walls.toml --picture pictures

Exit codes: 0 done; 1 no wall found; 2 usage error or output not writable; 3 grid unreadable or malformed; 130 interrupted.")]
    FromGrid {
        /// The YAML file of the grid, with a PGM, PNG or BMP image; if the image it names is absent, the one with the same file name beside it, or with its own name, is read
        grid: PathBuf,
        /// The wall map to write; its plot gets the same name
        #[arg(long, value_name = "MAP.toml")]
        out: PathBuf,
        /// A directory for the plot of the walls over the grid; default the directory of the map
        #[arg(long, value_name = "DIR")]
        picture: Option<PathBuf>,
    },
    /// Extract walls from the scans of a recording at its reference poses
    #[command(
        after_help = "Example: surepose map from-log carmen freiburg-101-corrected.log.gz --out walls.toml

Exit codes: 0 done; 1 no wall found; 2 usage error or output not writable; 3 recording unreadable or malformed; 130 interrupted."
    )]
    FromLog {
        /// The format of the recording
        format: Format,
        /// The recording
        path: PathBuf,
        /// The wall map to write; its plot gets the same name
        #[arg(long, value_name = "MAP.toml")]
        out: PathBuf,
        /// A directory for the plot of the walls over the beam end points; default the directory of the map
        #[arg(long, value_name = "DIR")]
        picture: Option<PathBuf>,
    },
    /// Show the number and total length of the walls of a map
    #[command(after_help = "Examples:
  surepose map show walls.toml --out pictures
  surepose map show walls.toml --grid turtlebot3_world.yaml --out pictures

Exit codes: 0 done; 1 no wall; 2 usage error or output not writable; 3 map or grid unreadable or malformed; 130 interrupted.")]
    Show {
        /// The wall map
        map: PathBuf,
        /// An occupancy grid to draw beneath the walls
        #[arg(long, value_name = "GRID.yaml", requires = "out")]
        grid: Option<PathBuf>,
        /// A directory for the plot
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
}

/// Formats with reference poses for their scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// CARMEN log: poses corrected by SLAM
    Carmen,
}

impl MapCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let report = match self.what {
            What::FromGrid { grid, out, picture } => {
                let target = MapOutput::new(out, picture, &[&grid, &map_server::image_of(&grid)?])?;
                let grid = grid_in(&grid)?;
                write(&walls_of(&grid), MapBackground::Grid(&grid), &target)?
            }
            What::FromLog { format: Format::Carmen, path, out, picture } => {
                let target = MapOutput::new(out, picture, &[&path])?;
                let (log, settings) = (carmen::read(&path)?, from_log::LogMappingSettings::default());
                let ends = from_log::beam_endpoints(views(&log), &settings);
                write(&map_from_log(&log, 1, &settings), MapBackground::Ends(&ends), &target)?
            }
            What::Show { map, grid, out } => {
                let walls = wall_map::read(&map)?;
                let grid = grid.as_deref().map(grid_in).transpose()?;
                if let Some(folder) = &out {
                    keep(&[&map], pictures_of(&map, folder), "give --out another directory")?;
                    let ground = grid.as_ref().map_or(MapBackground::Nothing, MapBackground::Grid);
                    OutputDir::at(folder)?.picture(&name_of(&map), &picture::wall_map(&walls, ground))?;
                }
                MapReport::from_map(&walls)
            }
        };
        let json = object(&report);
        output.result(&json, || {
            let mut table = table(&[]);
            table.add_row(["walls".to_owned(), report.walls.to_string()]);
            table.add_row(["length".to_owned(), format!("{:.1} m", report.length_m)]);
            if let Some(residual) = report.residual_rms_m {
                table.add_row(["residual (RMS)".to_owned(), format!("{:.1} mm", 1e3 * residual)]);
            }
            if let Some(explained) = report.explained {
                table.add_row(["points on a wall".to_owned(), format!("{:.1} %", 1e2 * explained)]);
            }
            table
        })?;
        if interrupt::asked() {
            return Ok(Exit::Interrupted);
        }
        if report.walls == 0 {
            warning(
                "no wall was found; check that wall cells are marked occupied and form lines of several cells",
            );
            return Ok(Exit::Negative);
        }
        Ok(Exit::Done)
    }
}

/// Writes the map and its plot, and returns the report.
fn write(
    mapped: &MappingResult,
    ground: MapBackground<'_>,
    target: &MapOutput,
) -> Result<MapReport, CliError> {
    let text = mapped.map.to_toml(&target.map)?;
    // A map is never left without its plot: from here on, Ctrl-C takes effect after both are written.
    interrupt::listen();
    write_file(&target.map, &text)?;
    target.pictures.picture(&name_of(&target.map), &picture::wall_map(&mapped.map, ground))?;
    Ok(mapped.report)
}
