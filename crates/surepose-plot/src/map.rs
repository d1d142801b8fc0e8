//! A map from above: walls, ways, ellipses and poses, one metre as long upwards as sideways.

use kuva::plot::legend::LegendPosition;
use kuva::plot::{LinePlot, QuiverPlot, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use crate::picture::{Cell, Picture, beside};
use crate::style::{Color, Stroke};

/// A map to be drawn \[m].
#[derive(Clone, Debug, Default)]
pub struct Map {
    title: String,
    walls: Vec<[(f64, f64); 2]>,
    clouds: Vec<Cloud>,
    traces: Vec<Trace>,
    outlines: Vec<Outline>,
    arrows: Vec<Arrow>,
    window: Option<[(f64, f64); 2]>,
    axes: Option<Axes>,
}

/// What the axes of a map say.
#[derive(Clone, Copy, Debug)]
struct Axes {
    per_metre: f64,
    labels: [&'static str; 2],
}

const METRES: Axes = Axes { per_metre: 1.0, labels: ["x [m]", "y [m]"] };

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

/// Points that hang together by nothing: ends of beams, cells of a grid.
#[derive(Clone, Debug)]
pub struct Cloud {
    /// What the legend calls them.
    pub label: String,
    /// Where they are.
    pub points: Vec<(f64, f64)>,
    /// Their colour.
    pub color: Color,
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

/// Left, right, upper and lower margins of a map's axes \[px].
const MARGINS: [f64; 4] = [64.0, 20.0, 40.0, 56.0];
/// Width of the legend \[px].
const LEGEND: f64 = 196.0;
/// The radius of a point \[px].
const POINT: f64 = 1.2;
/// More walls than this are a building.
const CROWDED: usize = 50;
/// The longest side of a map \[px].
const LONGEST: f64 = 560.0;

impl Map {
    /// An empty map.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// With walls.
    #[must_use]
    pub fn walls(mut self, walls: impl IntoIterator<Item = [(f64, f64); 2]>) -> Self {
        self.walls.extend(walls);
        self
    }

    /// With points.
    #[must_use]
    pub fn points(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, color: Color) -> Self {
        self.clouds.push(Cloud { label: label.into(), points, color });
        self
    }

    /// With a way.
    #[must_use]
    pub fn trace(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        self.traces.push(Trace { label: label.into(), points, stroke });
        self
    }

    /// With closed curves.
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

    /// With a pose.
    #[must_use]
    pub fn pose(mut self, label: impl Into<String>, at: (f64, f64), heading: f64, color: Color) -> Self {
        self.arrows.push(Arrow { label: label.into(), at, heading, color });
        self
    }

    /// Shows this part only, from its lower left to its upper right corner.
    #[must_use]
    pub fn window(mut self, low: (f64, f64), high: (f64, f64)) -> Self {
        self.window = Some([low, high]);
        self
    }

    /// Labels the axes otherwise, `per_metre` of their unit being one metre.
    #[must_use]
    pub fn axes(mut self, per_metre: f64, x_label: &'static str, y_label: &'static str) -> Self {
        self.axes = Some(Axes { per_metre, labels: [x_label, y_label] });
        self
    }

    /// The map as a picture of its own.
    pub fn picture(self) -> Picture {
        beside(vec![self.cell()])
    }

    /// The map as a part of a picture.
    pub fn cell(self) -> Cell {
        let [low, high] = self.extent();
        let (span_x, span_y) = (high.0 - low.0, high.1 - low.1);
        let Axes { per_metre: scale, labels: [x_label, y_label] } = self.axes.unwrap_or(METRES);
        let per_metre = LONGEST / span_x.max(span_y);
        let [left, right, top, bottom] = MARGINS;
        let legend = if self.has_legend() { LEGEND } else { 0.0 };
        let (width, height) = (span_x * per_metre + left + right + legend, span_y * per_metre + top + bottom);

        let arrow_length = 28.0 / per_metre;
        let mut layout = Layout::new((low.0 * scale, high.0 * scale), (low.1 * scale, high.1 * scale))
            .with_title(self.title.clone())
            .with_title_size(15)
            .with_x_label(x_label)
            .with_y_label(y_label)
            .with_x_axis_min(low.0 * scale)
            .with_x_axis_max(high.0 * scale)
            .with_y_axis_min(low.1 * scale)
            .with_y_axis_max(high.1 * scale)
            .with_equal_aspect()
            .with_box_axes()
            .with_force_margins(left, right + legend)
            .with_force_margins_y(top, bottom)
            .with_legend_position(LegendPosition::OutsideRightTop)
            .with_legend_box(false)
            .with_width(width)
            .with_height(height);
        layout.show_legend = true;
        Cell { plots: self.plots(scale, arrow_length), layout, width, height }
    }

    fn plots(self, scale: f64, arrow_length: f64) -> Vec<Plot> {
        let scaled = |(x, y): (f64, f64)| (x * scale, y * scale);
        let mut plots = Vec::new();
        // Where there are many walls, wide ones would grow together.
        let stroke =
            if self.walls.len() > CROWDED { Stroke::solid(Color::Grey) } else { Stroke::wide(Color::Grey) };
        for (i, wall) in self.walls.into_iter().enumerate() {
            let label = if i == 0 { "walls" } else { "" };
            plots.push(line(label, wall.into_iter().map(scaled), stroke));
        }
        for Cloud { label, points, color } in self.clouds {
            let finite = points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()).map(scaled);
            let cloud = ScatterPlot::new().with_data(finite).with_color(color.hex()).with_size(POINT);
            plots.push(Plot::Scatter(if label.is_empty() { cloud } else { cloud.with_legend(label) }));
        }
        for outline in self.outlines {
            for (i, curve) in outline.curves.into_iter().enumerate() {
                let label = if i == 0 { outline.label.as_str() } else { "" };
                plots.push(line(label, curve.into_iter().map(scaled), outline.stroke));
            }
        }
        for trace in self.traces {
            plots.push(line(&trace.label, trace.points.into_iter().map(scaled), trace.stroke));
        }
        for Arrow { label, at, heading, color } in self.arrows {
            let (u, v) = (arrow_length * heading.cos(), arrow_length * heading.sin());
            let ((x, y), (u, v)) = (scaled(at), scaled((u, v)));
            let mut arrow = QuiverPlot::new()
                .with_arrow(x, y, u, v)
                .with_scale(1.0)
                .with_color(color.hex())
                .with_shaft_width(2.4)
                .with_head(10.0, 5.0)
                .with_no_clip();
            if !label.is_empty() {
                arrow = arrow.with_legend(label);
            }
            plots.push(Plot::Quiver(arrow));
        }
        plots
    }

    fn has_legend(&self) -> bool {
        let traces = self.traces.iter().map(|trace| &trace.label);
        let outlines = self.outlines.iter().map(|outline| &outline.label);
        let arrows = self.arrows.iter().map(|arrow| &arrow.label);
        let clouds = self.clouds.iter().map(|cloud| &cloud.label);
        !self.walls.is_empty()
            || traces.chain(outlines).chain(arrows).chain(clouds).any(|label| !label.is_empty())
    }

    /// The window, or the corners of everything with a margin.
    fn extent(&self) -> [(f64, f64); 2] {
        if let Some(window) = self.window {
            return window;
        }
        let walls = self.walls.iter().flatten();
        let traces = self.traces.iter().flat_map(|trace| &trace.points);
        let outlines = self.outlines.iter().flat_map(|outline| outline.curves.iter().flatten());
        let arrows = self.arrows.iter().map(|arrow| &arrow.at);
        let clouds = self.clouds.iter().flat_map(|cloud| &cloud.points);
        let all = walls.chain(traces).chain(outlines).chain(arrows).chain(clouds);
        let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for (x, y) in all.filter(|p| p.0.is_finite() && p.1.is_finite()) {
            low = (low.0.min(*x), low.1.min(*y));
            high = (high.0.max(*x), high.1.max(*y));
        }
        if low.0 > high.0 {
            return [(0.0, 0.0), (1.0, 1.0)];
        }
        let longest = (high.0 - low.0).max(high.1 - low.1).max(1e-3);
        // Room for the arrows, which are as long on paper whatever the map's scale.
        let margin = if self.arrows.is_empty() { 0.05 } else { 0.08 } * longest;
        // A map that is nearly a line keeps some height, or there is no room for its labels.
        let grown = |low: f64, high: f64| {
            let half = (0.5 * (high - low) + margin).max(0.2 * longest);
            (0.5 * (low + high) - half, 0.5 * (low + high) + half)
        };
        let ((x0, x1), (y0, y1)) = (grown(low.0, high.0), grown(low.1, high.1));
        [(x0, y0), (x1, y1)]
    }
}

/// A line with its entry in the legend, unless `label` is empty.
pub(crate) fn line(label: &str, points: impl Iterator<Item = (f64, f64)>, stroke: Stroke) -> Plot {
    let finite = points.filter(|(x, y)| x.is_finite() && y.is_finite());
    let mut line =
        LinePlot::new().with_data(finite).with_color(stroke.color.hex()).with_stroke_width(stroke.width);
    if !label.is_empty() {
        line = line.with_legend(label);
    }
    Plot::Line(line)
}
