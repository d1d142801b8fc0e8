//! Reads recordings of real robots, maps and the configuration.
//!
//! Each format is implemented by exactly one module. Modules convert centimeters, milliseconds and ticks; all values of
//! this crate are in meters, seconds and radians, in plain structs.
//!
//! | module | reads | returns |
//! |---|---|---|
//! | [`mrclam`] | UTIAS MRCLAM folder: velocity commands, landmark observations, motion capture | [`mrclam::RobotLog`] |
//! | [`carmen`] | CARMEN log corrected by SLAM: `FLASER`, `ODOM` | [`Recording`](recording::Recording) of poses |
//! | [`mines_rover`] | `mines_rover`: wheel counters and 682 ranges per line | [`Recording`](recording::Recording) of ticks |
//! | [`cmu_wean`] | CMU Wean Hall: log of `O` and `L` lines; text grid | [`Recording`](recording::Recording) of poses, [`grid::Grid`] |
//! | [`map_server`] | ROS map server: YAML file and image | [`grid::Grid`] |
//! | [`image`] | PGM, PNG and BMP images of grids | [`image::Image`] |
//! | [`wall_map`] | walls by their end points, TOML; also writes them | [`wall_map::WallMap`] |
//! | [`mcap`] | records of ROS 2 messages, MCAP; also writes them | [`mcap::McapRecord`] |
//! | [`start_poses`] | start poses, CSV | poses relative to the goal |
//! | [`config`] | the configuration, TOML | [`Config`] |
//!
//! Recordings, grids and images may be plain, gzip or zstd; the first bytes of the file decide, not its name.
//!
//! ```no_run
//! use surepose_io::{carmen, DataError};
//! # fn main() -> Result<(), DataError> {
//! let log = carmen::read("freiburg-101-corrected.log.gz".as_ref())?;
//! for (scan, reference) in log.scans.iter().zip(&log.reference) {
//!     println!("{} beams at ({} m, {} m)", scan.ranges.len(), reference.x, reference.y);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Errors
//! A recording is read completely or rejected with a [`DataError`], which names file, line, problem and remedy. Rejected
//! are damaged or truncated compressed streams, binary data, a wrong number of columns, and counts that differ from the
//! content. Numbers must be finite and within the bounds of their quantity, which detects wrong units such as
//! stamps in milliseconds. Stamps must not decrease. Only values that a format defines as missing are accepted: a laser
//! beam without return, and a barcode that is not in the data set.
//!
//! No input makes a parser panic. Memory is bounded: a text has at most [`lines::MAX_TEXT_BYTES`] bytes after
//! decompression, a line [`lines::MAX_LINE_BYTES`] bytes, a grid [`grid::MAX_CELLS`] cells. No memory is allocated for a
//! count that a file merely declares. A gzip bomb of the shortest valid records is rejected at 1.05 GB of memory.
//! `fuzz/` has one target per parser.

pub mod carmen;
pub mod cmu_wean;
mod document;
pub mod error;
pub mod grid;
mod half_circle;
pub mod image;
pub mod lines;
pub mod map_server;
pub mod mcap;
pub mod mines_rover;
pub mod mrclam;
pub mod owned_map;
mod quantity;
pub mod recording;
pub mod ros_parameters;
mod source;
pub mod start_poses;
pub mod wall_map;

pub use error::{DataError, Problem};
pub use source::{ZstdReader, read_plain};
