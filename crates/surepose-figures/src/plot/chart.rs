//! Values over one axis, stacked in panels: time series, mostly.

use crate::plot::axes::{Axes, Axis, NUMBER_SIZE};
use crate::plot::font;
use crate::plot::legend::{self, Entry, Key};
use crate::plot::picture::{Picture, Subplot, vstack_cells};
use crate::plot::scene::{Anchor, Area, Pen, PenStyle, Shape, Text};
use crate::plot::style::{Color, Rgb, Stroke};

/// Panels over a common axis.
#[derive(Clone, Debug, Default)]
pub struct XyPlot {
    x_label: String,
    logarithmic: bool,
    compact: bool,
    panels: Vec<Panel>,
}

/// One panel.
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

/// Values over the common axis.
#[derive(Clone, Debug)]
pub struct Series {
    /// What the legend calls them.
    pub label: String,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
    /// How they are drawn.
    pub stroke: Stroke,
}

/// How many values lie in each of some ranges.
#[derive(Clone, Debug)]
struct Bars {
    edges: Vec<f64>,
    counts: Vec<f64>,
    color: Color,
}

/// A line across a panel.
#[derive(Clone, Debug)]
pub enum Mark {
    /// At a place of the common axis, with what is written beside it.
    At(f64, String),
    /// At a value.
    Level(f64),
}

/// Left, upper and lower margins of a panel's axes \[px].
const MARGINS: [f64; 3] = [78.0, 32.0, 24.0];
/// The right margin where there is no legend \[px].
const NO_LEGEND: f64 = 28.0;
/// What the lowest panel needs below for the common axis \[px].
const FOOT: f64 = 26.0;
/// Size of a panel's axes \[px].
const PANEL: (f64, f64) = (620.0, 180.0);
/// The same in a small picture.
const COMPACT_PANEL: (f64, f64) = (350.0, 119.0);
/// Up to so many, each count has a number.
const FEW: f64 = 8.0;
/// How strongly shaded parts are colored.
const SHADED_OPACITY: f64 = 0.25;
/// Space between a line across and its text \[px].
const MARK_GAP: f64 = 5.0;

impl Panel {
    /// An empty panel.
    pub fn new(title: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self::default().titled(title, y_label)
    }

    /// With this title and this label of its axis.
    #[must_use]
    pub fn titled(self, title: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self { title: title.into(), y_label: y_label.into(), ..self }
    }

    /// With values.
    #[must_use]
    pub fn series(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, stroke: Stroke) -> Self {
        self.series.push(Series { label: label.into(), points, stroke });
        self
    }

    /// With a bar for each count, from one of `edges` to the next: one edge more than counts.
    #[must_use]
    pub fn bars(mut self, edges: Vec<f64>, counts: Vec<f64>, color: Color) -> Self {
        self.bars = Some(Bars { edges, counts, color });
        self
    }

    /// With lines across.
    #[must_use]
    pub fn marks(mut self, marks: impl IntoIterator<Item = Mark>) -> Self {
        self.marks.extend(marks);
        self
    }

    /// With parts of the common axis shaded.
    #[must_use]
    pub fn shaded(mut self, parts: impl IntoIterator<Item = (f64, f64)>, color: Color) -> Self {
        self.shaded.extend(parts.into_iter().map(|(from, to)| (from, to, color)));
        self
    }

    /// With a logarithmic axis of values; those that are not positive are left out.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// With a fixed range of values.
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
    /// An empty chart over this axis.
    pub fn over(x_label: impl Into<String>) -> Self {
        Self { x_label: x_label.into(), ..Self::default() }
    }

    /// With a logarithmic common axis: everything on it is positive.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// With smaller panels: for a picture that shall be read in a column of text.
    #[must_use]
    pub fn compact(mut self) -> Self {
        self.compact = true;
        self
    }

    /// With another panel below.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// The chart as a picture.
    pub fn picture(self) -> Picture {
        vstack_cells(self.cells())
    }

    /// The panels as parts of a picture.
    pub fn cells(self) -> Vec<Subplot> {
        let xs = self.panels.iter().flat_map(|p| &p.series).flat_map(|s| s.points.iter().map(|(x, _)| *x));
        let edges = self.panels.iter().filter_map(|p| p.bars.as_ref()).flat_map(|bars| &bars.edges);
        let shaded = self.panels.iter().flat_map(|p| &p.shaded).flat_map(|(from, to, _)| [*from, *to]);
        let xs = xs.chain(edges.copied()).chain(shaded);
        let (low, high) =
            xs.filter(|x| x.is_finite()).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        // An axis that nearly starts at 0 does.
        let low = if low > 0.0 && low < 0.05 * high && !self.logarithmic { 0.0 } else { low };
        let range = if low < high { (low, high) } else { (0.0, 1.0) };
        let last = self.panels.len().saturating_sub(1);
        // All panels end at the same place, or their common axis would not be common.
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
        // Counts are whole.
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
                // A line of paper between bars shows where each begins.
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

    /// Draws the lines across, each with its text beside its upper end.
    fn drawn_marks(&self, axes: &Axes) -> Vec<Shape> {
        let Area { left, top, .. } = axes.area;
        let (right, bottom) = (axes.area.right(), axes.area.bottom());
        let (mut shapes, mut texts) = (Vec::new(), Vec::new());
        // Where the texts of the rows so far end: one that would run into another goes into the next row.
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
