//! Parses PNG images of any color type and depth, to 8 bits per channel.

use std::io::Cursor;
use std::path::Path;

use png::{ColorType, Decoder, Limits, Transformations};

use crate::document::wrong;
use crate::error::DataError;
use crate::grid::MAX_CELLS;

use super::raster::{COLOR_WHITE, Image, pixel_count};

/// Largest number of bytes per pixel: red, green, blue and alpha.
const MAX_CHANNELS: usize = 4;

pub(super) fn parse(file: &Path, bytes: &[u8]) -> Result<Image, DataError> {
    let broken = |error: png::DecodingError| {
        wrong(file, None, format!("PNG image: {error}; save the image again, as PNG or PGM"))
    };
    let mut decoder =
        Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MAX_CHANNELS * MAX_CELLS });
    decoder.set_transformations(Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let count = pixel_count(width, height).map_err(|problem| wrong(file, None, problem))?;
    let size = reader.output_buffer_size().filter(|&size| size <= MAX_CHANNELS * count);
    let mut data = vec![0; size.ok_or_else(|| wrong(file, None, "PNG image: too large; crop the map"))?];
    let color = reader.next_frame(&mut data).map_err(broken)?.color_type;
    let sum = |color: &[u8]| color.iter().copied().map(u16::from).sum();
    let (white, channels, has_alpha) = match color {
        ColorType::Grayscale => (255, 1, false),
        ColorType::GrayscaleAlpha => (255, 2, true),
        ColorType::Rgba => (COLOR_WHITE, 4, true),
        // The decoder expands palettes.
        ColorType::Rgb | ColorType::Indexed => (COLOR_WHITE, 3, false),
    };
    let colors = channels - usize::from(has_alpha);
    let pixels = data.chunks_exact(channels).map(|pixel| sum(&pixel[..colors])).collect();
    let alpha = data.chunks_exact(channels).map(|pixel| pixel[channels - 1]);
    let alpha = if has_alpha { alpha.collect() } else { Vec::new() };
    Ok(Image { width, height, white, pixels, alpha })
}
