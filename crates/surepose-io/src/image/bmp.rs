//! Parses Windows bitmaps: uncompressed, with 1, 4 or 8 bits and a palette, or with 24 or 32 bits.
//!
//! Reference: Microsoft, "Bitmap Storage": the file header, the information header, the palette and the rows, which
//! start at multiples of 4 bytes, the bottom row first unless the height is negative.

use std::path::Path;

use crate::document::wrong;
use crate::error::DataError;

use super::raster::{COLOR_WHITE, Image, pixel_count};

/// Length of the file header.
const FILE_HEADER: usize = 14;

/// Smallest information header that is read.
const INFO_HEADER: usize = 40;

/// Compression `BI_RGB`: none.
const UNCOMPRESSED: u32 = 0;

/// Compression `BI_BITFIELDS`: none, with a mask for each channel.
const BIT_FIELDS: u32 = 3;

/// Masks of red, green and blue in the order of the bytes of an image without masks.
const MASKS: [u32; 3] = [0x00ff_0000, 0x0000_ff00, 0x0000_00ff];

/// Mask of alpha in the fourth byte.
const ALPHA_MASK: u32 = 0xff00_0000;

pub(super) fn parse(file: &Path, bytes: &[u8]) -> Result<Image, DataError> {
    read(bytes).map_err(|problem| wrong(file, None, problem))
}

fn read(bytes: &[u8]) -> Result<Image, String> {
    let cut = || format!("BMP image: cut off (got {} bytes)", bytes.len());
    let long = |at: usize| {
        let value = bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
        value.map(u32::from_le_bytes).ok_or_else(cut)
    };
    let header = long(FILE_HEADER)? as usize;
    if header < INFO_HEADER {
        return Err(format!(
            "BMP image: old header (got {header} bytes, expected {INFO_HEADER} or more); save it as PNG"
        ));
    }
    // Two's complement: a negative height stands for rows from the top.
    let [width, height] = [long(18)?.cast_signed(), long(22)?.cast_signed()];
    let (width, from_top) = (usize::try_from(width).unwrap_or(0), height < 0);
    let height = height.unsigned_abs() as usize;
    let count = pixel_count(width, height)?;
    let (bits, compression) = ((long(28)? & 0xffff) as usize, long(30)?);
    let mask = |channel: usize| long(FILE_HEADER + INFO_HEADER + 4 * channel);
    let has_masks = compression == BIT_FIELDS && bits == 32;
    let is_known = match compression {
        UNCOMPRESSED => [1, 4, 8, 24, 32].contains(&bits),
        BIT_FIELDS => has_masks && [mask(0)?, mask(1)?, mask(2)?] == MASKS,
        _ => false,
    };
    if !is_known {
        return Err(format!(
            "BMP image: unknown kind (got {bits} bits, compression {compression}); save it as PNG or PGM"
        ));
    }
    let has_alpha = has_masks && header >= 56 && mask(3)? == ALPHA_MASK;
    let stride = (bits * width).div_ceil(32) * 4;
    let start = long(10)? as usize;
    let data = start.checked_add(stride * height).and_then(|end| bytes.get(start..end)).ok_or_else(cut)?;
    let palette = palette(bytes.get(FILE_HEADER + header..).unwrap_or_default(), bits);
    let (mut pixels, mut alpha) = (Vec::with_capacity(count), Vec::new());
    for row in 0..height {
        let row = if from_top { row } else { height - 1 - row };
        let row = data.get(row * stride..(row + 1) * stride).unwrap_or_default();
        if bits <= 8 {
            let per_byte = 8 / bits;
            let indices = (0..width).map(|column| {
                let shift = 8 - bits * (column % per_byte + 1);
                usize::from(row[column / per_byte] >> shift) & ((1 << bits) - 1)
            });
            pixels.extend(indices.map(|index| palette.get(index).copied().unwrap_or(0)));
        } else {
            let of_row = || row.chunks_exact(bits / 8).take(width);
            pixels.extend(of_row().map(|pixel| gray(&pixel[..3])));
            if has_alpha {
                alpha.extend(of_row().map(|pixel| pixel[3]));
            }
        }
    }
    Ok(Image { width, height, white: COLOR_WHITE, pixels, alpha })
}

/// Returns the gray values of a palette for `bits` per pixel.
fn palette(entries: &[u8], bits: usize) -> Vec<u16> {
    if bits > 8 {
        return Vec::new();
    }
    entries.chunks_exact(4).take(1 << bits).map(|entry| gray(&entry[..3])).collect()
}

fn gray(channels: &[u8]) -> u16 {
    channels.iter().copied().map(u16::from).sum()
}
