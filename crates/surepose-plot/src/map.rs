//! A map from above: cells, walls, ways, ellipses, dots and poses, one metre as long upwards as sideways.

use kuva::plot::legend::LegendPosition;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, QuiverPlot, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use crate::items::{Arrow, DotPaint, Dots, Outline, Trace};
use crate::picture::{Cell, Picture, Underlay, beside};
use crate::scale::Scale;
use crate::style::{Color, Stroke};
use crate::ticks::plain;
use crate::tiles::{Tile, Tiles};

/// A map to be drawn \[m].
#[derive(Clone, Debug, Default)]
pub struct Map {
    title: String,
    tiles: Option<Tiles>,
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

/// What the axes of a map say.
#[derive(Clone, Copy, Debug)]
struct Axes {
    per_metre: f64,
    labels: [&'static str; 2],
    step: Option<f64>,
}

const METRES: Axes = Axes { per_metre: 1.0, labels: ["x [m]", "y [m]"], step: None };

/// Left, right, upper and lower margins of a map's axes \[px].
const MARGINS: [f64; 4] = [64.0, 20.0, 40.0, 56.0];
/// Width of the legend \[px].
const LEGEND: f64 = 196.0;
/// Height of an entry of the legend \[px].
const ENTRY: f64 = 18.0;
/// Radius of a dot \[px], and of one where there are very many.
const DOT: f64 = 4.0;
const POINT: f64 = 1.2;
/// More walls than this are a building.
const CROWDED: usize = 50;
/// The longest side of a map \[px], and of one with more cells along a side than can be seen on that.
const LONGEST: f64 = 560.0;
const LONGEST_FINE: f64 = 1000.0;
const FINE: usize = 280;
/// The longest side of a map that is one part of a small picture, and the columns of the legend below it.
const LONGEST_COMPACT: f64 = 400.0;
const LEGEND_COLUMNS: usize = 2;
/// Space below that legend \[px].
const LEGEND_FOOT: f64 = 12.0;

impl Map {
    /// An empty map.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// With cells below everything else; `keys` say in the legend what their plain colours are.
    #[must_use]
    pub fn tiles(mut self, tiles: Tiles, keys: impl IntoIterator<Item = (String, Color)>) -> Self {
        self.tiles = Some(tiles);
        self.keys.extend(keys);
        self
    }

    /// With shades for values, and a bar that explains them.
    #[must_use]
    pub fn scale(mut self, scale: Scale) -> Self {
        self.scale = Some(scale);
        self
    }

    /// With places.
    #[must_use]
    pub fn dots(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, paint: DotPaint) -> Self {
        self.dots.push(Dots { label: label.into(), points, paint, radius: DOT });
        self
    }

    /// With very many places in one colour.
    #[must_use]
    pub fn points(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, color: Color) -> Self {
        let paint = DotPaint::Plain(color);
        self.dots.push(Dots { label: label.into(), points, paint, radius: POINT });
        self
    }

    /// With walls.
    #[must_use]
    pub fn walls(mut self, walls: impl IntoIterator<Item = [(f64, f64); 2]>) -> Self {
        self.walls.extend(walls);
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
        self.axes = Some(Axes { per_metre, labels: [x_label, y_label], step: None });
        self
    }

    /// Numbers the axes every `step` of their unit.
    #[must_use]
    pub fn numbered_every(mut self, step: f64) -> Self {
        self.axes = Some(Axes { step: Some(step), ..self.axes.unwrap_or(METRES) });
        self
    }

    /// Smaller, with its legend below it: for a picture that shall be read in a column of text.
    #[must_use]
    pub fn compact(mut self) -> Self {
        self.compact = true;
        self
    }

    /// The map as a picture of its own.
    pub fn picture(self) -> Picture {
        beside(vec![self.cell()])
    }

