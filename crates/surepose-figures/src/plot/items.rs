//! Map layers.

use crate::plot::style::{Color, Stroke};

/// A set of points.
#[derive(Clone, Debug)]
pub struct Dots {
    /// Legend label; empty: no entry.
    pub label: String,
    /// Positions.
    pub points: Vec<(f64, f64)>,
    /// Color or values.
    pub paint: DotPaint,
    /// Radius \[px].
    pub radius: f64,
}

/// Color of points.
#[derive(Clone, Debug)]
pub enum DotPaint {
    /// One color.
    Plain(Color),
    /// One value per point, drawn in the shade of the map's [`Scale`].
    Values(Vec<f64>),
}

/// A path.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Legend label; empty: no entry.
    pub label: String,
    /// Points of the polyline.
    pub points: Vec<(f64, f64)>,
    /// Line style.
    pub stroke: Stroke,
}

/// A set of closed curves.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Legend label; empty: no entry.
    pub label: String,
    /// Points of each curve.
    pub curves: Vec<Vec<(f64, f64)>>,
    /// Line style.
    pub stroke: Stroke,
}

/// A pose, drawn as an arrow along its heading.
#[derive(Clone, Debug)]
pub struct Arrow {
    /// Legend label; empty: no entry.
    pub label: String,
    /// Position.
    pub at: (f64, f64),
    /// Heading \[rad].
    pub heading: f64,
    /// Color.
    pub color: Color,
}
