//! Map plots with equal axes: cells, walls, paths, ellipses, points, and poses.

use crate::plot::axes::{self, Axis};
use crate::plot::heatmap::Heatmap;
use crate::plot::items::{Arrow, DotPaint, Dots, Outline, Trace};
use crate::plot::legend::{self, Entry, Key};
use crate::plot::picture::{Picture, Subplot, hstack};
use crate::plot::scale::Scale;
use crate::plot::scene::{Area, Pen, Shape};
use crate::plot::style::{Color, Rgb, Stroke};

/// A map plot; coordinates in meters.
#[derive(Clone, Debug, Default)]
pub struct MapPlot {
    title: String,
    heatmap: Option<Heatmap>,
    keys: Vec<(String, Color)>,
    scale: Option<Scale>,
    dots: Vec<Dots>,
    walls: Vec<[(f64, f64); 2]>,
    traces: Vec<Trace>,
    outlines: Vec<Outline>,
    arrows: Vec<Arrow>,
    window: Option<[(f64, f64); 2]>,
    axes: Option<Axes>,
    compact: bool,
}

/// Unit, labels, and tick step of the axes.
#[derive(Clone, Copy, Debug)]
struct Axes {
    per_metre: f64,
    labels: [&'static str; 2],
    step: Option<f64>,
}

const METRES: Axes = Axes { per_metre: 1.0, labels: ["x [m]", "y [m]"], step: None };

/// Left, right, top, and bottom margins \[px].
const MARGINS: [f64; 4] = [64.0, 20.0, 40.0, 56.0];
/// Length of a pose arrow \[px].
const ARROW: f64 = 28.0;
/// Radius of a point, and of one of very many points \[px].
const DOT: f64 = 4.0;
const POINT: f64 = 1.2;
/// Number of walls above which they are drawn thinner.
const CROWDED: usize = 50;
/// Maximum side length \[px], and its value for maps with more than `FINE` cells per side.
const MAX_SIDE: f64 = 560.0;
const MAX_SIDE_FINE: f64 = 1000.0;
const FINE: usize = 280;
/// Maximum side length of a compact map \[px].
const MAX_SIDE_COMPACT: f64 = 400.0;
/// Space below the legend of a compact map \[px].
const LEGEND_FOOT: f64 = 12.0;

impl MapPlot {
    /// Creates an empty map.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Replaces the title.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Adds cells below all other layers; `keys` are legend entries for their constant colors.
    #[must_use]
    pub fn heatmap(mut self, heatmap: Heatmap, keys: impl IntoIterator<Item = (String, Color)>) -> Self {
        self.heatmap = Some(heatmap);
        self.keys.extend(keys);
        self
    }

    /// Adds a color scale and its color bar.
    #[must_use]
    pub fn scale(mut self, scale: Scale) -> Self {
        self.scale = Some(scale);
        self
    }

    /// Adds points.
    #[must_use]
    pub fn dots(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, paint: DotPaint) -> Self {
        self.dots.push(Dots { label: label.into(), points, paint, radius: DOT });
        self
    }

    /// Adds a large number of small points in one color.
    #[must_use]
    pub fn points(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, color: Color) -> Self {
        let paint = DotPaint::Plain(color);
        self.dots.push(Dots { label: label.into(), points, paint, radius: POINT });
        self
    }

    /// Adds walls, each between two points.
    #[must_use]
    pub fn walls(mut self, walls: impl IntoIterator<Item = [(f64, f64); 2]>) -> Self {
        self.walls.extend(walls);
        self
    }

    /// Adds a path.
    #[must_use]
    pub fn trace(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        self.traces.push(Trace { label: label.into(), points, stroke });
        self
    }

    /// Adds closed curves.
    #[must_use]
    pub fn outlines(
        mut self,
        label: impl Into<String>,
        curves: Vec<Vec<(f64, f64)>>,
        stroke: Stroke,
    ) -> Self {
        self.outlines.push(Outline { label: label.into(), curves, stroke });
        self
    }

    /// Adds a pose; `heading` in rad.
    #[must_use]
    pub fn pose(mut self, label: impl Into<String>, at: (f64, f64), heading: f64, color: Color) -> Self {
        self.arrows.push(Arrow { label: label.into(), at, heading, color });
        self
    }

    /// Restricts the plot to the rectangle from `low` to `high` \[m].
    #[must_use]
    pub fn window(mut self, low: (f64, f64), high: (f64, f64)) -> Self {
        self.window = Some([low, high]);
        self
    }

