//! Parses portable graymap images: binary (`P5`) and plain (`P2`).

use std::path::Path;

use crate::document::line_of;
use crate::error::{DataError, Problem, excerpt};
use crate::grid::MAX_CELLS;

use super::raster::{Image, pixel_count};

/// Parses an image in memory; `file` is the file name in errors.
///
/// Memory use is below four times the length of `bytes`, whatever size the header declares.
pub(super) fn parse(file: &Path, bytes: &[u8]) -> Result<Image, DataError> {
    let mut words = Words { file, bytes, at: 0 };
    let magic = words.next();
    if magic != b"P5" && magic != b"P2" {
        let found = excerpt(magic);
        return Err(words.error(Problem::UnknownRecord { found, expected: "a PGM image: P5 or P2" }));
    }
    let width = words.number("width", MAX_CELLS)?;
    let height = words.number("height", MAX_CELLS)?;
    let white = words.number("white value", usize::from(u16::MAX))?;
    if white == 0 {
        return Err(words.wrong("white value: 0 is not allowed"));
    }
    let count = pixel_count(width, height).map_err(|problem| words.wrong(problem))?;
    let white = u16::try_from(white).unwrap_or(u16::MAX);
    let pixels = if magic == b"P5" { words.binary(count, white)? } else { words.plain(count, white)? };
    Ok(Image { width, height, white, pixels, alpha: Vec::new() })
}

/// Splits an image file into words; `#` starts a comment up to the end of the line.
struct Words<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// Returns the next word; empty at the end of the file.
    fn next(&mut self) -> &'a [u8] {
        let mut comment = false;
        while let Some(&byte) = self.bytes.get(self.at) {
            comment = byte == b'#' || (comment && byte != b'\n');
            if !comment && !byte.is_ascii_whitespace() {
                break;
            }
            self.at += 1;
        }
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let length = rest.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'#');
        let (word, _) = rest.split_at(length.unwrap_or(rest.len()));
        self.at += word.len();
        word
    }

    fn number(&mut self, name: &'static str, most: usize) -> Result<usize, DataError> {
        let word = self.next();
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse::<usize>().ok());
        number.filter(|&number| number <= most).ok_or_else(|| {
            self.wrong(format!("{name}: invalid (got '{}', expected an integer up to {most})", excerpt(word)))
        })
    }

    /// Reads pixels as bytes, or as big-endian byte pairs if white is above 255, after one whitespace character.
    fn binary(&self, count: usize, white: u16) -> Result<Vec<u16>, DataError> {
        let data = self.bytes.get(self.at + 1..).unwrap_or_default();
        let wide = white > 255;
        let pixels: Vec<u16> = if wide {
            data.chunks_exact(2).take(count).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect()
        } else {
            data.iter().take(count).copied().map(u16::from).collect()
        };
        if pixels.len() < count {
            return Err(DataError::in_file(self.file, too_few(count, pixels.len())));
        }
        match pixels.iter().find(|&&pixel| pixel > white) {
            Some(pixel) => Err(DataError::in_file(self.file, too_white(*pixel, white))),
            None => Ok(pixels),
        }
    }

    /// Reads pixels as decimal numbers.
    fn plain(&mut self, count: usize, white: u16) -> Result<Vec<u16>, DataError> {
        let mut pixels = Vec::new();
        while pixels.len() < count {
            let word = self.next();
            if word.is_empty() {
                return Err(self.error(too_few(count, pixels.len())));
            }
            let pixel = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            let pixel = pixel
                .ok_or_else(|| self.wrong(format!("pixel: not a gray value (got '{}')", excerpt(word))))?;
            if pixel > white {
                return Err(self.error(too_white(pixel, white)));
            }
            pixels.push(pixel);
        }
        Ok(pixels)
    }

    fn wrong(&self, message: impl Into<String>) -> DataError {
        self.error(Problem::Document { message: message.into() })
    }

    fn error(&self, problem: Problem) -> DataError {
        DataError::at_line(self.file, line_of(self.bytes, self.at), problem)
    }
}

fn too_few(declared: usize, found: usize) -> Problem {
    Problem::Count { what: "pixels", declared: declared as u64, found: found as u64 }
}

fn too_white(pixel: u16, white: u16) -> Problem {
    Problem::Document { message: format!("pixel: above white (got {pixel}, expected at most {white})") }
}

#[cfg(test)]
mod tests;
