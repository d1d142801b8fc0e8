//! A pair of axes: data-to-page transform, frame, grid, ticks, and labels.

use crate::plot::font;
use crate::plot::scene::{Anchor, Area, Pen, Point, Shape, Text};
use crate::plot::style::Rgb;
use crate::plot::ticks::{self, Tick};

/// Font sizes of tick labels, axis labels, and title \[px].
pub(crate) const NUMBER_SIZE: f64 = 12.0;
const LABEL_SIZE: f64 = 13.0;
const TITLE_SIZE: f64 = 14.0;
/// Lengths of major and minor ticks \[px].
const TICK: f64 = 5.0;
const MINOR_TICK: f64 = 3.0;
/// Minimum horizontal gap between tick labels \[px].
const MIN_GAP: f64 = 20.0;
/// Minimum vertical spacing of tick labels on linear and on logarithmic axes \[px].
const MIN_SPACING: f64 = 19.0;
const MIN_DECADE: f64 = 17.0;
/// Maximum number of tick labels on the vertical axis.
const MAX_LEVELS: f64 = 12.0;
/// Margin around the axes beyond which data is dropped \[px].
const MARGIN: f64 = 24.0;
/// Minimum distance between successive points of a line \[px]; closer points are dropped.
const MIN_STEP: f64 = 0.2;
/// Largest coordinate of a line outside of the axes \[px].
const FAR: f64 = 1e6;

/// One axis.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) logarithmic: bool,
    /// Label; empty: none.
    pub(crate) label: String,
    /// Tick step. `None`: chosen to fit.
    pub(crate) step: Option<f64>,
}

/// A pair of axes around an area of the drawing.
#[derive(Clone, Debug)]
pub(crate) struct Axes {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) area: Area,
}

impl Axis {
    /// Returns the position of a value, from 0 at the low end to 1 at the high end.
    fn fraction(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    fn ticks(&self, most: usize) -> Vec<Tick> {
        match self.step {
            Some(step) => ticks::stepped(self.low, self.high, step),
            None if self.logarithmic => ticks::logarithmic(self.low, self.high, most),
            None => ticks::linear(self.low, self.high, most),
        }
    }

    /// Returns as many ticks as fit on `length` \[px] with a gap between their labels.
    fn ticks_sideways(&self, length: f64) -> Vec<Tick> {
        let mut most = (length / 48.0).max(2.0) as usize;
        loop {
            let ticks = self.ticks(most);
            let numbered = || ticks.iter().filter(|tick| !tick.text.is_empty());
            let place = |tick: &Tick| length * self.fraction(tick.at);
            let width = |tick: &Tick| font::width(&tick.text, NUMBER_SIZE);
            let fits = numbered().zip(numbered().skip(1)).all(|(left, right)| {
                place(right) - place(left) >= 0.5 * (width(left) + width(right)) + MIN_GAP
            });
            if fits || most <= 2 {
                return ticks;
            }
            most -= 1;
        }
    }
}

impl Axes {
    /// Uses one tick step for both axes, unless a step is set or an axis would lose its labels.
    pub(crate) fn equally_numbered(mut self) -> Self {
        let step = |ticks: Vec<Tick>| match ticks.as_slice() {
            [first, second, ..] => second.at - first.at,
            _ => 0.0,
        };
        let step = step(self.x_ticks()).max(step(self.y_ticks()));
        let is_numbered = |axis: &Axis| ticks::stepped(axis.low, axis.high, step).len() > 1;
        if is_numbered(&self.x) && is_numbered(&self.y) {
            self.x.step = self.x.step.or(Some(step));
            self.y.step = self.y.step.or(Some(step));
        }
        self
    }

    /// Returns the position of a data point on the page \[px].
    pub(crate) fn place(&self, (x, y): (f64, f64)) -> Point {
        let Area { left, width, height, .. } = self.area;
        (left + width * self.x.fraction(x), self.area.bottom() - height * self.y.fraction(y))
    }