    /// The map as a part of a picture.
    pub fn cell(mut self) -> Cell {
        let [low, high] = self.extent();
        let (span_x, span_y) = (high.0 - low.0, high.1 - low.1);
        let Axes { per_metre: scale, labels: [x_label, y_label], step } = self.axes.unwrap_or(METRES);
        let per_metre = self.pixels_per_metre(span_x.max(span_y));
        let [left, right, top, bottom] = MARGINS;
        let entries = self.legend_entries();
        let bar = if self.scale.is_some() { Scale::ROOM } else { 0.0 };
        let legend = if entries > 0 && !self.compact { LEGEND.max(bar) } else { bar };
        let rows = entries.div_ceil(LEGEND_COLUMNS) as f64;
        let bottom = bottom + if self.compact { rows * ENTRY + LEGEND_FOOT } else { 0.0 };
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
            .with_tick_format(plain())
            .with_equal_aspect()
            .with_box_axes()
            .with_force_margins(left, right + legend)
            .with_force_margins_y(top, bottom)
            .with_legend_position(if self.compact {
                LegendPosition::OutsideBottomColumns
            } else {
                LegendPosition::OutsideRightTop
            })
            .with_legend_col_limit(LEGEND_COLUMNS)
            .with_legend_box(false)
            .with_width(width)
            .with_height(height);
        layout.show_legend = true;
        if let Some(step) = step {
            layout = layout.with_x_tick_step(step).with_y_tick_step(step);
        }
        // The bar stands below the legend, beside the axes.
        let legend_height = if entries > 0 { entries as f64 * ENTRY + 30.0 } else { 0.0 };
        // On cells walls must stand out; and where there are many, wide ones would grow together.
        let on_walls = match self.walls.len() {
            CROWDED.. if self.tiles.is_some() => Stroke::thin(Color::Vermilion),
            _ if self.tiles.is_some() => Stroke::solid(Color::Vermilion),
            CROWDED.. => Stroke::solid(Color::Grey),
            _ => Stroke::wide(Color::Grey),
        };
        let tiles = match (self.tiles.take(), &self.scale) {
            // Something must stand where the bar shall go, even if nothing lies below the dots.
            (None, Some(_)) => {
                Some(Tiles { low, side: span_x.min(span_y), columns: 1, cells: vec![Tile::Nothing] })
            }
            (tiles, _) => tiles,
        };
        let stand_in = tiles.as_ref().map(|tiles| tiles.stand_in(scale));
        let underlay = tiles.map(|tiles| Underlay {
            tiles,
            scale: self.scale.clone(),
            axes: [left, top, span_x * per_metre, span_y * per_metre],
            legend_height,
        });
        let plots = stand_in.into_iter().chain(self.plots(scale, arrow_length, on_walls)).collect();
        Cell { plots, layout, width, height, underlay }
    }

    /// Pixels of a metre where the longer side has `longest` \[m]: where there are cells, each gets so many half pixels
    /// that its edges lie between those of the PNG.
    fn pixels_per_metre(&self, longest: f64) -> f64 {
        let side = if self.compact { LONGEST_COMPACT } else { LONGEST };
        let Some(tiles) = &self.tiles else { return side / longest };
        let fine = tiles.columns.max(tiles.rows()) > FINE;
        let (cell, wanted) = (tiles.side, if fine { LONGEST_FINE } else { side } / longest);
        let halves = (2.0 * wanted * cell).round();
        if halves >= 1.0 { halves / (2.0 * cell) } else { wanted }
    }

    fn plots(self, scale: f64, arrow_length: f64, on_walls: Stroke) -> Vec<Plot> {
        let scaled = |(x, y): (f64, f64)| (x * scale, y * scale);
        let mut plots = Vec::new();
        for (label, color) in &self.keys {
            let key = ScatterPlot::new().with_color(color.hex()).with_marker(MarkerShape::Square);
            plots.push(Plot::Scatter(key.with_legend(label.clone())));
        }
        for (i, wall) in self.walls.into_iter().enumerate() {
            let label = if i == 0 { "walls" } else { "" };
            plots.push(line(label, wall.into_iter().map(scaled), on_walls));
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
        for Dots { label, points, paint, radius } in self.dots {
            let mut dots = ScatterPlot::new().with_data(points.into_iter().map(scaled)).with_size(radius);
            dots = match (paint, &self.scale) {
                (DotPaint::Plain(color), _) => dots.with_color(color.hex()),
                (DotPaint::Values(values), Some(scale)) => {
                    let hex = |value: f64| scale.shade(value).map_or(Color::Silver.hex().into(), Scale::hex);
                    dots.with_colors(values.into_iter().map(hex))
                }
                (DotPaint::Values(_), None) => dots,
            };
            if !label.is_empty() {
                dots = dots.with_legend(label);
            }
            plots.push(Plot::Scatter(dots));
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

    fn legend_entries(&self) -> usize {
        let traces = self.traces.iter().map(|trace| &trace.label);
        let outlines = self.outlines.iter().map(|outline| &outline.label);
        let arrows = self.arrows.iter().map(|arrow| &arrow.label);
        let dots = self.dots.iter().map(|dots| &dots.label);
        let keys = self.keys.iter().map(|(label, _)| label);
        let labels = traces.chain(outlines).chain(arrows).chain(dots).chain(keys);
        usize::from(!self.walls.is_empty()) + labels.filter(|label| !label.is_empty()).count()
    }

    /// The window, or the cells, or the corners of everything with a margin.
    fn extent(&self) -> [(f64, f64); 2] {
        if let Some(window) = self.window {
            return window;
        }
        let walls = self.walls.iter().flatten();
        let traces = self.traces.iter().flat_map(|trace| &trace.points);
        let outlines = self.outlines.iter().flat_map(|outline| outline.curves.iter().flatten());
        let arrows = self.arrows.iter().map(|arrow| &arrow.at);
        let dots = self.dots.iter().flat_map(|dots| &dots.points);
        if let Some(tiles) = &self.tiles {
            return [tiles.low, tiles.high()];
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
