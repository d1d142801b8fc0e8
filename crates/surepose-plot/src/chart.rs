//! Values over one axis, stacked in panels: time series, mostly.

use kuva::plot::Histogram;
use kuva::plot::annotations::{ReferenceLine, ShadedRegion};
use kuva::plot::legend::LegendPosition;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use crate::map::line;
use crate::picture::{Cell, Picture, below};
use crate::style::{Color, Stroke};
use crate::ticks::{decimal, plain};

/// Panels over a common axis.
#[derive(Clone, Debug, Default)]
pub struct Chart {
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

/// Left, right, upper and lower margins of a panel's axes \[px]; the right one has the legend, where there is one.
const MARGINS: [f64; 4] = [78.0, 212.0, 32.0, 24.0];
const NO_LEGEND: f64 = 28.0;
/// What the lowest panel needs below for the common axis \[px].
const FOOT: f64 = 26.0;
/// Size of a panel's axes \[px].
const PANEL: (f64, f64) = (620.0, 180.0);
/// The same in a small picture.
const COMPACT_PANEL: (f64, f64) = (350.0, 119.0);

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

impl Chart {
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
        below(self.cells())
    }

    /// The panels as parts of a picture.
    pub fn cells(self) -> Vec<Cell> {
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
        let labelled = self.panels.iter().flat_map(|p| &p.series).any(|series| !series.label.is_empty());
        let right = if labelled { MARGINS[1] } else { NO_LEGEND };
        let size = if self.compact { COMPACT_PANEL } else { PANEL };
        let (x_label, logarithmic) = (self.x_label, self.logarithmic);
        let cell = |(i, panel): (usize, Panel)| {
            let label = if i == last { Some(x_label.as_str()) } else { None };
            let mut cell = panel.cell(range, size, right, label);
            if logarithmic {
                cell.layout = cell.layout.with_log_x().with_x_tick_format(decimal());
            }
            cell
        };
        self.panels.into_iter().enumerate().map(cell).collect()
    }
}

impl Panel {
    fn cell(
        self,
        (left, right): (f64, f64),
        size: (f64, f64),
        margin_right: f64,
        x_label: Option<&str>,
    ) -> Cell {
        let (low, high) = self.bounds();
        let [margin_left, _, top, bottom] = MARGINS;
        let bottom = bottom + if x_label.is_some() { FOOT } else { 0.0 };
        let (width, height) = (size.0 + margin_left + margin_right, size.1 + top + bottom);
        let mut layout = Layout::new((left, right), (low, high))
            .with_title(self.title.clone())
            .with_title_size(14)
            .with_y_label(self.y_label.clone())
            .with_x_axis_min(left)
            .with_x_axis_max(right)
            .with_y_axis_min(low)
            .with_y_axis_max(high)
            .with_tick_format(plain())
            .with_box_axes()
            .with_force_margins(margin_left, margin_right)
            .with_force_margins_y(top, bottom)
            .with_legend_position(LegendPosition::OutsideRightTop)
            .with_legend_box(false)
            .with_width(width)
            .with_height(height);
        layout.show_legend = true;
        if let Some(label) = x_label {
            layout = layout.with_x_label(label);
        }
        if self.logarithmic {
            // The decimals are wider than the library reckons with.
            layout = layout.with_y_label_offset(-8.0, 0.0);
            layout = layout.with_log_y().with_y_tick_format(decimal());
        }
        for (from, to, color) in &self.shaded {
            layout = layout.with_shaded_region(
                ShadedRegion::vertical(*from, *to).with_color(color.hex()).with_opacity(0.25),
            );
        }
        for mark in &self.marks {
            layout = layout.with_reference_line(match mark {
                Mark::At(x, text) => ReferenceLine::vertical(*x)
                    .with_color(Color::Black.hex())
                    .with_stroke_width(1.0)
                    .with_label(text.clone()),
                Mark::Level(y) => {
                    ReferenceLine::horizontal(*y).with_color(Color::Grey.hex()).with_stroke_width(1.0)
                }
            });
        }
        let logarithmic = self.logarithmic;
        let visible =
            |points: Vec<(f64, f64)>| points.into_iter().filter(move |(_, y)| !logarithmic || *y > 0.0);
        let bars = self.bars.map(|bars| {
            Plot::Histogram(Histogram::from_bins(bars.edges, bars.counts).with_color(bars.color.hex()))
        });
        let lines = self.series.into_iter().map(|s| line(&s.label, visible(s.points), s.stroke));
        let mut plots: Vec<Plot> = bars.into_iter().chain(lines).collect();
        if plots.is_empty() {
            // The library draws no axes round nothing: a point on their corner is not seen.
            plots.push(line("", std::iter::once((left, low)), Stroke::thin(Color::Mist)));
        }
        Cell { plots, layout, width, height, underlay: None }
    }
}
