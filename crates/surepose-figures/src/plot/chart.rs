//! Charts: panels stacked over a common x axis, for example time series.

use crate::plot::axes::{Axes, Axis, NUMBER_SIZE};
use crate::plot::font;
use crate::plot::legend::{self, Entry, Key};
use crate::plot::picture::{Picture, Subplot, vstack_cells};
use crate::plot::scene::{Anchor, Area, Pen, PenStyle, Shape, Text};
use crate::plot::style::{Color, Rgb, Stroke};

/// Panels over a common x axis.
#[derive(Clone, Debug, Default)]
pub struct XyPlot {
    x_label: String,
    logarithmic: bool,
    compact: bool,
    panels: Vec<Panel>,
}

/// One panel of a chart.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    title: String,
    y_label: String,
    series: Vec<Series>,
    bars: Option<Bars>,
    marks: Vec<Mark>,
    shaded: Vec<(f64, f64, Color)>,
    logarithmic: bool,
    range: Option<(f64, f64)>,
}

/// A data series.
#[derive(Clone, Debug)]
pub struct Series {
    /// Legend label; empty: no entry.
    pub label: String,
    /// Points (x, y).
    pub points: Vec<(f64, f64)>,
    /// Line style.
    pub stroke: Stroke,
}

/// A histogram.
#[derive(Clone, Debug)]
struct Bars {
    edges: Vec<f64>,
    counts: Vec<f64>,
    color: Color,
}

/// A straight line across a panel.
#[derive(Clone, Debug)]
pub enum Mark {
    /// Vertical line at an x value, with a label; empty: no label.
    At(f64, String),
    /// Horizontal line at a y value.
    Level(f64),
}

/// Left, top, and bottom margins of a panel's axes \[px].
const MARGINS: [f64; 3] = [78.0, 32.0, 24.0];
/// Right margin without a legend \[px].
const NO_LEGEND: f64 = 28.0;
/// Space below the lowest panel for the common axis \[px].
const FOOT: f64 = 26.0;
/// Size of a panel's axes \[px].
const PANEL: (f64, f64) = (620.0, 180.0);
/// Size of a compact panel's axes \[px].
const COMPACT_PANEL: (f64, f64) = (350.0, 119.0);
/// Largest count up to which every count has a tick label.
const FEW: f64 = 8.0;
/// Opacity of shaded ranges.
const SHADED_OPACITY: f64 = 0.25;
/// Gap between a vertical line and its label \[px].
const MARK_GAP: f64 = 5.0;

impl Panel {
    /// Creates an empty panel.
    pub fn new(title: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self::default().titled(title, y_label)
    }

    /// Sets the title and the y-axis label.
    #[must_use]
    pub fn titled(self, title: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self { title: title.into(), y_label: y_label.into(), ..self }
    }

    /// Adds a data series.
    #[must_use]
    pub fn series(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        self.series.push(Series { label: label.into(), points, stroke });
        self
    }

    /// Sets the histogram; `edges` has one element more than `counts`.
    #[must_use]
    pub fn bars(mut self, edges: Vec<f64>, counts: Vec<f64>, color: Color) -> Self {
        self.bars = Some(Bars { edges, counts, color });
        self
    }

    /// Adds lines across the panel.
    #[must_use]
    pub fn marks(mut self, marks: impl IntoIterator<Item = Mark>) -> Self {
        self.marks.extend(marks);
        self
    }

    /// Adds shaded ranges of the x axis.
    #[must_use]
    pub fn shaded(mut self, parts: impl IntoIterator<Item = (f64, f64)>, color: Color) -> Self {
        self.shaded.extend(parts.into_iter().map(|(from, to)| (from, to, color)));
        self
    }

    /// Makes the y axis logarithmic; nonpositive values are omitted.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// Sets the range of the y axis.
    #[must_use]
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let logarithmic = self.logarithmic;
        let levels = self.marks.iter().filter_map(|mark| match mark {
            Mark::Level(value) => Some(*value),
            Mark::At(..) => None,
        });
        let values = self.series.iter().flat_map(|series| series.points.iter().map(|(_, y)| *y));
        values.chain(levels).filter(move |y| y.is_finite() && (!logarithmic || *y > 0.0))
    }

    fn bounds(&self) -> (f64, f64) {
        if let Some(range) = self.range {
            return range;
        }
        if let Some(bars) = &self.bars {
            return (0.0, 1.08 * bars.counts.iter().fold(1.0, |most: f64, count| most.max(*count)));
        }
        let (low, high) = self.values().fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
        if low > high {
            return if self.logarithmic { (0.1, 1.0) } else { (0.0, 1.0) };
        }
        if self.logarithmic {
            return (10f64.powf(low.log10().floor()), 10f64.powf((high * 1.01).log10().ceil()));
        }
        let margin = 0.08 * (high - low).max(1e-9 + 1e-3 * high.abs());
        (low - margin, high + margin)
    }
}

impl XyPlot {
    /// Creates an empty chart with this x-axis label.
    pub fn over(x_label: impl Into<String>) -> Self {
        Self { x_label: x_label.into(), ..Self::default() }
    }

    /// Makes the common axis logarithmic; all x values must be positive.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// Uses smaller panels, for a column of text.
    #[must_use]
    pub fn compact(mut self) -> Self {
        self.compact = true;
        self
    }

    /// Adds a panel at the bottom.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Converts the chart to a picture.
    pub fn picture(self) -> Picture {
        vstack_cells(self.cells())
    }

