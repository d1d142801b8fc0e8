//! Formats at the edge: recordings of real robots and maps, each known to exactly one module.
//!
//! Inside, there are metres, seconds and radians only, in plain structs. What a format counts in centimetres,
//! milliseconds or ticks ends in its module.
//!
//! | module | reads | gives |
//! |---|---|---|
//! | [`mrclam`] | UTIAS MRCLAM folder: commanded velocities, barcode sightings, motion capture | [`mrclam::RobotLog`] |
//! | [`carmen`] | CARMEN log corrected by SLAM: `FLASER`, `ODOM` | [`Recording`](recording::Recording) of poses |
//! | [`mines_rover`] | `mines_rover`: wheel counters and 682 ranges per line | [`Recording`](recording::Recording) of ticks |
//! | [`cmu_wean`] | CMU Wean Hall: log of `O` and `L` lines; text grid | [`Recording`](recording::Recording) of poses, [`grid::Grid`] |
//! | [`map_server`] | ROS map server: YAML beside an image | [`grid::Grid`] |
//! | [`pgm`] | grey images, `P5` and `P2` | [`pgm::Image`] |
//! | [`wall_map`] | walls by their end points, TOML; also written | [`wall_map::WallMap`] |
//! | [`start_poses`] | start poses, CSV | poses seen from the goal |
//!
//! Recordings, grids and images may be plain or gzip; their first two bytes tell which, not their name.
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
//! # What is refused
//! A recording is read whole or refused whole, with a [`DataError`] that names file and line and says what would be
//! right: a damaged or cut gzip stream, binary data, a wrong number of columns, a count that disagrees with what
//! follows it, a number that is NaN, infinite or beyond the bounds of its quantity (a stamp in milliseconds, say), time
//! that goes back. Only what a format itself calls missing is a value: a laser beam without return, and a barcode
//! that belongs to nobody.
//!
//! No input makes a parser panic. Memory is bounded by constants: a text is at most [`lines::MAX_TEXT_BYTES`] bytes
//! after decompression, a line [`lines::MAX_LINE_BYTES`] bytes, a grid [`grid::MAX_CELLS`] cells, and nothing is allocated
//! for a count that a file merely declares; a gzip bomb of the shortest valid records ends, refused, at 1.05 GB.
//! `fuzz/` has a target per parser.

pub mod carmen;
pub mod cmu_wean;
mod document;
pub mod error;
pub mod grid;
mod half_circle;
pub mod lines;
pub mod map_server;
pub mod mines_rover;
pub mod mrclam;
pub mod owned_map;
pub mod pgm;
mod quantity;
pub mod recording;
mod source;
pub mod start_poses;
pub mod wall_map;

pub use error::{DataError, Problem};
pub use source::{ZstdReader, read_plain};
