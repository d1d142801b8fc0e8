//! Legends.

use crate::plot::font;
use crate::plot::scene::{Anchor, Area, Pen, Point, Shape, Text};
use crate::plot::style::Rgb;

/// An entry of a legend.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) label: String,
    pub(crate) key: Key,
}

/// Symbol of an entry.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Key {
    Line(Pen),
    Subplot(Rgb),
    Dot(Rgb, f64),
    Arrow(Rgb),
}

/// Font size, row height, width of a symbol, and width of a symbol with its gap \[px].
const TEXT: f64 = 12.0;
pub(crate) const ROW: f64 = 18.0;
const KEY: f64 = 22.0;
const KEY_ROOM: f64 = 30.0;
/// Gap between the axes and the legend, and after each column \[px].
const GAP: f64 = 14.0;

/// Adds an entry unless its label is empty.
pub(crate) fn add(entries: &mut Vec<Entry>, label: &str, key: Key) {
    if !label.is_empty() {
        entries.push(Entry { label: label.to_owned(), key });
    }
}

/// Returns the width of a legend to the right of the axes \[px].
pub(crate) fn width(entries: &[Entry]) -> f64 {
    if entries.is_empty() { 0.0 } else { GAP + column_width(entries) }
}

/// Draws a legend to the right of the axes, at most as high as they are.
pub(crate) fn hstack(entries: &[Entry], axes: &Area) -> Vec<Shape> {
    let row = ROW.min(axes.height / entries.len().max(1) as f64);
    column(entries, (axes.right() + GAP, axes.top), row)
}

/// Returns the height of a multi-column legend of the given width \[px].
pub(crate) fn height_below(entries: &[Entry], width: f64) -> f64 {
    rows(entries, width) as f64 * ROW
}

/// Draws a multi-column legend of the given width \[px].
pub(crate) fn vstack_cells(entries: &[Entry], (left, top): Point, width: f64) -> Vec<Shape> {
    let columns = entries.chunks(rows(entries, width).max(1));
    let mut left = left;
    let mut shapes = Vec::new();
    for entries in columns {
        shapes.extend(column(entries, (left, top), ROW));
        left += column_width(entries);
    }
    shapes
}

/// Smallest number of rows whose columns fit.
fn rows(entries: &[Entry], width: f64) -> usize {
    let fits = |rows: &usize| entries.chunks(*rows).map(column_width).sum::<f64>() <= width;
    // At most three columns, for legibility.
    (entries.len().div_ceil(3)..=entries.len()).filter(|rows| *rows > 0).find(fits).unwrap_or(entries.len())
}

fn column_width(entries: &[Entry]) -> f64 {
    let widest = entries.iter().map(|entry| font::width(&entry.label, TEXT)).fold(0.0, f64::max);
    KEY_ROOM + widest + GAP
}

fn column(entries: &[Entry], (left, top): Point, row: f64) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (i, Entry { label, key }) in entries.iter().enumerate() {
        let y = top + (i as f64 + 0.5) * row;
        let (middle, right) = (left + 0.5 * KEY, left + KEY);
        match *key {
            Key::Line(pen) => shapes.push(Shape::Lines { lines: vec![vec![(left, y), (right, y)]], pen }),
            Key::Subplot(color) => {
                let area = Area { left: middle - 6.0, top: y - 6.0, width: 12.0, height: 12.0 };
                shapes.push(Shape::Rectangles { areas: vec![area], color });
            }
            Key::Dot(color, radius) => {
                let radius = radius.clamp(2.5, 5.0);
                shapes.push(Shape::Dots { centers: vec![(middle, y)], radius, color });
            }
            Key::Arrow(color) => shapes.extend(arrow((left, y), (right, y), color)),
        }
        shapes.push(Shape::Text(Text::new((left + KEY_ROOM, y + 4.3), label.as_str(), TEXT, Anchor::Start)));
    }
    shapes
}

/// Draws an arrow between two points.
pub(crate) fn arrow(from: Point, to: Point, color: Rgb) -> [Shape; 2] {
    const HEAD: (f64, f64) = (10.0, 5.0);
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy).max(1e-9);
    let (ux, uy) = (dx / length, dy / length);
    let neck = (to.0 - HEAD.0 * ux, to.1 - HEAD.0 * uy);
    let side = |half: f64| (neck.0 - half * uy, neck.1 + half * ux);
    let pen = Pen { width: 2.4, ..Pen::crisp(color) };
    let shaft = Pen { style: crate::plot::scene::PenStyle::Round, ..pen };
    [
        Shape::Lines { lines: vec![vec![from, neck]], pen: shaft },
        Shape::Polygon { corners: vec![to, side(HEAD.1), side(-HEAD.1)], color },
    ]
}
