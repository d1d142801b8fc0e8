//! Decoded images: gray values and opacity.

use crate::grid::MAX_CELLS;

/// An image as the map server sees it: gray values, and opacity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels per row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// The value of white, from 1 to 65535.
    pub white: u16,
    /// The gray values, row by row from the top, at most `white`. Colors are the mean of red, green and blue.
    pub pixels: Vec<u16>,
    /// The opacity of each pixel, from 0 to 255; empty for an image without an alpha channel.
    pub alpha: Vec<u8>,
}

/// The value of white of an image with 8-bit colors: pixels hold the sum of red, green and blue.
pub(super) const COLOR_WHITE: u16 = 3 * 255;

/// Checks the size of an image; returns the number of its pixels, or the problem.
pub(super) fn pixel_count(width: usize, height: usize) -> Result<usize, String> {
    if width == 0 || height == 0 {
        return Err(format!("image: empty (got {width} x {height} pixels)"));
    }
    let count = width.checked_mul(height).filter(|&count| count <= MAX_CELLS);
    count.ok_or_else(|| {
        format!(
            "image: too large (got {width} x {height}, expected at most {MAX_CELLS} pixels); crop the map"
        )
    })
}
