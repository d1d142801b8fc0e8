//! A drawing as a list of shapes, in pixels from its upper left corner.

use crate::plot::style::{Rgb, Stroke};

/// Pixels to the right and downwards.
pub(crate) type Point = (f64, f64);

/// A drawing.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// From the lowest to the topmost.
    pub(crate) shapes: Vec<Shape>,
}

/// What a drawing consists of.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// Polylines in one pen.
    Lines { lines: Vec<Vec<Point>>, pen: Pen },
    /// Filled rectangles without antialiasing: neighbors meet without a seam.
    Rectangles { areas: Vec<Area>, color: Rgb },
    /// A filled polygon.
    Polygon { corners: Vec<Point>, color: Rgb },
    /// Filled circles of one size.
    Dots { centers: Vec<Point>, radius: f64, color: Rgb },
    /// A line of text.
    Text(Text),
    /// Shapes that are cut off at the edges of `area`.
    Clip { area: Area, shapes: Vec<Shape> },
    /// Shapes whose upper left corner is `at`.
    Group { at: Point, shapes: Vec<Shape> },
}

/// How lines are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pen {
    pub(crate) color: Rgb,
    pub(crate) width: f64,
    pub(crate) style: PenStyle,
}

/// What lines look like along their length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PenStyle {
    /// Data: round ends and corners.
    Round,
    /// Frames, ticks and grids: horizontal and vertical lines with hard edges.
    Crisp,
    /// Dashes.
    Dashed,
}

/// Lengths of a dash and of the gap after it \[px].
pub(crate) const DASHES: [f64; 2] = [5.0, 3.0];

impl Pen {
    /// For data.
    pub(crate) fn round(stroke: Stroke) -> Self {
        Self { color: stroke.color.rgb(), width: stroke.width, style: PenStyle::Round }
    }

    /// For frames, ticks and grids.
    pub(crate) const fn crisp(color: Rgb) -> Self {
        Self { color, width: 1.0, style: PenStyle::Crisp }
    }
}

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Area {
    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn contains(&self, (x, y): Point) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }

    /// The outline, closed.
    pub(crate) fn outline(&self) -> Vec<Point> {
        let (left, top, right, bottom) = (self.left, self.top, self.right(), self.bottom());
        vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]
    }
}

/// A line of text.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    /// Where its baseline begins, has its middle or ends, by the anchor.
    pub(crate) at: Point,
    pub(crate) content: String,
    /// Size of the font \[px].
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    /// Whether it runs upwards rather than to the right.
    pub(crate) upright: bool,
    /// Whether paper surrounds its letters, so that it is legible on lines.
    pub(crate) halo: bool,
}

/// Width of the paper around letters \[px].
pub(crate) const HALO: f64 = 2.0;

impl Text {
    pub(crate) fn new(at: Point, content: impl Into<String>, size: f64, anchor: Anchor) -> Self {
        Self { at, content: content.into(), size, anchor, upright: false, halo: false }
    }
}

/// What part of a text lies at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}
