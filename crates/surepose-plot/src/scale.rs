//! From values to shades of one ramp, and the bar that says which shade is which value.

use kuva::plot::ColorMap;
use kuva::render::color::Color as Paint;
use kuva::render::render::{Primitive, TextAnchor};

/// Values on a ramp of shades, light for low and dark for high.
///
/// The ramp is ColorBrewer's from yellow over green to blue, whose lightness falls all along: it is read by colour-blind
/// people and in grey print. What a scale has no shade for (a failure, a gap) is drawn in a colour of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    label: String,
    low: f64,
    high: f64,
    per_unit: f64,
}

/// Shades of the ramp: as many as can be told apart, so that neighbouring cells often share one.
const SHADES: f64 = 48.0;
/// The part of the ramp that is used: its lightest end could be taken for paper.
const LIGHTEST: f64 = 0.22;
/// Space between the axes and the bar, and the bar's width \[px].
const GAP: f64 = 18.0;
const WIDTH: f64 = 18.0;
/// Length of a tick, and size of its text \[px].
const TICK: f64 = 5.0;
const TEXT: u32 = 12;
/// Where the bar's label runs, from the bar's right side \[px].
const LABEL: f64 = 62.0;
/// Fewest steps between the bar's ticks.
const FEWEST: f64 = 4.0;

impl Scale {
    /// What a picture with a bar needs on its right \[px].
    pub(crate) const ROOM: f64 = GAP + WIDTH + LABEL + 14.0;

    /// Values from `low` to `high`; those beyond are drawn as the end that they are beyond.
    pub fn new(label: impl Into<String>, low: f64, high: f64) -> Self {
        let ordered = low.is_finite() && high.is_finite() && low < high;
        // A single value has a range of its own size around it, or there is nothing to divide by.
        let middle = if low.is_finite() { low } else { 0.0 };
        let half = 0.5 * middle.abs().max(1e-9);
        let (low, high) = if ordered { (low, high) } else { (middle - half, middle + half) };
        Self { label: label.into(), low, high, per_unit: 1.0 }
    }

    /// Writes beside the bar `per_unit` times the values.
    #[must_use]
    pub fn times(self, per_unit: f64) -> Self {
        Self { per_unit, ..self }
    }

    /// The number of the shade of `value`; none of what is no number.
    pub(crate) fn shade(&self, value: f64) -> Option<u8> {
        let part = (value - self.low) / (self.high - self.low);
        (!part.is_nan()).then(|| (part.clamp(0.0, 1.0) * (SHADES - 1.0)).round() as u8)
    }

    /// The colour of a shade, as `#rrggbb`.
    pub(crate) fn hex(shade: u8) -> String {
        let part = f64::from(shade) / (SHADES - 1.0);
        ColorMap::YellowGreenBlue.map(LIGHTEST + (1.0 - LIGHTEST) * part.clamp(0.0, 1.0))
    }

    /// The bar beside axes that end at `right`, from `top` to `bottom` \[px].
    pub(crate) fn bar(&self, right: f64, top: f64, bottom: f64) -> Vec<Primitive> {
        let (x, height) = (right + GAP, bottom - top);
        let ink = || Paint::from("#222222");
        let mut drawn = Vec::new();
        let count = SHADES as u8;
        for shade in 0..count {
            let (y0, y1) = (
                bottom - height * f64::from(shade) / SHADES,
                bottom - height * f64::from(shade + 1) / SHADES,
            );
            // Each one reaches below its upper neighbour, so that no paper shines through.
            let overlap = if shade + 1 < count { 0.5 } else { 0.0 };
            drawn.push(rectangle(
                x,
                y1 - overlap,
                y0 - y1 + overlap,
                Paint::from(Self::hex(shade).as_str()),
                None,
            ));
        }
        drawn.push(rectangle(x, top, height, Paint::None, Some(ink())));
        for (value, text) in self.ticks() {
            let y = bottom - height * (value - self.low) / (self.high - self.low);
            drawn.push(Primitive::Line {
                x1: x + WIDTH,
                y1: y,
                x2: x + WIDTH + TICK,
                y2: y,
                stroke: ink(),
                stroke_width: 1.0,
                stroke_dasharray: None,
            });
            drawn.push(text_at(x + WIDTH + TICK + 3.0, y + 4.0, text, TextAnchor::Start, None));
        }
        let middle = 0.5 * (top + bottom);
        drawn.push(text_at(x + WIDTH + LABEL, middle, self.label.clone(), TextAnchor::Middle, Some(-90.0)));
        drawn
    }

    /// Round values between the ends, with what is written beside them.
    fn ticks(&self) -> Vec<(f64, String)> {
        let (low, high) = (self.low * self.per_unit, self.high * self.per_unit);
        let rough = (high - low) / FEWEST;
        let decade = 10f64.powf(rough.log10().floor());
        let step = decade * [5.0, 2.0].into_iter().find(|round| round * decade <= rough).unwrap_or(1.0);
        let digits = (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize;
        let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
        (first..=last)
            .map(|k| k as f64 * step)
            .map(|shown| (shown / self.per_unit, format!("{shown:.digits$}")))
            .collect()
    }
}

fn rectangle(x: f64, y: f64, height: f64, fill: Paint, stroke: Option<Paint>) -> Primitive {
    let stroke_width = stroke.as_ref().map(|_| 1.0);
    Primitive::Rect { x, y, width: WIDTH, height, fill, stroke, stroke_width, opacity: None }
}

fn text_at(x: f64, y: f64, content: String, anchor: TextAnchor, rotate: Option<f64>) -> Primitive {
    Primitive::Text { x, y, content, size: TEXT, anchor, rotate, bold: false, color: None }
}

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn ends_are_kept_and_what_is_no_number_has_no_shade() {
        let scale = Scale::new("", 1.0, 3.0);
        assert_eq!(scale.shade(1.0), Some(0));
        assert_eq!(scale.shade(3.0), Some(47));
        assert_eq!((scale.shade(-9.0), scale.shade(f64::INFINITY)), (Some(0), Some(47)));
        assert_eq!(scale.shade(f64::NAN), None);
        assert_ne!(scale.shade(1.9), scale.shade(2.1));
    }

    #[test]
    fn ticks_are_round_and_between_the_ends() {
        let texts = |low, high| -> Vec<String> {
            Scale::new("", low, high).ticks().into_iter().map(|(_, text)| text).collect()
        };
        assert_eq!(texts(1.0, 1.4), ["1.0", "1.1", "1.2", "1.3", "1.4"]);
        assert_eq!(texts(0.0, 100.0), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(texts(0.93, 0.962), ["0.930", "0.935", "0.940", "0.945", "0.950", "0.955", "0.960"]);
        // One value, and none: still a bar.
        assert!(!texts(2.0, 2.0).is_empty() && !texts(f64::INFINITY, f64::NEG_INFINITY).is_empty());
    }
}
