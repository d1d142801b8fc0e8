//! A drawing as PNG, its upright labels as sharp as the others.
//!
//! The library turns a label by sampling its pixels between them, which smears it. Labels are turned by a quarter turn
//! only, so they are drawn lying here, on a sheet of their own, and the sheet is turned pixel by pixel.

use std::io::Cursor;

use kuva::PngBackend;
use kuva::render::render::{Primitive, Scene};

/// Pixels of the PNG for each unit of the drawing.
const SCALE: f32 = 2.0;

/// A quarter turn to the left, as the library counts \[°].
const UPWARDS: f64 = -90.0;

/// The drawing as PNG; or why it cannot be one.
pub(crate) fn png(scene: &Scene) -> Result<Vec<u8>, String> {
    let is_upright = |element: &Primitive| matches!(element, Primitive::Text { rotate: Some(turn), .. } if *turn == UPWARDS);
    let mut level = Scene::new(scene.width, scene.height);
    level.elements = scene.elements.iter().filter(|element| !is_upright(element)).cloned().collect();
    let mut sheet = Pixels::of(&level)?;

    let side = f64::from(sheet.height) / f64::from(SCALE);
    let mut lying = Scene::new(side, f64::from(sheet.width) / f64::from(SCALE));
    lying.elements = lying_labels(&scene.elements, side);
    if !lying.elements.is_empty() {
        sheet.darken_by(&Pixels::of(&lying)?);
    }
    sheet.encoded()
}

/// The upright labels of a drawing that is `height` high, where they lie once it is turned to the right.
fn lying_labels(elements: &[Primitive], height: f64) -> Vec<Primitive> {
    // Parts of a picture are moved to their places, and may be so within each other.
    let mut origins = vec![(0.0, 0.0)];
    let mut labels = Vec::new();
    for element in elements {
        let (left, top) = origins.last().copied().unwrap_or_default();
        match element {
            Primitive::GroupStart { transform, .. } => {
                let (x, y) = transform.as_deref().and_then(translation).unwrap_or_default();
                origins.push((left + x, top + y));
            }
            Primitive::GroupEnd if origins.len() > 1 => {
                origins.pop();
            }
            Primitive::Text { x, y, rotate: Some(turn), .. } if *turn == UPWARDS => {
                let mut label = element.clone();
                if let Primitive::Text { x: lying_x, y: lying_y, rotate, .. } = &mut label {
                    (*lying_x, *lying_y, *rotate) = (height - (top + y), left + x, None);
                }
                labels.push(label);
            }
            _ => {}
        }
    }
    labels
}

/// The two numbers of `translate(x,y)`.
fn translation(transform: &str) -> Option<(f64, f64)> {
    let inner = transform.trim().strip_prefix("translate(")?.strip_suffix(')')?;
    let (x, y) = inner.split_once([',', ' '])?;
    Some((x.trim().parse().ok()?, y.trim().parse().ok()?))
}

/// An image, four bytes a pixel.
struct Pixels {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl Pixels {
    fn of(scene: &Scene) -> Result<Self, String> {
        let file = PngBackend::new().with_scale(SCALE).render_scene(scene)?;
        let mut reader = png::Decoder::new(Cursor::new(file)).read_info().map_err(|why| why.to_string())?;
        let size = reader.output_buffer_size().ok_or("too large for memory")?;
        let mut bytes = vec![0; size];
        let info = reader.next_frame(&mut bytes).map_err(|why| why.to_string())?;
        Ok(Self { width: info.width, height: info.height, bytes })
    }

    /// Multiplies each pixel by that of `sheet`, which is dark on white, turned to the left.
    fn darken_by(&mut self, sheet: &Self) {
        for (y, row) in self.bytes.chunks_exact_mut(4 * self.width as usize).enumerate() {
            for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
                // What is at (x, y) lay in the sheet's row x, as far from its right end as from the top here.
                let Some(along) = (sheet.width as usize).checked_sub(y + 1) else { continue };
                let at = 4 * (x * sheet.width as usize + along);
                let ink = sheet.bytes.get(at..at + 3).unwrap_or_default();
                for (value, ink) in pixel.iter_mut().zip(ink) {
                    *value = (u16::from(*value) * u16::from(*ink) / 255) as u8;
                }
            }
        }
    }

    fn encoded(&self) -> Result<Vec<u8>, String> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(Cursor::new(&mut file), self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(|why| why.to_string())?;
        writer.write_image_data(&self.bytes).map_err(|why| why.to_string())?;
        writer.finish().map_err(|why| why.to_string())?;
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use kuva::render::render::{Primitive, Scene, TextAnchor};

    use super::{Pixels, png};

    fn text(x: f64, y: f64, rotate: Option<f64>) -> Primitive {
        let (content, anchor) = ("speed v [m/s]".to_owned(), TextAnchor::Middle);
        Primitive::Text { x, y, content, size: 12, anchor, rotate, bold: false, color: None }
    }

    /// An upright label has the very pixels of a lying one, in its place, also within a part that is moved.
    #[test]
    fn an_upright_label_is_a_lying_one_turned() {
        let (mut upright, mut lying) = (Scene::new(60.0, 200.0), Scene::new(200.0, 60.0));
        let moved = Some("translate(10,30)".to_owned());
        upright.elements = vec![
            Primitive::GroupStart { transform: moved, title: None, extra_attrs: None },
            text(20.0, 70.0, Some(-90.0)),
            Primitive::GroupEnd,
        ];
        lying.elements = vec![text(100.0, 30.0, None)];
        let decoded = |file: Vec<u8>| {
            let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
            let mut bytes = vec![0; reader.output_buffer_size().expect("small")];
            reader.next_frame(&mut bytes).expect("an image");
            bytes
        };
        let (turned, flat) = (decoded(png(&upright).expect("drawn")), Pixels::of(&lying).expect("drawn"));
        let mut dark = 0;
        for (x, y) in (0..120).flat_map(|x| (0..400).map(move |y| (x, y))) {
            let (here, there) = (turned[4 * (y * 120 + x)], flat.bytes[4 * (x * 400 + 399 - y)]);
            assert_eq!(here, there, "at {x}, {y}");
            dark += usize::from(here < 128);
        }
        assert!(dark > 100, "{dark}");
    }
}
