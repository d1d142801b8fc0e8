//! Reads occupancy grids of the ROS map server: a YAML file and an image.
//!
//! The conversion of gray values follows the map server of Navigation2 (`nav2_map_server`, `map_io.cpp`). A black pixel
//! has occupancy probability 1, a white one 0; `negate` swaps them. `mode` selects the treatment of values in between.
//! In the mode `trinary`, transparency counts as a fourth channel; in the mode `scale`, pixels that are not opaque are
//! unknown. The bottom row of the image is the row at the origin.

mod document;

use std::fmt;
use std::path::{Path, PathBuf};

use document::Document;

use crate::document::{utf8, wrong};
use crate::error::DataError;
use crate::grid::{Grid, GridOrigin};
use crate::image::{self, Image};
use crate::quantity::{ANGLE, POSITION, PROBABILITY, Quantity, RESOLUTION, plain};
use crate::source::{MAX_DOCUMENT_BYTES, read_all};

/// The content of the YAML file.
#[derive(Clone, Debug, PartialEq)]
pub struct MapMetadata {
    /// The image path as written, relative to the directory of the YAML file.
    pub image: PathBuf,
    /// Edge length of a pixel \[m\].
    pub resolution: f64,
    /// Pose in the map of the lower left corner of the image.
    pub origin: GridOrigin,
    /// Whether white means occupied.
    pub negate: bool,
    /// Probability above which a pixel is occupied.
    pub occupied_threshold: f64,
    /// Probability below which a pixel is free.
    pub free_threshold: f64,
    /// Treatment of pixels between the thresholds.
    pub mode: MapMode,
}

/// The conversion from gray value to occupancy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapMode {
    /// Between the thresholds: unknown.
    #[default]
    Trinary,
    /// Between the thresholds: a probability that increases linearly from 0 to 1.
    Scale,
    /// The gray value, scaled to 255, is the probability in percent; above 100 it is unknown.
    Raw,
}

/// The substitution of an image that the YAML file names but that is absent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Renamed {
    /// The absent image.
    pub named: PathBuf,
    /// The image beside the YAML file that is read instead.
    pub read: PathBuf,
}

impl fmt::Display for Renamed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "image: not found (got {}); reading {} instead", self.named.display(), self.read.display())
    }
}

/// Reads the grid of a YAML file.
///
/// If the named image is absent, an image beside the YAML file is read and the substitution returned: the one with the same
/// file name, because maps are copied without editing an absolute path, or else the one with the name of the YAML file,
/// because both files are renamed together.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line.
pub fn read(path: &Path) -> Result<(Grid, Option<Renamed>), DataError> {
    let (description, image, renamed) = described(path)?;
    Ok((description.grid(&image::read(&image)?), renamed))
}

/// Returns the path of the image that [`read`] reads.
///
/// # Errors
/// A missing, unreadable or malformed YAML file, with name and line; an image that is nowhere.
pub fn image_of(path: &Path) -> Result<PathBuf, DataError> {
    described(path).map(|(_, image, _)| image)
}

/// Returns the content of the YAML file, the image path, and the substitution if there is one.
fn described(path: &Path) -> Result<(MapMetadata, PathBuf, Option<Renamed>), DataError> {
    let description = parse(path, &read_all(path, MAX_DOCUMENT_BYTES)?)?;
    let named = path.with_file_name("").join(&description.image);
    if named.exists() {
        return Ok((description, named, None));
    }
    // A path may come from another operating system.
    let written = description.image.to_string_lossy();
    let file_name = written.rsplit(['/', '\\']).next().unwrap_or_default();
    let beside = path.with_file_name(file_name);
    let of_same_name = IMAGE_EXTENSIONS.iter().map(|extension| path.with_extension(extension));
    match std::iter::once(beside.clone()).chain(of_same_name).find(|image| image.is_file()) {
        Some(read) => Ok((description, read.clone(), Some(Renamed { named, read }))),
        None if beside == named => {
            let message =
                format!("image: not found (got {}); copy it there, or correct the path", named.display());
            Err(wrong(path, None, message))
        }
        None => {
            let (named, beside) = (named.display(), beside.display());
            let message =
                format!("image: not found (got {named}, and no {beside}); copy it beside this file");
            Err(wrong(path, None, message))
        }
    }
}

/// Extensions of the images that are looked for under the name of the YAML file.
const IMAGE_EXTENSIONS: [&str; 3] = ["pgm", "png", "bmp"];

/// Parses the text of a YAML file; `file` is the file name in errors.
///
/// # Errors
/// Invalid YAML, a missing key or an invalid value, with the line.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<MapMetadata, DataError> {
    let document = Document::read(file, utf8(file, bytes)?)?;
    let check = |name: &str, (value, line): (f64, u64), quantity: &Quantity| {
        if quantity.admits(value) {
            return Ok(value);
        }
        let message = format!("{name}: out of range (got {}, expected {quantity})", plain(value));
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
        return Err(wrong(file, Some(free.1), "free_thresh: must be below occupied_thresh"));
    }
    Ok(description)
}

/// Reads `negate`, written as 0, 1, false or true.
fn negate_in(document: &Document<'_>) -> Result<bool, DataError> {
    let found = document.required("negate")?;
    found.truth().ok_or_else(|| document.unexpected("negate", found, "0, 1, false or true"))
}

/// Reads `mode`; the default is [`MapMode::Trinary`].
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
    /// Converts `image` to a grid.
    pub fn grid(&self, image: &Image) -> Grid {
        let white = f64::from(image.white);
        let rows = (0..image.height).rev();
        let of_row = |row: usize| row * image.width..(row + 1) * image.width;
        let cells = rows.flat_map(of_row).map(|index| {
            let shade = f64::from(image.pixels.get(index).copied().unwrap_or_default()) / white;
            self.occupancy(shade, image.alpha.get(index).map(|&alpha| f64::from(alpha) / 255.0))
        });
        let (resolution, origin) = (self.resolution, self.origin);
        Grid { width: image.width, height: image.height, resolution, origin, cells: cells.collect() }
    }

    /// Converts the brightness of a pixel, from 0 to 1, and its opacity to occupancy; `None` if unknown.
    ///
    /// The opacity is `None` in an image without an alpha channel.
    fn occupancy(&self, shade: f64, opacity: Option<f64>) -> Option<f32> {
        let shade = match opacity {
            Some(opacity) if self.mode == MapMode::Trinary => 0.75 * shade + 0.25 * opacity,
            _ => shade,
        };
        let occupied = if self.negate { shade } else { 1.0 - shade };
        match self.mode {
            MapMode::Raw => {
                let percent = (shade * 255.0).round();
                (percent <= 100.0).then_some((percent / 100.0) as f32)
            }
            MapMode::Scale if opacity.is_some_and(|opacity| opacity < 1.0) => None,
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