    /// Returns the grid, which lies below the data.
    pub(crate) fn grid(&self) -> Vec<Shape> {
        let numbered = |ticks: Vec<Tick>| ticks.into_iter().filter(|tick| !tick.text.is_empty());
        let (top, bottom, left, right) =
            (self.area.top, self.area.bottom(), self.area.left, self.area.right());
        let upright =
            numbered(self.x_ticks()).map(|tick| self.column(tick.at)).map(|x| vec![(x, top), (x, bottom)]);
        let level =
            numbered(self.y_ticks()).map(|tick| self.row(tick.at)).map(|y| vec![(left, y), (right, y)]);
        vec![Shape::Lines { lines: upright.chain(level).collect(), pen: Pen::crisp(Rgb::GRID) }]
    }

    /// Returns frame, tick labels, axis labels, and title, for a subplot of width `part_width` \[px].
    pub(crate) fn frame(&self, part_width: f64) -> Vec<Shape> {
        let (bottom, left) = (self.area.bottom(), self.area.left);
        let mut lines = vec![self.area.outline()];
        let mut texts = Vec::new();
        let mut widest: f64 = 0.0;
        let length = |tick: &Tick| if tick.text.is_empty() { MINOR_TICK } else { TICK };
        for tick in self.x_ticks() {
            let x = self.column(tick.at);
            lines.push(vec![(x, bottom), (x, bottom + length(&tick))]);
            texts.push(Text::new((x, bottom + TICK + 14.0), tick.text, NUMBER_SIZE, Anchor::Middle));
        }
        for tick in self.y_ticks() {
            let y = self.row(tick.at);
            lines.push(vec![(left, y), (left - length(&tick), y)]);
            widest = widest.max(font::width(&tick.text, NUMBER_SIZE));
            texts.push(Text::new((left - TICK - 4.0, y + 4.3), tick.text, NUMBER_SIZE, Anchor::End));
        }
        let (middle_x, middle_y) = (left + 0.5 * self.area.width, bottom - 0.5 * self.area.height);
        texts.push(Text::new((middle_x, bottom + 38.0), self.x.label.as_str(), LABEL_SIZE, Anchor::Middle));
        let hstack = (left - TICK - 4.0 - widest - 8.0).max(LABEL_SIZE);
        let label = Text::new((hstack, middle_y), self.y.label.as_str(), LABEL_SIZE, Anchor::Middle);
        texts.push(Text { upright: true, ..label });
        texts.push(self.title(part_width));
        texts.retain(|text| !text.content.is_empty());
        let frame = Shape::Lines { lines, pen: Pen::crisp(Rgb::INK) };
        std::iter::once(frame).chain(texts.into_iter().map(Shape::Text)).collect()
    }

