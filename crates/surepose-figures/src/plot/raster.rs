//! Rasterization of a drawing to PNG.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Mask, Paint, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform,
};

use crate::plot::font;
use crate::plot::scene::{Area, DASHES, HALO, Pen, PenStyle, Point, Scene, Shape, Text};
use crate::plot::style::Rgb;

/// Pixels of the PNG per unit of the drawing.
const SCALE: f32 = 2.0;
/// Maximum side length of the PNG \[px].
const MAX_SIDE: f64 = 32_767.0;

/// Renders the drawing as PNG, or returns the error message.
pub(crate) fn png(scene: &Scene) -> Result<Vec<u8>, String> {
    let pixels = |length: f64| (f64::from(SCALE) * length).ceil().max(1.0);
    let (width, height) = (pixels(scene.width), pixels(scene.height));
    if !(width <= MAX_SIDE && height <= MAX_SIDE) {
        return Err(format!("size: too large (got {width} × {height} px, expected at most {MAX_SIDE} px)"));
    }
    let sheet = Pixmap::new(width as u32, height as u32).ok_or("size: too large for memory")?;
    let mut canvas = Canvas { sheet, mask: None, at: Transform::from_scale(SCALE, SCALE) };
    canvas.sheet.fill(tiny_skia::Color::WHITE);
    canvas.draw(&scene.shapes);
    encoded(&canvas.sheet).map_err(|why| why.to_string())
}

/// Pixel buffer with clip mask and transform.
struct Canvas {
    sheet: Pixmap,
    /// Clip mask. `None`: no clipping.
    mask: Option<Mask>,
    /// Transform from shape coordinates to pixels.
    at: Transform,
}

impl Canvas {
    fn draw(&mut self, shapes: &[Shape]) {
        for shape in shapes {
            match shape {
                Shape::Lines { lines, pen } => self.lines(lines, *pen),
                Shape::Rectangles { areas, color } => self.rectangles(areas, *color),
                Shape::Polygon { corners, color } => {
                    let mut path = PathBuilder::new();
                    extend(&mut path, corners);
                    path.close();
                    self.fill(path, *color, true);
                }
                Shape::Dots { centers, radius, color } => {
                    let mut path = PathBuilder::new();
                    for (x, y) in centers {
                        path.push_circle(*x as f32, *y as f32, *radius as f32);
                    }
                    self.fill(path, *color, true);
                }
                Shape::Text(text) => self.text(text),
                Shape::Clip { area, shapes } => {
                    let outside = self.mask.take();
                    self.mask = self.clip(area);
                    self.draw(shapes);
                    self.mask = outside;
                }
                Shape::Group { at: (x, y), shapes } => {
                    let outside = self.at;
                    self.at = outside.pre_translate(*x as f32, *y as f32);
                    self.draw(shapes);
                    self.at = outside;
                }
            }
        }
    }

    fn lines(&mut self, lines: &[Vec<Point>], pen: Pen) {
        let mut path = PathBuilder::new();
        for line in lines {
            extend(&mut path, line);
        }
        let Some(path) = path.finish() else { return };
        let mut stroke = Stroke { width: pen.width as f32, ..Stroke::default() };
        match pen.style {
            PenStyle::Round => (stroke.line_cap, stroke.line_join) = (LineCap::Round, LineJoin::Round),
            PenStyle::Crisp => {}
            PenStyle::Dashed => {
                stroke.dash = StrokeDash::new(DASHES.map(|length| length as f32).to_vec(), 0.0);
            }
        }
        self.sheet.stroke_path(&path, &paint(pen.color), &stroke, self.at, self.mask.as_ref());
    }

    fn rectangles(&mut self, areas: &[Area], color: Rgb) {
        let mut path = PathBuilder::new();
        for area in areas {
            let (width, height) = (area.width as f32, area.height as f32);
            if let Some(rect) = Rect::from_xywh(area.left as f32, area.top as f32, width, height) {
                path.push_rect(rect);
            }
        }
        self.fill(path, color, false);
    }

    fn text(&mut self, text: &Text) {
        let Some(path) = font::outline(text) else { return };
        let at = self.at.pre_translate(text.at.0 as f32, text.at.1 as f32);
        if text.halo {
            let line_join = LineJoin::Round;
            let stroke = Stroke { width: 2.0 * HALO as f32, line_join, ..Stroke::default() };
            self.sheet.stroke_path(&path, &paint(Rgb::PAPER), &stroke, at, self.mask.as_ref());
        }
        self.sheet.fill_path(&path, &paint(Rgb::INK), FillRule::Winding, at, self.mask.as_ref());
    }

    fn fill(&mut self, path: PathBuilder, color: Rgb, anti_alias: bool) {
        let Some(path) = path.finish() else { return };
        let paint = Paint { anti_alias, ..paint(color) };
        self.sheet.fill_path(&path, &paint, FillRule::Winding, self.at, self.mask.as_ref());
    }

    /// Clip mask of `area`.
    fn clip(&self, area: &Area) -> Option<Mask> {
        let mut mask = Mask::new(self.sheet.width(), self.sheet.height())?;
        let mut path = PathBuilder::new();
        extend(&mut path, &area.outline());
        mask.fill_path(&path.finish()?, FillRule::Winding, false, self.at);
        Some(mask)
    }
}

fn extend(path: &mut PathBuilder, points: &[Point]) {
    for (i, (x, y)) in points.iter().enumerate() {
        let (x, y) = (*x as f32, *y as f32);
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
}

fn paint(Rgb([red, green, blue]): Rgb) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

/// Encodes the opaque image without its alpha channel.
fn encoded(sheet: &Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let colors: Vec<u8> = sheet.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, sheet.width(), sheet.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colors)?;
    writer.finish()?;
    Ok(file)
}
