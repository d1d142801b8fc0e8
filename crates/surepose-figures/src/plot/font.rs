//! Text widths and outlines in the embedded font DejaVu Sans.

use std::sync::LazyLock;

use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, OutlineBuilder};

use crate::plot::scene::{Anchor, Text};

/// Embedded font. `None`: the font data is invalid, which does not occur.
static FACE: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).ok());

/// Returns the width of a text at this font size \[px].
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let Some(face) = FACE.as_ref() else { return 0.0 };
    let units: u32 = text.chars().map(|letter| u32::from(advance(face, letter))).sum();
    f64::from(units) * size / f64::from(face.units_per_em())
}

/// Returns the glyph outlines relative to the text position. `None`: nothing to draw.
pub(crate) fn outline(text: &Text) -> Option<Path> {
    let face = FACE.as_ref()?;
    let start = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -0.5 * width(&text.content, text.size),
        Anchor::End => -width(&text.content, text.size),
    };
    let scale = text.size as f32 / f32::from(face.units_per_em());
    let mut outliner =
        Outliner { path: PathBuilder::new(), scale, left: start as f32, upright: text.upright };
    for letter in text.content.chars() {
        if let Some(glyph) = face.glyph_index(letter) {
            face.outline_glyph(glyph, &mut outliner);
        }
        outliner.left += scale * f32::from(advance(face, letter));
    }
    outliner.path.finish()
}

fn advance(face: &Face, letter: char) -> u16 {
    face.glyph_index(letter).and_then(|glyph| face.glyph_hor_advance(glyph)).unwrap_or_default()
}

/// Collects glyph outlines, which have an upward y axis and font units.
struct Outliner {
    path: PathBuilder,
    scale: f32,
    left: f32,
    upright: bool,
}

impl Outliner {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        let (along, above) = (self.left + self.scale * x, self.scale * y);
        if self.upright { (-above, -along) } else { (along, -above) }
    }
}

impl OutlineBuilder for Outliner {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use crate::plot::scene::{Anchor, Text};

    use super::{outline, width};

    #[test]
    fn font_contains_all_label_characters() {
        for letter in "Az09 °²σωαφρθΔ·×−–±∞≤√ẋ⁻⁰¹⁵".chars() {
            assert!(width(&letter.to_string(), 12.0) > 2.0, "{letter}");
        }
        assert!(width("iiii", 12.0) < width("mmmm", 12.0));
    }

    #[test]
    fn upright_text_is_rotated_horizontal_text() {
        let lying = Text::new((0.0, 0.0), "speed v [m/s]", 12.0, Anchor::Middle);
        let upright = Text { upright: true, ..lying.clone() };
        let (flat, turned) = (outline(&lying).unwrap().bounds(), outline(&upright).unwrap().bounds());
        assert!(
            (flat.width() - turned.height()).abs() < 1e-3 && (flat.left() + turned.bottom()).abs() < 1e-3
        );
        assert!(outline(&Text::new((0.0, 0.0), "", 12.0, Anchor::End)).is_none());
    }
}