    /// Converts the panels to subplots.
    pub fn cells(self) -> Vec<Subplot> {
        let xs = self.panels.iter().flat_map(|p| &p.series).flat_map(|s| s.points.iter().map(|(x, _)| *x));
        let edges = self.panels.iter().filter_map(|p| p.bars.as_ref()).flat_map(|bars| &bars.edges);
        let shaded = self.panels.iter().flat_map(|p| &p.shaded).flat_map(|(from, to, _)| [*from, *to]);
        let xs = xs.chain(edges.copied()).chain(shaded);
        let (low, high) =
            xs.filter(|x| x.is_finite()).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        // An axis that starts close to 0 is extended to 0.
        let low = if low > 0.0 && low < 0.05 * high && !self.logarithmic { 0.0 } else { low };
        let range = if low < high { (low, high) } else { (0.0, 1.0) };
        let last = self.panels.len().saturating_sub(1);
        // All panels have the same right margin, so their x axes align.
        let legends = self.panels.iter().map(|panel| legend::width(&panel.legend()));
        let right = legends.fold(NO_LEGEND, f64::max);
        let size = if self.compact { COMPACT_PANEL } else { PANEL };
        let (x_label, logarithmic) = (self.x_label, self.logarithmic);
        let x = |label| Axis { low: range.0, high: range.1, logarithmic, label, step: None };
        let cell = |(i, panel): (usize, Panel)| {
            panel.cell(x(if i == last { x_label.clone() } else { String::new() }), size, right)
        };
        self.panels.into_iter().enumerate().map(cell).collect()
    }
}

impl Panel {
    fn cell(self, x: Axis, (width, height): (f64, f64), right: f64) -> Subplot {
        let [left, top, bottom] = MARGINS;
        let bottom = bottom + if x.label.is_empty() { 0.0 } else { FOOT };
        let part_width = left + width + right;
        let (low, high) = self.bounds();
        let area = Area { left, top, width, height };
        // Counts are integers.
        let step = (self.bars.is_some() && high <= FEW).then_some(1.0);
        let y = Axis { low, high, logarithmic: self.logarithmic, label: self.y_label.clone(), step };
        let axes = Axes { title: self.title.clone(), x, y, area };

        let mut inside: Vec<Shape> = Vec::new();
        for (from, to, color) in &self.shaded {
            let (from, to) = (axes.place((*from, low)).0, axes.place((*to, low)).0);
            let areas = vec![Area { left: from, width: to - from, ..area }];
            inside.push(Shape::Rectangles { areas, color: color.rgb().on_paper(SHADED_OPACITY) });
        }
        inside.extend(axes.grid());
        if let Some(Bars { edges, counts, color }) = &self.bars {
            let bar = |(edges, count): (&[f64], &f64)| {
                let (left, top) = axes.place((edges[0], *count));
                let (right, bottom) = axes.place((edges[1], low));
                // A gap of one pixel separates adjacent bars.
                let gap = if right - left > 4.0 { 1.0 } else { 0.0 };
                Area { left, top, width: right - left - gap, height: bottom - top }
            };
            let areas = edges.windows(2).zip(counts).map(bar).collect();
            inside.push(Shape::Rectangles { areas, color: color.rgb() });
        }
        for Series { points, stroke, .. } in &self.series {
            let lines = axes.line(points.iter().copied().filter(|(_, y)| !self.logarithmic || *y > 0.0));
            inside.push(Shape::Lines { lines, pen: Pen::round(*stroke) });
        }
        inside.extend(self.drawn_marks(&axes));
        let mut shapes = vec![Shape::Clip { area, shapes: inside }];
        shapes.extend(axes.frame(part_width));
        shapes.extend(legend::hstack(&self.legend(), &area));
        Subplot { shapes, width: part_width, height: top + height + bottom }
    }

    /// Draws the lines across, each with its label at the upper end.
    fn drawn_marks(&self, axes: &Axes) -> Vec<Shape> {
        let Area { left, top, .. } = axes.area;
        let (right, bottom) = (axes.area.right(), axes.area.bottom());
        let (mut shapes, mut texts) = (Vec::new(), Vec::new());
        // End positions of the labels per row; an overlapping label goes into the next row.
        let mut rows: Vec<f64> = Vec::new();
        for mark in &self.marks {
            let (line, color) = match mark {
                Mark::Level(value) => {
                    let (_, y) = axes.place((axes.x.low, *value));
                    (vec![(left, y), (right, y)], Color::Grey.rgb())
                }
                Mark::At(value, _) => {
                    let (x, _) = axes.place((*value, axes.y.low));
                    (vec![(x, top), (x, bottom)], Rgb::INK)
                }
            };
            if line.iter().any(|(x, y)| !x.is_finite() || !y.is_finite()) {
                continue;
            }
            if let (Mark::At(_, text), Some((x, _))) = (mark, line.first())
                && !text.is_empty()
            {
                let width = font::width(text, NUMBER_SIZE);
                let from =
                    if x + width + 2.0 * MARK_GAP > right { x - MARK_GAP - width } else { x + MARK_GAP };
                let free = rows.iter().position(|end| *end + MARK_GAP < from).unwrap_or(rows.len());
                rows.resize(rows.len().max(free + 1), 0.0);
                rows[free] = from + width;
                let at = (from, top + 15.0 + 16.0 * free as f64);
                let text = Text::new(at, text.as_str(), NUMBER_SIZE, Anchor::Start);
                texts.push(Shape::Text(Text { halo: true, ..text }));
            }
            let pen = Pen { color, width: 1.0, style: PenStyle::Dashed };
            shapes.push(Shape::Lines { lines: vec![line], pen });
        }
        shapes.extend(texts);
        shapes
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = Vec::new();
        for Series { label, stroke, .. } in &self.series {
            legend::add(&mut entries, label, Key::Line(Pen::round(*stroke)));
        }
        entries
    }
}