    /// Sets the axis unit and labels; `per_metre` units are one meter.
    #[must_use]
    pub fn axes(mut self, per_metre: f64, x_label: &'static str, y_label: &'static str) -> Self {
        self.axes = Some(Axes { per_metre, labels: [x_label, y_label], step: None });
        self
    }

    /// Sets the tick step, in axis units.
    #[must_use]
    pub fn numbered_every(mut self, step: f64) -> Self {
        self.axes = Some(Axes { step: Some(step), ..self.axes.unwrap_or(METRES) });
        self
    }

    /// Uses a smaller layout with the legend below, for a column of text.
    #[must_use]
    pub fn compact(mut self) -> Self {
        self.compact = true;
        self
    }

    /// Converts the map to a picture.
    pub fn picture(self) -> Picture {
        hstack(vec![self.cell()])
    }

    /// Converts the map to a subplot.
    pub fn cell(self) -> Subplot {
        let [low, high] = self.extent();
        let (span_x, span_y) = (high.0 - low.0, high.1 - low.1);
        let Axes { per_metre: scale, labels: [x_label, y_label], step } = self.axes.unwrap_or(METRES);
        let per_metre = self.pixels_per_metre(span_x.max(span_y));
        let [left, right, top, bottom] = MARGINS;
        let area = Area { left, top, width: span_x * per_metre, height: span_y * per_metre };
        let axis =
            |low, high, label: &str| Axis { low, high, logarithmic: false, label: label.to_owned(), step };
        let axes = axes::Axes {
            title: self.title.clone(),
            x: axis(low.0 * scale, high.0 * scale, x_label),
            y: axis(low.1 * scale, high.1 * scale, y_label),
            area,
        }
        .equally_numbered();
        let entries = self.legend();
        let bar = if self.scale.is_some() { Scale::ROOM } else { 0.0 };
        let hstack = if self.compact { 0.0 } else { legend::width(&entries) };
        let part_width = left + area.width + right + bar.max(hstack);

        let mut inside = axes.grid();
        if let Some(heatmap) = &self.heatmap {
            let (x, y) = axes.place((heatmap.low.0 * scale, heatmap.low.1 * scale));
            let (x1, y1) = axes.place((heatmap.high().0 * scale, heatmap.high().1 * scale));
            let on = Area { left: x, top: y1, width: x1 - x, height: y - y1 };
            inside.extend(heatmap.drawn(self.scale.as_ref(), on));
        }
        inside.extend(self.items(&axes, scale));
        let mut shapes = vec![Shape::Clip { area, shapes: inside }];
        shapes.extend(axes.frame(part_width));
        // Arrows near the edge may extend beyond the axes.
        for Arrow { at: (x, y), heading, color, .. } in &self.arrows {
            let from = axes.place((x * scale, y * scale));
            if area.contains(from) {
                let to = (from.0 + ARROW * heading.cos(), from.1 - ARROW * heading.sin());
                shapes.extend(legend::arrow(from, to, color.rgb()));
            }
        }
        let mut height = top + area.height + bottom;
        let mut above_bar = 0.0;
        if self.compact {
            let width = part_width - left;
            shapes.extend(legend::vstack_cells(&entries, (left, height), width));
            height += legend::height_below(&entries, width) + LEGEND_FOOT;
        } else {
            shapes.extend(legend::hstack(&entries, &area));
            // The color bar is below the legend, beside the axes.
            above_bar = if entries.is_empty() { 0.0 } else { entries.len() as f64 * legend::ROW + 12.0 };
        }
        let bar = self.scale.iter().flat_map(|scale| scale.bar(area.right(), top + above_bar, area.bottom()));
        shapes.extend(bar);
        Subplot { shapes, width: part_width, height }
    }

    /// Returns the pixels per meter for a longer side of `longest` \[m].
    ///
    /// Cells get a whole number of half pixels, so their edges lie between pixels of the PNG.
    fn pixels_per_metre(&self, longest: f64) -> f64 {
        let side = if self.compact { MAX_SIDE_COMPACT } else { MAX_SIDE };
        let Some(heatmap) = &self.heatmap else { return side / longest };
        let fine = heatmap.columns.max(heatmap.rows()) > FINE;
        let (cell, desired) = (heatmap.side, if fine { MAX_SIDE_FINE } else { side } / longest);
        let halves = (2.0 * desired * cell).round();
        if halves >= 1.0 { halves / (2.0 * cell) } else { desired }
    }

