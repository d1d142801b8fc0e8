//! `surepose map`: wall maps from occupancy grids and from recordings.

mod output;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use output::{MapOutput, keep, name_of, pictures_of};
use surepose_figures::{self as picture, MapBackground};
use surepose_io::{carmen, map_server, wall_map};
use surepose_mapping::{MapReport, MappingResult, from_grid, from_log};
use surepose_replay::carmen::{map_from_log, views};

use crate::error::CliError;
use crate::exit::Exit;
use crate::interrupt;
use crate::maps::grid_in;
use crate::output::{Output, object, table, warning};
use crate::output_dir::{OutputDir, write_file};

/// Make a wall map, or show one.
#[derive(Debug, Args)]
pub(crate) struct MapCommand {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// The walls of an occupancy grid in the map_server form of ROS
    #[command(after_help = "Examples:
  surepose map from-grid turtlebot3_world.yaml --out walls.toml
  surepose map from-grid turtlebot3_world.yaml --out walls.toml --picture pictures")]
    FromGrid {
        /// The grid's YAML file; where the image that it names is absent, that of its own name is read
        grid: PathBuf,
        /// The wall map to write, with a picture of the same name beside it
        #[arg(long, value_name = "MAP.toml")]
        out: PathBuf,
        /// A folder for the picture, which has the walls and the grid below; beside the map unless given
        #[arg(long, value_name = "DIR")]
        picture: Option<PathBuf>,
    },
    /// The walls that a recording's scans show at its reference poses
    #[command(
        after_help = "Example: surepose map from-log carmen freiburg-101-corrected.log.gz --out walls.toml"
    )]
    FromLog {
        /// The format of the recording
        format: Format,
        /// The recording
        path: PathBuf,
        /// The wall map to write, with a picture of the same name beside it
        #[arg(long, value_name = "MAP.toml")]
        out: PathBuf,
        /// A folder for the picture, which has the walls and where the beams ended below; beside the map unless given
        #[arg(long, value_name = "DIR")]
        picture: Option<PathBuf>,
    },
    /// How many walls a map has, and how long they are
    #[command(after_help = "Examples:
  surepose map show walls.toml --out pictures
  surepose map show walls.toml --grid turtlebot3_world.yaml --out pictures")]
    Show {
        /// The wall map
        map: PathBuf,
        /// An occupancy grid to draw below the walls
        #[arg(long, value_name = "GRID.yaml", requires = "out")]
        grid: Option<PathBuf>,
        /// A folder for a picture of it
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
}

/// Formats whose recordings have reference poses for their scans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// CARMEN: poses corrected by SLAM
    Carmen,
}

impl MapCommand {
    pub(crate) fn run(self, output: Output) -> Result<Exit, CliError> {
        let report = match self.what {
            What::FromGrid { grid, out, picture } => {
                let target = MapOutput::new(out, picture, &[&grid, &map_server::image_of(&grid)?])?;
                let grid = grid_in(&grid)?;
                write(&from_grid::extract_walls(&grid), MapBackground::Grid(&grid), &target)?
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
                    keep(&[&map], pictures_of(&map, folder), "give --out another folder")?;
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
                table.add_row(["residual (rms)".to_owned(), format!("{:.1} mm", 1e3 * residual)]);
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
            warning("no wall was found: are the cells of walls occupied, and several in a row?");
            return Ok(Exit::Negative);
        }
        Ok(Exit::Done)
    }
}

/// Writes the map, and its picture beside it or into a folder of its own.
fn write(
    mapped: &MappingResult,
    ground: MapBackground<'_>,
    target: &MapOutput,
) -> Result<MapReport, CliError> {
    let text = mapped.map.to_toml(&target.map)?;
    // A map comes with its picture: from here on, Ctrl-C waits for it.
    interrupt::listen();
    write_file(&target.map, &text)?;
    target.pictures.picture(&name_of(&target.map), &picture::wall_map(&mapped.map, ground))?;
    Ok(mapped.report)
}
