//! Wall maps: straight walls by their end points, in a TOML file that people read and write.
//!
//! ```toml
//! name = "arena"
//!
//! [[wall]]
//! name = "south"
//! from_m = [0.0, 0.0]
//! to_m = [6.0, 0.0]
//!
//! [[wall]]
//! from_m = [6.0, 0.0]
//! to_m = [6.0, 4.0]
//! covariance = { r_r_m2 = 1e-6, r_psi_m_rad = 0.0, psi_psi_rad2 = 1e-8 }
//! ```
//!
//! A wall is seen from both sides. Its `covariance`, where the map was measured, is that of (r, ψ) of the line through
//! its end points, x cos ψ + y sin ψ = r, with the normal ψ to the *right* of the way from `from_m` to `to_m`: the line
//! that `surepose::geometry::Line::through` gives.

use std::path::Path;

use serde::{Deserialize, Serialize};
use surepose::geometry::Point;
use surepose::map::Wall;
use toml::Spanned;

use crate::document::{line_of, utf8, wrong};
use crate::error::DataError;
use crate::quantity::{COVARIANCE, POSITION, plain};
use crate::source::{MAX_DOCUMENT_BYTES, read_all};

/// Shortest wall that is one \[m\]; below it, the direction is rounding.
const MIN_WALL_LENGTH: f64 = 1e-3;

/// Straight walls on a plane.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WallMap {
    /// What the place is called.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The walls, in the order of the file.
    #[serde(rename = "wall")]
    pub walls: Vec<MapWall>,
}

/// One straight wall.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapWall {
    /// What the wall is called.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// One end: x, y \[m\].
    #[serde(rename = "from_m")]
    pub from: [f64; 2],
    /// The other end: x, y \[m\].
    #[serde(rename = "to_m")]
    pub to: [f64; 2],
    /// How well the wall's line is known; absent for a wall that is exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariance: Option<WallCovariance>,
}

/// Covariance of a line's distance r and direction ψ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallCovariance {
    /// Variance of r \[m²\].
    #[serde(rename = "r_r_m2")]
    pub r_r: f64,
    /// Covariance of r and ψ \[m·rad\].
    #[serde(rename = "r_psi_m_rad")]
    pub r_psi: f64,
    /// Variance of ψ \[rad²\].
    #[serde(rename = "psi_psi_rad2")]
    pub psi_psi: f64,
}

impl WallMap {
    /// The text of the map, as [`parse`] reads it.
    ///
    /// # Errors
    /// A map that [`parse`] would refuse, named by its wall; `file` is the name that errors give it.
    pub fn to_toml(&self, file: &Path) -> Result<String, DataError> {
        for (index, wall) in self.walls.iter().enumerate() {
            check(wall)
                .map_err(|(_, message)| wrong(file, None, format!("wall {}: {message}", index + 1)))?;
        }
        toml::to_string(self).map_err(|error| wrong(file, None, error.to_string()))
    }
}

impl MapWall {
    /// Length of the wall \[m\].
    pub fn length(&self) -> f64 {
        (self.to[0] - self.from[0]).hypot(self.to[1] - self.from[1])
    }
}

/// The walls of a map in the core's form, each as well known as the file says; a wall that is none is left out.
pub fn walls_from_map(map: &WallMap) -> Vec<Wall<f64>> {
    let walls = map.walls.iter().filter_map(|wall| {
        let [from, to] = [wall.from, wall.to].map(|[x, y]| Point::new(x, y));
        let known = Wall::between(from, to).ok()?;
        Some(wall.covariance.map_or(known, |c| known.with_covariance([c.r_r, c.r_psi, c.psi_psi])))
    });
    walls.collect()
}

/// Reads a wall map.
///
/// # Errors
/// A missing, unreadable or malformed file, by name and line.
pub fn read(path: &Path) -> Result<WallMap, DataError> {
    parse(path, &read_all(path, MAX_DOCUMENT_BYTES)?)
}

