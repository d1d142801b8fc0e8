//! Reads the images of occupancy grids: PGM, PNG and BMP, recognized by their content.

mod bmp;
mod pgm;
mod png;
mod raster;

use std::path::Path;

use crate::error::{DataError, Problem, excerpt};
use crate::lines::MAX_TEXT_BYTES;
use crate::source::read_all;

pub use raster::Image;

/// Reads an image, plain or compressed.
///
/// # Errors
/// A missing, unreadable or malformed file, with its name, and with the line for text.
pub fn read(path: &Path) -> Result<Image, DataError> {
    parse(path, &read_all(path, MAX_TEXT_BYTES)?)
}

/// Parses an image in memory; `file` is the file name in errors.
///
/// The size that a header declares is checked before memory is allocated.
///
/// # Errors
/// An unknown format, a malformed header, too few pixels, or a pixel above the value of white.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<Image, DataError> {
    match bytes {
        [b'P', b'2' | b'5', ..] => pgm::parse(file, bytes),
        [0x89, b'P', b'N', b'G', ..] => png::parse(file, bytes),
        [b'B', b'M', ..] => bmp::parse(file, bytes),
        _ => {
            let word = bytes.split(u8::is_ascii_whitespace).next().unwrap_or_default();
            let found = excerpt(word);
            let expected = "a PGM image (P5 or P2), a PNG or a BMP image";
            Err(DataError::in_file(file, Problem::UnknownRecord { found, expected }))
        }
    }
}

#[cfg(test)]
mod tests;