    /// Draws all layers that are clipped at the axes; `scale` axis units are one meter.
    fn items(&self, axes: &axes::Axes, scale: f64) -> Vec<Shape> {
        let line = |points: &[(f64, f64)]| axes.line(points.iter().map(|(x, y)| (x * scale, y * scale)));
        let mut shapes = Vec::new();
        let mut lines = |lines, pen| shapes.push(Shape::Lines { lines, pen });
        lines(self.walls.iter().flat_map(|wall| line(wall)).collect(), Pen::round(self.wall_stroke()));
        for Outline { curves, stroke, .. } in &self.outlines {
            lines(curves.iter().flat_map(|curve| line(curve)).collect(), Pen::round(*stroke));
        }
        for Trace { points, stroke, .. } in &self.traces {
            lines(line(points), Pen::round(*stroke));
        }
        for Dots { points, paint, radius, .. } in &self.dots {
            let places =
                |points: &[(f64, f64)]| axes.dots(points.iter().map(|(x, y)| (x * scale, y * scale)));
            let mut dots = |centers, color| shapes.push(Shape::Dots { centers, radius: *radius, color });
            match (paint, &self.scale) {
                (DotPaint::Plain(color), _) => dots(places(points), color.rgb()),
                (DotPaint::Values(values), Some(scale)) => {
                    let color = |value| scale.shade(value).map_or(Color::Silver.rgb(), Scale::color);
                    for (point, value) in points.iter().zip(values) {
                        dots(places(&[*point]), color(*value));
                    }
                }
                (DotPaint::Values(_), None) => dots(places(points), Rgb::INK),
            }
        }
        shapes
    }

    /// Walls need contrast on cells, and many walls need thin lines.
    fn wall_stroke(&self) -> Stroke {
        match self.walls.len() {
            CROWDED.. if self.heatmap.is_some() => Stroke::thin(Color::Vermilion),
            _ if self.heatmap.is_some() => Stroke::solid(Color::Vermilion),
            CROWDED.. => Stroke::solid(Color::Grey),
            _ => Stroke::wide(Color::Grey),
        }
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = Vec::new();
        let mut add = |label: &str, key| legend::add(&mut entries, label, key);
        for (label, color) in &self.keys {
            add(label, Key::Subplot(color.rgb()));
        }
        if !self.walls.is_empty() {
            add("walls", Key::Line(Pen::round(self.wall_stroke())));
        }
        for Outline { label, stroke, .. } in &self.outlines {
            add(label, Key::Line(Pen::round(*stroke)));
        }
        for Trace { label, stroke, .. } in &self.traces {
            add(label, Key::Line(Pen::round(*stroke)));
        }
        for Dots { label, paint, radius, .. } in &self.dots {
            let color = match paint {
                DotPaint::Plain(color) => color.rgb(),
                DotPaint::Values(_) => Rgb::INK,
            };
            add(label, Key::Dot(color, *radius));
        }
        for Arrow { label, color, .. } in &self.arrows {
            add(label, Key::Arrow(color.rgb()));
        }
        entries
    }

    /// The window, the cells, or the bounding box of all layers with a margin.
    fn extent(&self) -> [(f64, f64); 2] {
        if let Some(window) = self.window {
            return window;
        }
        let walls = self.walls.iter().flatten();
        let traces = self.traces.iter().flat_map(|trace| &trace.points);
        let outlines = self.outlines.iter().flat_map(|outline| outline.curves.iter().flatten());
        let arrows = self.arrows.iter().map(|arrow| &arrow.at);
        let dots = self.dots.iter().flat_map(|dots| &dots.points);
        if let Some(heatmap) = &self.heatmap {
            return [heatmap.low, heatmap.high()];
        }
        let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for (x, y) in walls
            .chain(traces)
            .chain(outlines)
            .chain(arrows)
            .chain(dots)
            .filter(|p| p.0.is_finite() && p.1.is_finite())
        {
            low = (low.0.min(*x), low.1.min(*y));
            high = (high.0.max(*x), high.1.max(*y));
        }
        if low.0 > high.0 {
            return [(0.0, 0.0), (1.0, 1.0)];
        }
        let longest = (high.0 - low.0).max(high.1 - low.1).max(1e-3);
        // Margin for the arrows, whose length on the page does not depend on the map scale.
        let margin = if self.arrows.is_empty() { 0.05 } else { 0.08 } * longest;
        // A minimum height keeps space for the labels of a nearly straight map.
        let grown = |low: f64, high: f64| {
            let half = (0.5 * (high - low) + margin).max(0.2 * longest);
            (0.5 * (low + high) - half, 0.5 * (low + high) + half)
        };
        let ((x0, x1), (y0, y1)) = (grown(low.0, high.0), grown(low.1, high.1));
        [(x0, y0), (x1, y1)]
    }
}