    /// Returns a polyline through the points, split where it leaves the axes.
    pub(crate) fn line(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Vec<Point>> {
        let (area, mut lines) = (self.area, Vec::new());
        let mut line: Vec<Point> = Vec::new();
        let mut last: Option<Point> = None;
        let is_beside = |(x0, y0): Point, (x1, y1): Point| {
            x0.max(x1) < area.left - MARGIN
                || x0.min(x1) > area.right() + MARGIN
                || y0.max(y1) < area.top - MARGIN
                || y0.min(y1) > area.bottom() + MARGIN
        };
        for point in self.places(points) {
            let before = last.replace(point).unwrap_or(point);
            if is_beside(before, point) {
                lines.extend((!line.is_empty()).then(|| std::mem::take(&mut line)));
                continue;
            }
            if line.is_empty() {
                line.push(before);
            }
            line.push(point);
        }
        lines.extend((!line.is_empty()).then_some(line));
        lines.into_iter().map(downsampled).collect()
    }

    /// Returns the positions of the points that are not NaN and not far outside.
    pub(crate) fn dots(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Point> {
        let Area { left, top, width, height } = self.area;
        let near = Area {
            left: left - MARGIN,
            top: top - MARGIN,
            width: width + 2.0 * MARGIN,
            height: height + 2.0 * MARGIN,
        };
        self.places(points).filter(|place| near.contains(*place)).collect()
    }

    fn places(&self, points: impl IntoIterator<Item = (f64, f64)>) -> impl Iterator<Item = Point> {
        let places = points.into_iter().map(|point| self.place(point));
        let numbers = places.filter(|(x, y)| !x.is_nan() && !y.is_nan());
        numbers.map(|(x, y)| (x.clamp(-FAR, FAR), y.clamp(-FAR, FAR)))
    }

    fn x_ticks(&self) -> Vec<Tick> {
        self.x.ticks_sideways(self.area.width)
    }

    fn y_ticks(&self) -> Vec<Tick> {
        let spacing = if self.y.logarithmic { MIN_DECADE } else { MIN_SPACING };
        self.y.ticks((self.area.height / spacing).clamp(2.0, MAX_LEVELS) as usize)
    }

    /// Horizontal position of an x value, rounded to half a pixel, which is one pixel of the PNG.
    fn column(&self, x: f64) -> f64 {
        let (x, _) = self.place((x, self.y.low));
        (2.0 * x).round() / 2.0
    }

    fn row(&self, y: f64) -> f64 {
        let (_, y) = self.place((self.x.low, y));
        (2.0 * y).round() / 2.0
    }

    /// Title above the axes; a long title spans the subplot and is scaled down to fit.
    fn title(&self, part_width: f64) -> Text {
        let long = font::width(&self.title, TITLE_SIZE);
        let (middle, room) = (self.area.left + 0.5 * self.area.width, part_width - 16.0);
        let half = 0.5 * long.min(room);
        let middle = middle.max(8.0 + half).min(part_width - 8.0 - half);
        let size = TITLE_SIZE * (room / long.max(1.0)).min(1.0);
        Text::new((middle, self.area.top - 10.0), self.title.as_str(), size, Anchor::Middle)
    }
}

/// Drops points that coincide with the previous one on the page.
fn downsampled(line: Vec<Point>) -> Vec<Point> {
    let count = line.len();
    let mut kept: Vec<Point> = Vec::with_capacity(count);
    for (i, (x, y)) in line.into_iter().enumerate() {
        let is_close = kept.last().is_some_and(|(a, b)| (x - a).hypot(y - b) < MIN_STEP);
        // A line whose points all coincide keeps two points, which draw a dot.
        if !is_close || (i + 1 == count && kept.len() == 1) {
            kept.push((x, y));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use crate::plot::scene::Area;

    use super::{Axes, Axis};

    fn axes() -> Axes {
        let axis = |high| Axis { low: 0.0, high, logarithmic: false, label: String::new(), step: None };
        let area = Area { left: 50.0, top: 20.0, width: 200.0, height: 100.0 };
        Axes { title: "a title that is far too long for it".to_owned(), x: axis(2.0), y: axis(1.0), area }
    }

    #[test]
    fn lines_are_split_at_the_edges_and_handle_nan_and_infinity() {
        let lines = |points: &[(f64, f64)]| axes().line(points.iter().copied());
        assert_eq!(lines(&[(0.0, 0.0), (2.0, 1.0)]), [[(50.0, 120.0), (250.0, 20.0)]]);
        assert_eq!(lines(&[(0.0, 0.0), (0.0, -9.0), (2.0, -9.0), (2.0, 0.0)]).len(), 2);
        assert_eq!(lines(&[(5.0, 0.0), (6.0, 0.0), (f64::NAN, 0.0)]).len(), 0);
        assert_eq!(lines(&[(1.0, f64::INFINITY), (1.0, 0.0)]), [[(150.0, -1e6), (150.0, 120.0)]]);
        // From one side to the other, without a point inside.
        assert_eq!(lines(&[(-5.0, 0.5), (7.0, 0.5)]).len(), 1);
    }

    #[test]
    fn long_title_fits_into_its_subplot() {
        let axes = axes();
        let title = axes.title(260.0);
        let width = crate::plot::font::width(&title.content, title.size);
        assert!(title.at.0 - 0.5 * width >= 7.9 && title.at.0 + 0.5 * width <= 252.1, "{title:?}");
    }
}
