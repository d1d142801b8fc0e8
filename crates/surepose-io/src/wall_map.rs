//! Reads and writes wall maps: TOML files with straight walls, given by their end points.
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
//! A wall is visible from both sides. The optional `covariance` of a measured wall is that of (r, ψ), the parameters of
//! the line x cos ψ + y sin ψ = r through both end points. The normal ψ points to the *right* of the direction from
//! `from_m` to `to_m`, as in `surepose::Line::through`.

use std::path::Path;

use serde::{Deserialize, Serialize};
use surepose::geometry::Point;
use surepose::map::Wall;
use toml::Spanned;

use crate::document::{line_of, utf8, wrong};
use crate::error::DataError;
use crate::quantity::{COVARIANCE, POSITION, plain};
use crate::source::{MAX_DOCUMENT_BYTES, read_all};

/// Minimum length of a wall \[m\]; the direction of a shorter wall is rounding noise.
const MIN_WALL_LENGTH: f64 = 1e-3;

/// Straight walls in a plane.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WallMap {
    /// The name of the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The walls, in the order of the file.
    #[serde(rename = "wall")]
    pub walls: Vec<MapWall>,
}

/// One straight wall.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapWall {
    /// The name of the wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// First end point: x, y \[m\].
    #[serde(rename = "from_m")]
    pub from: [f64; 2],
    /// Second end point: x, y \[m\].
    #[serde(rename = "to_m")]
    pub to: [f64; 2],
    /// Covariance of the line through the wall; `None` for an exact wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariance: Option<WallCovariance>,
}

/// Covariance of the distance r and the direction ψ of a line.
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
    /// Formats the map as TOML that [`parse`] reads.
    ///
    /// # Errors
    /// A wall that [`parse`] would reject, with its number; `file` is the file name in the error.
    pub fn to_toml(&self, file: &Path) -> Result<String, DataError> {
        for (index, wall) in self.walls.iter().enumerate() {
            check(wall)
                .map_err(|(_, message)| wrong(file, None, format!("wall {}: {message}", index + 1)))?;
        }
        toml::to_string(self).map_err(|error| wrong(file, None, error.to_string()))
    }
}

impl MapWall {
    /// Returns the length of the wall \[m\].
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
/// A missing, unreadable or malformed file, with name and line.
pub fn read(path: &Path) -> Result<WallMap, DataError> {
    parse(path, &read_all(path, MAX_DOCUMENT_BYTES)?)
}

/// Parses the text of a wall map; `file` is the file name in errors.
///
/// # Errors
/// Invalid TOML, a missing or unknown key, or an invalid wall, with its line.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<WallMap, DataError> {
    let text = utf8(file, bytes)?;
    let at = |offset: usize| Some(line_of(text.as_bytes(), offset));
    let document: Document = toml::from_str(text).map_err(|error| {
        let line = error.span().and_then(|span| at(span.start));
        wrong(file, line, error.message())
    })?;
    if document.wall.is_empty() {
        return Err(wrong(file, None, "no [[wall]] found; check that this is the right file"));
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

/// The content of the TOML file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    name: Option<String>,
    #[serde(default)]
    wall: Vec<Spanned<Written>>,
}

/// A wall in the TOML file, with the positions of its values.
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

/// The invalid part of a wall.
enum Part {
    /// A coordinate of an end point: index of the end, index of the axis.
    Coordinate {
        end: usize,
        axis: usize,
    },
    Whole,
    Covariance,
}

/// Checks a wall; an error names the invalid part and the problem.
fn check(wall: &MapWall) -> Result<(), (Part, String)> {
    for (end, (name, at)) in [("from_m", wall.from), ("to_m", wall.to)].into_iter().enumerate() {
        if let Some(axis) = at.iter().position(|&value| !POSITION.admits(value)) {
            let [x, y] = at.map(plain);
            return Err((
                Part::Coordinate { end, axis },
                format!("{name}: out of range (got [{x}, {y}], expected {POSITION})"),
            ));
        }
    }
    if wall.length() < MIN_WALL_LENGTH {
        let message = format!("wall: shorter than {MIN_WALL_LENGTH} m; check that its end points differ");
        return Err((Part::Whole, message));
    }
    let covariance = wall.covariance.as_ref().map_or(Ok(()), check_covariance);
    covariance.map_err(|message| (Part::Covariance, message))
}

fn check_covariance(covariance: &WallCovariance) -> Result<(), String> {
    let WallCovariance { r_r, r_psi, psi_psi } = *covariance;
    if ![r_r, r_psi, psi_psi].iter().all(|&value| COVARIANCE.admits(value)) {
        let [r_r, r_psi, psi_psi] = [r_r, r_psi, psi_psi].map(plain);
        return Err(format!(
            "covariance: out of range (got [{r_r}, {r_psi}, {psi_psi}], expected {COVARIANCE})"
        ));
    }
    if r_r < 0.0 || psi_psi < 0.0 {
        let [r_r, psi_psi] = [r_r, psi_psi].map(plain);
        return Err(format!("covariance: negative variance (got r_r_m2 {r_r}, psi_psi_rad2 {psi_psi})"));
    }
    if r_psi.abs() > (r_r * psi_psi).sqrt() * (1.0 + 1e-9) {
        return Err(format!(
            "covariance: not positive semi-definite; r_psi_m_rad {r_psi} exceeds √(r_r_m2 · psi_psi_rad2)"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
