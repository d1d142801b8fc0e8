//! A drawing as a list of shapes, in pixels from its upper left corner.

use crate::plot::style::{Rgb, Stroke};

/// Coordinates to the right and downward \[px].
pub(crate) type Point = (f64, f64);

/// A drawing.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// Shapes from the lowest to the topmost.
    pub(crate) shapes: Vec<Shape>,
}

/// A shape of a drawing.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// Polylines with one pen.
    Lines { lines: Vec<Vec<Point>>, pen: Pen },
    /// Filled rectangles without antialiasing; adjacent ones have no visible seam.
    Rectangles { areas: Vec<Area>, color: Rgb },
    /// A filled polygon.
    Polygon { corners: Vec<Point>, color: Rgb },
    /// Filled circles of one radius.
    Dots { centers: Vec<Point>, radius: f64, color: Rgb },
    /// A line of text.
    Text(Text),
    /// Shapes clipped to `area`.
    Clip { area: Area, shapes: Vec<Shape> },
    /// Shapes translated to the origin `at`.
    Group { at: Point, shapes: Vec<Shape> },
}

/// Color, width \[px], and style of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pen {
    pub(crate) color: Rgb,
    pub(crate) width: f64,
    pub(crate) style: PenStyle,
}

/// Line style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PenStyle {
    /// Data: round ends and joins.
    Round,
    /// Frames, ticks, and grids: horizontal and vertical lines with crisp edges.
    Crisp,
    /// Dashed lines.
    Dashed,
}

/// Lengths of a dash and of the gap after it \[px].
pub(crate) const DASHES: [f64; 2] = [5.0, 3.0];

impl Pen {
    /// Pen for data.
    pub(crate) fn round(stroke: Stroke) -> Self {
        Self { color: stroke.color.rgb(), width: stroke.width, style: PenStyle::Round }
    }

    /// Pen for frames, ticks, and grids.
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

    /// Closed outline.
    pub(crate) fn outline(&self) -> Vec<Point> {
        let (left, top, right, bottom) = (self.left, self.top, self.right(), self.bottom());
        vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]
    }
}

/// A line of text.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    /// Anchor point on the baseline.
    pub(crate) at: Point,
    pub(crate) content: String,
    /// Font size \[px].
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    /// Whether the text runs upward instead of to the right.
    pub(crate) upright: bool,
    /// Whether a background halo keeps the text legible on lines.
    pub(crate) halo: bool,
}

/// Width of the halo \[px].
pub(crate) const HALO: f64 = 2.0;

impl Text {
    pub(crate) fn new(at: Point, content: impl Into<String>, size: f64, anchor: Anchor) -> Self {
        Self { at, content: content.into(), size, anchor, upright: false, halo: false }
    }
}

/// Part of the text that lies at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}
