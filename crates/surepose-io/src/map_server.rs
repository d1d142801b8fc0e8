//! Occupancy grids in the form of the ROS map server: a YAML description beside a PGM image.
//!
//! How grey becomes occupancy follows the map server of Navigation2 (`nav2_map_server`, `map_io.cpp`): a black pixel
//! is occupied with probability 1, a white one with 0 (`negate` swaps them), and `mode` says what becomes of the values
//! between. The bottom row of the image is the row at the origin.

mod document;

use std::fmt;
use std::path::{Path, PathBuf};

use document::Document;

use crate::document::{utf8, wrong};
use crate::error::DataError;
use crate::grid::{Grid, GridOrigin};
use crate::pgm::{self, Image};
use crate::quantity::{ANGLE, POSITION, PROBABILITY, Quantity, RESOLUTION, plain};
use crate::source::{MAX_DOCUMENT_BYTES, read_all};

/// What the YAML file says about the image.
#[derive(Clone, Debug, PartialEq)]
pub struct MapMetadata {
    /// The image, as written: relative to the folder of the YAML file.
    pub image: PathBuf,
    /// Side of a pixel \[m\].
    pub resolution: f64,
    /// Where the lower left corner of the image lies in the map.
    pub origin: GridOrigin,
    /// Whether white is occupied.
    pub negate: bool,
    /// A pixel above this probability is occupied.
    pub occupied_threshold: f64,
    /// A pixel below this probability is free.
    pub free_threshold: f64,
    /// What becomes of pixels between the thresholds.
    pub mode: MapMode,
}

/// How grey becomes occupancy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapMode {
    /// Free, occupied, or else unknown.
    #[default]
    Trinary,
    /// Free, occupied, or else a probability that grows from the lower threshold to the upper one.
    Scale,
    /// The grey value, of 255, is the probability in per cent; above 100 it is unknown.
    Raw,
}

/// An image that a YAML file names and that is not there, and the one that was read instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Renamed {
    /// The image that is named.
    pub named: PathBuf,
    /// The image with the name of the YAML file.
    pub read: PathBuf,
}

impl fmt::Display for Renamed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is no {}: {} is read instead", self.named.display(), self.read.display())
    }
}

/// Reads the grid that a YAML file describes.
///
/// Where the image is absent under the name the file gives, an image with the name of the YAML file itself is taken, and told: map
/// pairs are often renamed together, and then the name inside is stale.
///
/// # Errors
/// A missing, unreadable or malformed file, by name and line.
pub fn read(path: &Path) -> Result<(Grid, Option<Renamed>), DataError> {
    let (description, image, renamed) = described(path)?;
    Ok((description.grid(&pgm::read(&image)?), renamed))
}

/// The image that [`read`] takes the grid from.
///
/// # Errors
/// A missing, unreadable or malformed YAML file, by name and line.
pub fn image_of(path: &Path) -> Result<PathBuf, DataError> {
    described(path).map(|(_, image, _)| image)
}

/// What the YAML file says, the image that is there, and whether that is another one than is named.
fn described(path: &Path) -> Result<(MapMetadata, PathBuf, Option<Renamed>), DataError> {
    let description = parse(path, &read_all(path, MAX_DOCUMENT_BYTES)?)?;
    let named = path.with_file_name("").join(&description.image);
    let same = path.with_extension("pgm");
    if named.exists() || !same.exists() {
        return Ok((description, named, None));
    }
    Ok((description, same.clone(), Some(Renamed { named, read: same })))
}

/// Reads the text of a YAML file; `file` is the name that errors give it.
///
/// # Errors
/// Text that is not YAML, a key that is missing, or a value that cannot be, by line.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<MapMetadata, DataError> {
    let document = Document::read(file, utf8(file, bytes)?)?;
    let check = |name: &str, (value, line): (f64, u64), quantity: &Quantity| {
        if quantity.admits(value) {
            return Ok(value);
        }
        let message = format!("{name} is {}, outside {quantity}", plain(value));
        Err(wrong(file, Some(line), message))
    };
    let [x, y, heading] = document.numbers("origin")?;
    let free = document.number("free_thresh")?;
    let description = MapMetadata {
        image: PathBuf::from(document.required("image")?.text()),
        resolution: check("resolution", document.number("resolution")?, &RESOLUTION)?,
        origin: GridOrigin {
            x: check("origin x", x, &POSITION)?,
            y: check("origin y", y, &POSITION)?,
            heading: check("origin heading", heading, &ANGLE)?,
        },
        negate: negate_in(&document)?,
        occupied_threshold: check("occupied_thresh", document.number("occupied_thresh")?, &PROBABILITY)?,
        free_threshold: check("free_thresh", free, &PROBABILITY)?,
        mode: mode_in(&document)?,
    };
    if description.free_threshold >= description.occupied_threshold {
        return Err(wrong(file, Some(free.1), "free_thresh must be below occupied_thresh"));
    }
    Ok(description)
}

/// `negate`, written as 0 or 1, or as false or true.
fn negate_in(document: &Document<'_>) -> Result<bool, DataError> {
    let found = document.required("negate")?;
    found.truth().ok_or_else(|| document.unexpected("negate", found, "0, 1, false or true"))
}

/// `mode`, by default [`MapMode::Trinary`].
fn mode_in(document: &Document<'_>) -> Result<MapMode, DataError> {
    let Some(found) = document.scalar("mode")? else { return Ok(MapMode::default()) };
    match found.text() {
        "trinary" => Ok(MapMode::Trinary),
        "scale" => Ok(MapMode::Scale),
        "raw" => Ok(MapMode::Raw),
        _ => Err(document.unexpected("mode", found, "trinary, scale or raw")),
    }
}

impl MapMetadata {
    /// The grid that `image` shows.
    pub fn grid(&self, image: &Image) -> Grid {
        let white = f64::from(image.white);
        let rows = image.pixels.chunks_exact(image.width.max(1)).rev();
        let cells = rows.flatten().map(|&pixel| self.occupancy(f64::from(pixel) / white)).collect();
        let (resolution, origin) = (self.resolution, self.origin);
        Grid { width: image.width, height: image.height, resolution, origin, cells }
    }

    /// Occupancy of a pixel whose brightness is `shade`, from 0 to 1.
    fn occupancy(&self, shade: f64) -> Option<f32> {
        let occupied = if self.negate { shade } else { 1.0 - shade };
        match self.mode {
            MapMode::Raw => {
                let percent = (shade * 255.0).round();
                (percent <= 100.0).then_some((percent / 100.0) as f32)
            }
            _ if occupied > self.occupied_threshold => Some(1.0),
            _ if occupied < self.free_threshold => Some(0.0),
            MapMode::Trinary => None,
            MapMode::Scale => {
                let between = self.occupied_threshold - self.free_threshold;
                Some(((occupied - self.free_threshold) / between) as f32)
            }
        }
    }
}

#[cfg(test)]
mod tests;
