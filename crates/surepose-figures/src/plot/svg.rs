//! Output of a drawing as SVG.

use std::fmt::Write as _;

use crate::plot::scene::{Anchor, Area, DASHES, HALO, Pen, PenStyle, Point, Scene, Shape, Text};
use crate::plot::style::Rgb;

/// Renders the drawing as SVG.
pub(crate) fn svg(scene: &Scene) -> String {
    let (width, height) = (Px(scene.width), Px(scene.height));
    let (ink, paper) = (Rgb::INK, Rgb::PAPER);
    let mut writer = Writer { text: String::new(), clips: 0 };
    writer.line(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans,Verdana,sans-serif\" fill=\"{ink}\">"
    ));
    writer.line(&format!("<rect width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>"));
    writer.shapes(&scene.shapes);
    writer.line("</svg>");
    writer.text
}

/// Length in pixels, formatted with two decimals.
struct Px(f64);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Adding 0 turns −0 into 0.
        write!(f, "{}", (self.0 * 100.0).round() / 100.0 + 0.0)
    }
}

struct Writer {
    text: String,
    /// Number of clip paths so far, used for their identifiers.
    clips: usize,
}

impl Writer {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn shapes(&mut self, shapes: &[Shape]) {
        for shape in shapes {
            match shape {
                Shape::Lines { lines, pen } => self.lines(lines, *pen),
                Shape::Rectangles { areas, color } => {
                    let path: String = areas.iter().map(rectangle).collect();
                    self.line(&format!(
                        "<path d=\"{path}\" fill=\"{color}\" shape-rendering=\"crispEdges\"/>"
                    ));
                }
                Shape::Polygon { corners, color } => {
                    self.line(&format!("<path d=\"{}z\" fill=\"{color}\"/>", polyline(corners)));
                }
                // A line of zero length with round ends is a dot.
                Shape::Dots { centers, radius, color } => {
                    let dot = |(x, y): &Point| format!("M{} {}h0", Px(*x), Px(*y));
                    let (path, width) = (centers.iter().map(dot).collect::<String>(), Px(2.0 * radius));
                    self.line(&format!(
                        "<path d=\"{path}\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
                    ));
                }
                Shape::Text(text) => self.label(text),
                Shape::Clip { area, shapes } => {
                    let (clip, path) = (self.clips, rectangle(area));
                    self.clips += 1;
                    self.line(&format!("<clipPath id=\"clip{clip}\"><path d=\"{path}\"/></clipPath>"));
                    self.line(&format!("<g clip-path=\"url(#clip{clip})\">"));
                    self.shapes(shapes);
                    self.line("</g>");
                }
                Shape::Group { at: (x, y), shapes } => {
                    self.line(&format!("<g transform=\"translate({},{})\">", Px(*x), Px(*y)));
                    self.shapes(shapes);
                    self.line("</g>");
                }
            }
        }
    }

    fn lines(&mut self, lines: &[Vec<Point>], Pen { color, width, style }: Pen) {
        if lines.is_empty() {
            return;
        }
        let path: String = lines.iter().map(|line| polyline(line)).collect();
        let [dash, gap] = DASHES;
        let style = match style {
            PenStyle::Round => "stroke-linecap=\"round\" stroke-linejoin=\"round\"".to_owned(),
            PenStyle::Crisp => "shape-rendering=\"crispEdges\"".to_owned(),
            PenStyle::Dashed => format!("stroke-dasharray=\"{dash} {gap}\""),
        };
        self.line(&format!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{}\" {style}/>",
            Px(width)
        ));
    }

    fn label(&mut self, text: &Text) {
        let Text { at: (x, y), content, size, anchor, upright, halo } = text;
        let (x, y) = (Px(*x), Px(*y));
        let mut attributes = format!("x=\"{x}\" y=\"{y}\" font-size=\"{}\"", Px(*size));
        match anchor {
            Anchor::Start => {}
            Anchor::Middle => attributes.push_str(" text-anchor=\"middle\""),
            Anchor::End => attributes.push_str(" text-anchor=\"end\""),
        }
        if *upright {
            let _ = write!(attributes, " transform=\"rotate(-90 {x} {y})\"");
        }
        if *halo {
            let (paper, width) = (Rgb::PAPER, Px(2.0 * HALO));
            let _ = write!(
                attributes,
                " stroke=\"{paper}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            );
        }
        let content = content.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.line(&format!("<text {attributes}>{content}</text>"));
    }
}

fn polyline(points: &[Point]) -> String {
    let mut path = String::new();
    for (i, (x, y)) in points.iter().enumerate() {
        let _ = write!(path, "{}{} {}", if i == 0 { 'M' } else { 'L' }, Px(*x), Px(*y));
    }
    path
}

fn rectangle(area: &Area) -> String {
    let (width, height) = (Px(area.width), Px(area.height));
    format!("M{} {}h{width}v{height}h-{width}z", Px(area.left), Px(area.top))
}
