//! Color scale: maps values to shades of a color ramp, with a color bar.

use crate::plot::axes::NUMBER_SIZE;
use crate::plot::font;
use crate::plot::scene::{Anchor, Area, Pen, Shape, Text};
use crate::plot::style::Rgb;
use crate::plot::ticks::{self, Tick};

/// A color scale, light for low values and dark for high values.
///
/// The ramp is ColorBrewer's yellow-green-blue. Its lightness decreases monotonically, so it is legible for
/// color-blind readers and in grayscale. Values without a shade (failures, gaps) have a separate color.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    label: String,
    low: f64,
    high: f64,
    per_unit: f64,
}

/// Number of shades; a larger one is indistinguishable, and fewer shades let adjacent cells merge.
const SHADES: f64 = 48.0;
/// Start of the used part of the ramp; its lightest end resembles the background.
const LIGHTEST: f64 = 0.22;
/// Gap between the axes and the color bar, and width of the bar \[px].
const GAP: f64 = 18.0;
const WIDTH: f64 = 18.0;
/// Length of a tick \[px].
const TICK: f64 = 5.0;
/// Distance of the label from the right side of the bar \[px].
const LABEL: f64 = 62.0;
/// Maximum number of steps between the ticks of the bar.
const MAX_STEPS: usize = 8;

impl Scale {
    /// Width of the color bar with its labels \[px].
    pub(crate) const ROOM: f64 = GAP + WIDTH + LABEL + 14.0;

    /// Creates a scale from `low` to `high`; values outside have the shade of the nearer end.
    pub fn new(label: impl Into<String>, low: f64, high: f64) -> Self {
        let ordered = low.is_finite() && high.is_finite() && low < high;
        // An empty or invalid range is replaced by one around the value, which avoids a division by 0.
        let middle = if low.is_finite() { low } else { 0.0 };
        let half = 0.5 * middle.abs().max(1e-9);
        let (low, high) = if ordered { (low, high) } else { (middle - half, middle + half) };
        Self { label: label.into(), low, high, per_unit: 1.0 }
    }

    /// Multiplies the labels of the color bar by `per_unit`.
    #[must_use]
    pub fn times(self, per_unit: f64) -> Self {
        Self { per_unit, ..self }
    }

    /// Index of the shade of `value`. `None`: NaN.
    pub(crate) fn shade(&self, value: f64) -> Option<u8> {
        let part = (value - self.low) / (self.high - self.low);
        (!part.is_nan()).then(|| (part.clamp(0.0, 1.0) * (SHADES - 1.0)).round() as u8)
    }

    /// Returns the color of a shade.
    pub(crate) fn color(shade: u8) -> Rgb {
        let part = (f64::from(shade) / (SHADES - 1.0)).clamp(0.0, 1.0);
        let color = colorous::YELLOW_GREEN_BLUE.eval_continuous(LIGHTEST + (1.0 - LIGHTEST) * part);
        Rgb(color.into_array())
    }

    /// Draws the color bar beside axes that end at `right`, from `top` to `bottom` \[px].
    pub(crate) fn bar(&self, right: f64, top: f64, bottom: f64) -> Vec<Shape> {
        let whole = Area { left: right + GAP, top, width: WIDTH, height: bottom - top };
        let place = |part: f64| bottom - whole.height * part;
        let mut drawn = Vec::new();
        for shade in 0..SHADES as u8 {
            let (low, high) = (place(f64::from(shade) / SHADES), place(f64::from(shade + 1) / SHADES));
            let area = Area { top: high, height: low - high, ..whole };
            drawn.push(Shape::Rectangles { areas: vec![area], color: Self::color(shade) });
        }
        let mut lines = vec![whole.outline()];
        for tick in self.ticks() {
            let y = place((tick.at / self.per_unit - self.low) / (self.high - self.low));
            let y = (2.0 * y).round() / 2.0;
            lines.push(vec![(whole.right(), y), (whole.right() + TICK, y)]);
            let at = (whole.right() + TICK + 4.0, y + 4.3);
            drawn.push(Shape::Text(Text::new(at, tick.text, NUMBER_SIZE, Anchor::Start)));
        }
        drawn.push(Shape::Lines { lines, pen: Pen::crisp(Rgb::INK) });
        let at = (whole.right() + LABEL, place(0.5));
        // A label longer than the bar is drawn smaller.
        let size = NUMBER_SIZE * (whole.height / font::width(&self.label, NUMBER_SIZE).max(1.0)).min(1.0);
        let label = Text::new(at, self.label.as_str(), size, Anchor::Middle);
        drawn.push(Shape::Text(Text { upright: true, ..label }));
        drawn
    }

    fn ticks(&self) -> Vec<Tick> {
        ticks::linear(self.low * self.per_unit, self.high * self.per_unit, MAX_STEPS)
    }
}

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn values_are_clamped_and_nan_has_no_shade() {
        let scale = Scale::new("", 1.0, 3.0);
        assert_eq!(scale.shade(1.0), Some(0));
        assert_eq!(scale.shade(3.0), Some(47));
        assert_eq!((scale.shade(-9.0), scale.shade(f64::INFINITY)), (Some(0), Some(47)));
        assert_eq!(scale.shade(f64::NAN), None);
        assert_ne!(scale.shade(1.9), scale.shade(2.1));
    }

    #[test]
    fn every_scale_has_ticks() {
        let texts = |scale: Scale| scale.ticks().into_iter().map(|tick| tick.text).collect::<Vec<_>>();
        let percent = Scale::new("", 0.0, 1.0).times(100.0);
        assert_eq!(texts(percent), ["0", "20", "40", "60", "80", "100"]);
        // A single value and an empty range still give a color bar.
        for (low, high) in [(2.0, 2.0), (f64::INFINITY, f64::NEG_INFINITY)] {
            assert!(texts(Scale::new("", low, high)).len() > 1);
        }
    }
}
