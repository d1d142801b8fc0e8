//! Square cells of one size, each in one colour: occupancy grids and heat maps.
//!
//! An SVG with a rectangle for each of a hundred thousand cells is of no use to anybody. Cells of one colour are merged
//! into rectangles, and those into one path for each colour.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use kuva::plot::Heatmap;
use kuva::render::color::Color as Paint;
use kuva::render::plots::Plot;
use kuva::render::render::{PathData, Primitive};

use crate::scale::Scale;
use crate::style::Color;

/// Cells over a rectangle, row by row from its lower left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiles {
    /// The lower left corner, in the units of the map.
    pub low: (f64, f64),
    /// Side of a cell, in the units of the map.
    pub side: f64,
    /// Cells in a row.
    pub columns: usize,
    /// What each cell shows.
    pub cells: Vec<Tile>,
}

/// What a cell shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tile {
    /// The paper.
    Nothing,
    /// One colour.
    Plain(Color),
    /// A value, in the shade that the map's [`Scale`] has for it.
    Value(f64),
}

/// The colour of a cell, in an order of drawing.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Shade {
    Ramp(u8),
    Plain(&'static str),
}

impl Tiles {
    /// Rows of cells.
    pub fn rows(&self) -> usize {
        self.cells.len().checked_div(self.columns).unwrap_or(0)
    }

    /// The upper right corner.
    pub fn high(&self) -> (f64, f64) {
        let (columns, rows) = (self.columns as f64, self.rows() as f64);
        (self.low.0 + columns * self.side, self.low.1 + rows * self.side)
    }

    /// One cell as large as all of them, in the place of which the library draws them: so that they come above the
    /// lines of the axes, and below what lies on them.
    pub(crate) fn stand_in(&self, scale: f64) -> Plot {
        let mut place = Heatmap::new().with_data([[0.0]]);
        let (low, high) = (self.low, self.high());
        place.x_range = Some((low.0 * scale, high.0 * scale));
        place.y_range = Some((low.1 * scale, high.1 * scale));
        place.cell_size = 1.0;
        Plot::Heatmap(place)
    }

    /// The cells in a rectangle on paper, which begins at its upper left corner (x, y) \[px].
    pub(crate) fn drawn(&self, scale: Option<&Scale>, [x, y, width, height]: [f64; 4]) -> Vec<Primitive> {
        let (wide, high) = (width / self.columns.max(1) as f64, height / self.rows().max(1) as f64);
        let mut paths: BTreeMap<Shade, String> = BTreeMap::new();
        for (shade, [left, right, below, above]) in self.merged(scale) {
            let path = paths.entry(shade).or_default();
            let (w, h) = ((right - left) as f64 * wide, (above - below) as f64 * high);
            let (px, py) = (x + left as f64 * wide, y + height - above as f64 * high);
            let [px, py, w, h] = [px, py, w, h].map(rounded);
            let _ = write!(path, "M{px} {py}h{w}v{h}h-{w}z");
        }
        // Neighbours meet without a seam where edges are drawn hard.
        let crisp = Some("shape-rendering=\"crispEdges\"".to_owned());
        let mut drawn = vec![Primitive::GroupStart { transform: None, title: None, extra_attrs: crisp }];
        for (shade, d) in paths {
            let fill = match shade {
                Shade::Ramp(shade) => Paint::from(Scale::hex(shade).as_str()),
                Shade::Plain(hex) => Paint::from(hex),
            };
            drawn.push(Primitive::Path(Box::new(PathData {
                d,
                fill: Some(fill),
                stroke: Paint::None,
                stroke_width: 0.0,
                opacity: None,
                stroke_dasharray: None,
            })));
        }
        drawn.push(Primitive::GroupEnd);
        drawn
    }

    /// The cells as rectangles of one shade each: left, right, lower and upper end, in cells.
    fn merged(&self, scale: Option<&Scale>) -> Vec<(Shade, [usize; 4])> {
        let shade = |tile: &Tile| match tile {
            Tile::Nothing => None,
            Tile::Plain(color) => Some(Shade::Plain(color.hex())),
            Tile::Value(value) => scale.and_then(|scale| scale.shade(*value)).map(Shade::Ramp),
        };
        let mut done = Vec::new();
        // Runs of the row before, which may go on in this one: where they begin and end, and their lowest row.
        let mut open: BTreeMap<(usize, usize, Shade), usize> = BTreeMap::new();
        for (row, cells) in self.cells.chunks_exact(self.columns.max(1)).enumerate() {
            let mut here = BTreeMap::new();
            let mut left = 0;
            for run in cells.chunk_by(|a, b| shade(a) == shade(b)) {
                let right = left + run.len();
                if let Some(shade) = run.first().and_then(shade) {
                    let key = (left, right, shade);
                    here.insert(key, open.remove(&key).unwrap_or(row));
                }
                left = right;
            }
            done.extend(open.into_iter().map(|((l, r, shade), below)| (shade, [l, r, below, row])));
            open = here;
        }
        let top = self.rows();
        done.extend(open.into_iter().map(|((l, r, shade), below)| (shade, [l, r, below, top])));
        done
    }
}

/// Hundredths of a pixel.
fn rounded(length: f64) -> f64 {
    (length * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::{Shade, Tile, Tiles};
    use crate::scale::Scale;
    use crate::style::Color;

    #[test]
    fn every_cell_is_in_one_rectangle_of_its_colour() {
        let (columns, rows) = (17, 11);
        // A pattern without any order, by a full cycle modulo 187.
        let tile = |k: usize| match (k * 60 + 7) % 187 % 5 {
            0 => Tile::Nothing,
            1 | 2 => Tile::Plain(Color::Grey),
            3 => Tile::Plain(Color::Vermilion),
            _ => Tile::Value(1.0),
        };
        let cells: Vec<Tile> = (0..columns * rows).map(tile).collect();
        let tiles = Tiles { low: (0.0, 0.0), side: 1.0, columns, cells: cells.clone() };
        let scale = Scale::new("", 0.0, 2.0);
        let mut painted = vec![Tile::Nothing; cells.len()];
        for (shade, [left, right, below, above]) in tiles.merged(Some(&scale)) {
            for (x, y) in (below..above).flat_map(|y| (left..right).map(move |x| (x, y))) {
                let cell = &mut painted[y * columns + x];
                assert_eq!(*cell, Tile::Nothing, "painted twice at {x}, {y}");
                *cell = match shade {
                    Shade::Ramp(_) => Tile::Value(1.0),
                    Shade::Plain(hex) if hex == Color::Grey.hex() => Tile::Plain(Color::Grey),
                    Shade::Plain(_) => Tile::Plain(Color::Vermilion),
                };
            }
        }
        assert_eq!(painted, cells);
    }

    #[test]
    fn a_large_room_is_a_few_rectangles() {
        let side = 800;
        let wall = |k: usize| [k % side, k / side].iter().any(|&at| at == 0 || at == side - 1);
        let cells = (0..side * side).map(|k| Tile::Plain(if wall(k) { Color::Black } else { Color::Silver }));
        let tiles = Tiles { low: (0.0, 0.0), side: 0.05, columns: side, cells: cells.collect() };
        assert_eq!(tiles.merged(None).len(), 5);
        assert!((tiles.high().0 - 40.0).abs() < 1e-9 && (tiles.high().1 - 40.0).abs() < 1e-9);
    }
}
