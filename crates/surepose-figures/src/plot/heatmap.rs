//! Heat maps and occupancy grids: square cells of one size.
//!
//! One SVG rectangle per cell is impractical for a hundred thousand cells. Cells of one color are merged into
//! rectangles, and the rectangles of one color into one path.

use std::collections::BTreeMap;

use crate::plot::scale::Scale;
use crate::plot::scene::{Area, Shape};
use crate::plot::style::{Color, Rgb};

/// Cells over a rectangle, row by row from the lower left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Heatmap {
    /// Lower left corner, in map units.
    pub low: (f64, f64),
    /// Side length of a cell, in map units.
    pub side: f64,
    /// Number of cells per row.
    pub columns: usize,
    /// Contents of the cells.
    pub cells: Vec<HeatmapCell>,
}

/// Content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeatmapCell {
    /// Background.
    Nothing,
    /// Constant color.
    Plain(Color),
    /// Value, drawn in the shade of the map's [`Scale`].
    Value(f64),
}

impl Heatmap {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.cells.len().checked_div(self.columns).unwrap_or(0)
    }

    /// Upper right corner, in map units.
    pub fn high(&self) -> (f64, f64) {
        let (columns, rows) = (self.columns as f64, self.rows() as f64);
        (self.low.0 + columns * self.side, self.low.1 + rows * self.side)
    }

    /// Draws the cells on the area `on`.
    pub(crate) fn drawn(&self, scale: Option<&Scale>, on: Area) -> Vec<Shape> {
        let (wide, high) = (on.width / self.columns.max(1) as f64, on.height / self.rows().max(1) as f64);
        let mut colors: BTreeMap<Rgb, Vec<Area>> = BTreeMap::new();
        for (color, [left, right, vstack_cells, above]) in self.merged(scale) {
            colors.entry(color).or_default().push(Area {
                left: on.left + left as f64 * wide,
                top: on.bottom() - above as f64 * high,
                width: (right - left) as f64 * wide,
                height: (above - vstack_cells) as f64 * high,
            });
        }
        colors.into_iter().map(|(color, areas)| Shape::Rectangles { areas, color }).collect()
    }

    /// Merges cells into rectangles of one color: left, right, lower, and upper end, in cells.
    fn merged(&self, scale: Option<&Scale>) -> Vec<(Rgb, [usize; 4])> {
        let color = |tile: &HeatmapCell| match tile {
            HeatmapCell::Nothing => None,
            HeatmapCell::Plain(color) => Some(color.rgb()),
            HeatmapCell::Value(value) => scale.and_then(|scale| scale.shade(*value)).map(Scale::color),
        };
        let mut done = Vec::new();
        // Runs of the previous row that may continue: their start, end, and color, and their lowest row.
        let mut open: BTreeMap<(usize, usize, Rgb), usize> = BTreeMap::new();
        for (row, cells) in self.cells.chunks_exact(self.columns.max(1)).enumerate() {
            let mut here = BTreeMap::new();
            let mut left = 0;
            for run in cells.chunk_by(|a, b| color(a) == color(b)) {
                let right = left + run.len();
                if let Some(color) = run.first().and_then(color) {
                    let key = (left, right, color);
                    here.insert(key, open.remove(&key).unwrap_or(row));
                }
                left = right;
            }
            done.extend(
                open.into_iter().map(|((l, r, color), vstack_cells)| (color, [l, r, vstack_cells, row])),
            );
            open = here;
        }
        let top = self.rows();
        done.extend(open.into_iter().map(|((l, r, color), vstack_cells)| (color, [l, r, vstack_cells, top])));
        done
    }
}

#[cfg(test)]
mod tests {
    use crate::plot::scale::Scale;
    use crate::plot::style::Color;

    use super::{Heatmap, HeatmapCell};

    #[test]
    fn merged_rectangles_cover_each_cell_once() {
        let (columns, rows) = (17, 11);
        // Pseudorandom pattern: a full cycle modulo 187.
        let tile = |k: usize| match (k * 60 + 7) % 187 % 5 {
            0 => HeatmapCell::Nothing,
            1 | 2 => HeatmapCell::Plain(Color::Grey),
            3 => HeatmapCell::Plain(Color::Vermilion),
            _ => HeatmapCell::Value(1.0),
        };
        let cells: Vec<HeatmapCell> = (0..columns * rows).map(tile).collect();
        let heatmap = Heatmap { low: (0.0, 0.0), side: 1.0, columns, cells: cells.clone() };
        let scale = Scale::new("", 0.0, 2.0);
        let mut painted = vec![HeatmapCell::Nothing; cells.len()];
        for (color, [left, right, vstack_cells, above]) in heatmap.merged(Some(&scale)) {
            for (x, y) in (vstack_cells..above).flat_map(|y| (left..right).map(move |x| (x, y))) {
                let cell = &mut painted[y * columns + x];
                assert_eq!(*cell, HeatmapCell::Nothing, "painted twice at {x}, {y}");
                *cell = match color {
                    _ if color == Color::Grey.rgb() => HeatmapCell::Plain(Color::Grey),
                    _ if color == Color::Vermilion.rgb() => HeatmapCell::Plain(Color::Vermilion),
                    _ => HeatmapCell::Value(1.0),
                };
            }
        }
        assert_eq!(painted, cells);
    }

    #[test]
    fn large_room_merges_into_five_rectangles() {
        let side = 800;
        let wall = |k: usize| [k % side, k / side].iter().any(|&at| at == 0 || at == side - 1);
        let cells =
            (0..side * side).map(|k| HeatmapCell::Plain(if wall(k) { Color::Black } else { Color::Silver }));
        let heatmap = Heatmap { low: (0.0, 0.0), side: 0.05, columns: side, cells: cells.collect() };
        assert_eq!(heatmap.merged(None).len(), 5);
        assert!((heatmap.high().0 - 40.0).abs() < 1e-9 && (heatmap.high().1 - 40.0).abs() < 1e-9);
    }
}