/// Reads the text of a wall map; `file` is the name that errors give it.
///
/// # Errors
/// Text that is not TOML, a key that is missing or unknown, a wall that cannot be, by line.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<WallMap, DataError> {
    let text = utf8(file, bytes)?;
    let at = |offset: usize| Some(line_of(text.as_bytes(), offset));
    let document: Document = toml::from_str(text).map_err(|error| {
        let line = error.span().and_then(|span| at(span.start));
        wrong(file, line, error.message())
    })?;
    if document.wall.is_empty() {
        return Err(wrong(file, None, "holds no [[wall]]; is this the right file?"));
    }
    let walls = document.wall.into_iter().map(|written| {
        let place = written.span().start;
        let Written { name, from, to, covariance } = written.into_inner();
        let places = [&from, &to].map(|[x, y]| [x.span().start, y.span().start]);
        let covariance_at = covariance.as_ref().map_or(place, |covariance| covariance.span().start);
        let [from, to] = [from, to].map(|end| end.map(Spanned::into_inner));
        let wall = MapWall { name, from, to, covariance: covariance.map(Spanned::into_inner) };
        check(&wall).map(|()| wall).map_err(|(part, message)| {
            let offset = match part {
                Part::Coordinate { end, axis } => places[end][axis],
                Part::Whole => place,
                Part::Covariance => covariance_at,
            };
            wrong(file, at(offset), message)
        })
    });
    Ok(WallMap { name: document.name, walls: walls.collect::<Result<_, _>>()? })
}

/// The TOML file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    name: Option<String>,
    #[serde(default)]
    wall: Vec<Spanned<Written>>,
}

/// A wall as it is written, with the places of its values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    name: Option<String>,
    #[serde(rename = "from_m")]
    from: [Spanned<f64>; 2],
    #[serde(rename = "to_m")]
    to: [Spanned<f64>; 2],
    covariance: Option<Spanned<WallCovariance>>,
}

/// The part of a wall that is wrong.
enum Part {
    /// Of its first end or its second one, x or y.
    Coordinate {
        end: usize,
        axis: usize,
    },
    Whole,
    Covariance,
}

/// Says what is wrong with a wall, and where, if anything is.
fn check(wall: &MapWall) -> Result<(), (Part, String)> {
    for (end, (name, at)) in [("from_m", wall.from), ("to_m", wall.to)].into_iter().enumerate() {
        if let Some(axis) = at.iter().position(|&value| !POSITION.admits(value)) {
            let [x, y] = at.map(plain);
            return Err((
                Part::Coordinate { end, axis },
                format!("{name} is [{x}, {y}], outside {POSITION}"),
            ));
        }
    }
    if wall.length() < MIN_WALL_LENGTH {
        let message = format!("the wall is shorter than {MIN_WALL_LENGTH} m; its two ends must differ");
        return Err((Part::Whole, message));
    }
    let covariance = wall.covariance.as_ref().map_or(Ok(()), check_covariance);
    covariance.map_err(|message| (Part::Covariance, message))
}

fn check_covariance(covariance: &WallCovariance) -> Result<(), String> {
    let WallCovariance { r_r, r_psi, psi_psi } = *covariance;
    if ![r_r, r_psi, psi_psi].iter().all(|&value| COVARIANCE.admits(value)) {
        let [r_r, r_psi, psi_psi] = [r_r, r_psi, psi_psi].map(plain);
        return Err(format!("covariance is [{r_r}, {r_psi}, {psi_psi}], outside {COVARIANCE}"));
    }
    if r_r < 0.0 || psi_psi < 0.0 {
        let [r_r, psi_psi] = [r_r, psi_psi].map(plain);
        return Err(format!("covariance has a negative variance: r_r_m2 {r_r}, psi_psi_rad2 {psi_psi}"));
    }
    if r_psi.abs() > (r_r * psi_psi).sqrt() * (1.0 + 1e-9) {
        return Err(format!(
            "covariance is impossible: r_psi_m_rad {r_psi} exceeds √(r_r_m2 · psi_psi_rad2)"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
