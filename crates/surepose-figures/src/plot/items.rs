//! What lies on a map.

use crate::plot::style::{Color, Stroke};

/// Places of one kind.
#[derive(Clone, Debug)]
pub struct Dots {
    /// What the legend calls them.
    pub label: String,
    /// The places.
    pub points: Vec<(f64, f64)>,
    /// What they are drawn in.
    pub paint: DotPaint,
    /// Radius \[px].
    pub radius: f64,
}

/// What dots are drawn in.
#[derive(Clone, Debug)]
pub enum DotPaint {
    /// One colour.
    Plain(Color),
    /// The shade of a value for each, by the map's [`Scale`].
    Values(Vec<f64>),
}

/// A way.
#[derive(Clone, Debug)]
pub struct Trace {
    /// What the legend calls it.
    pub label: String,
    /// Its points.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// Closed curves of one kind.
#[derive(Clone, Debug)]
pub struct Outline {
    /// What the legend calls them.
    pub label: String,
    /// The points of each.
    pub curves: Vec<Vec<(f64, f64)>>,
    /// How they are drawn.
    pub stroke: Stroke,
}

/// A pose, as an arrow from its position along its heading.
#[derive(Clone, Debug)]
pub struct Arrow {
    /// What the legend calls it.
    pub label: String,
    /// Position.
    pub at: (f64, f64),
    /// Heading \[rad].
    pub heading: f64,
    /// Its colour.
    pub color: Color,
}
