//! A thin layer over plotters: logical pixels, and the few shapes that the figures are made of.
//!
//! plotters rounds every coordinate and width to an integer, so it draws on a canvas that is [`FINE`] times larger.
//! It writes no identifiers, so drawings may share a page.

use super::FigureError;
use super::compact::compact;
use super::hooks::{self, Hooks};
pub use super::pen::{Anchor, Stroke, Type};
pub use super::pixels::Point;
use super::pixels::{FINE, fine};
pub use super::style::Dash;
use super::style::{Color, WHITE, text_width, typeface};
use plotters::coord::Shift;
use plotters::element::{Drawable, PointCollection};
use plotters::prelude::*;
use plotters::style::Color as _;
use plotters::style::text_anchor::{HPos, Pos, VPos};

fn line(stroke: Stroke) -> ShapeStyle {
    ShapeStyle { stroke_width: fine(stroke.width).max(1) as u32, filled: false, ..fill(stroke.color) }
}

fn fill(Color(red, green, blue): Color) -> ShapeStyle {
    RGBColor(red, green, blue).filled()
}

/// A drawing under construction.
pub struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
    failure: Option<String>,
    pub(super) hooks: Hooks,
}

/// The SVG document of that width and height with its title and text alternative, as `draw` draws it on white.
///
/// # Errors
/// [`FigureError::Render`] where plotters refuses an element.
pub fn document(
    (width, height): (f64, f64),
    (title, alt): (&str, &str),
    draw: impl FnOnce(&mut Canvas<'_>),
) -> Result<String, FigureError> {
    let mut svg = String::new();
    let backend = SVGBackend::with_string(&mut svg, (fine(width) as u32, fine(height) as u32));
    let mut canvas = Canvas { area: backend.into_drawing_area(), failure: None, hooks: Hooks::default() };
    canvas.rectangle((0.0, 0.0), width, height, WHITE, None);
    draw(&mut canvas);
    let done = canvas.area.present().map_err(|error| error.to_string());
    if let Some(reason) = canvas.failure.take().or(done.err()) {
        return Err(FigureError::Render(reason));
    }
    let hooks = std::mem::take(&mut canvas.hooks);
    drop(canvas);
    Ok(dress(&svg, &hooks, (width, height), (title, alt)))
}

/// Sets the outer size back to logical pixels, and adds what plotters cannot write: title and text alternative, round
/// corners of lines, and baselines exactly where they were asked for.
fn dress(svg: &str, hooks: &Hooks, (width, height): (f64, f64), (title, alt): (&str, &str)) -> String {
    let body = svg.split_once('\n').map_or("", |(_, body)| body);
    let body = body.replace(r#" dy="-0.5ex""#, "").replace(r#" opacity="1""#, "");
    let body = compact(&hooks::dress(&body, hooks));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" role=\"img\" \
         stroke-linejoin=\"round\">\n<title>{}</title>\n<desc>{}</desc>\n{body}",
        fine(width),
        fine(height),
        hooks::escape(title),
        hooks::escape(alt)
    )
}

fn pixel((x, y): Point) -> (i32, i32) {
    (fine(x), fine(y))
}

fn pixels(points: &[Point]) -> Vec<(i32, i32)> {
    points.iter().map(|&point| pixel(point)).collect()
}

impl<'a> Canvas<'a> {
    fn put<E>(&mut self, element: E)
    where
        E: Drawable<SVGBackend<'a>>,
        for<'b> &'b E: PointCollection<'b, (i32, i32)>,
    {
        if let Err(error) = self.area.draw(&element) {
            self.failure.get_or_insert(error.to_string());
        }
    }

    /// A circle larger than any drawing, which stands for one end of a group.
    fn end(&mut self, number: i32) {
        self.put(Circle::new((0, 0), hooks::HUGE + number, fill(WHITE)));
    }

    /// Draws into a group that opens with this tag.
    pub(super) fn group<R>(&mut self, tag: String, draw: impl FnOnce(&mut Self) -> R) -> R {
        let number = self.hooks.open(tag);
        self.end(number);
        let drawn = draw(self);
        self.end(hooks::END);
        drawn
    }

    /// A straight line.
    pub fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// An open polygon.
    pub fn polyline(&mut self, points: &[Point], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        let (points, style) = (pixels(points), line(stroke));
        let dashes = match stroke.dash {
            Dash::Solid => return self.put(PathElement::new(points, style)),
            Dash::Dashes(size, gap) => format!("stroke-dasharray=\"{},{}\"", fine(size), fine(gap)),
            Dash::DashDots(size, gap) => {
                // Round ends lengthen dashes by the width, and make dots of dashes without length.
                let (size, gap) = (fine((size - stroke.width).max(0.0)), fine(0.5 * (gap + stroke.width)));
                format!("stroke-dasharray=\"{size},{gap},0,{gap}\" stroke-linecap=\"round\"")
            }
        };
        self.group(format!("<g {dashes}>"), |canvas| canvas.put(PathElement::new(points, style)));
    }

    /// A filled polygon, with an outline where a stroke is given.
    pub fn polygon(&mut self, points: &[Point], color: Color, outline: Option<Stroke>) {
        self.put(Polygon::new(pixels(points), fill(color)));
        if let Some(stroke) = outline {
            // The first side twice, so that the last corner is joined too.
            let closed: Vec<Point> = points.iter().chain(points.iter().take(2)).copied().collect();
            self.polyline(&closed, stroke);
        }
    }

    /// A filled rectangle from its upper left corner.
    pub fn rectangle(&mut self, (x, y): Point, width: f64, height: f64, color: Color, outline: Option<Stroke>) {
        let (right, bottom) = (x + width.max(0.0), y + height.max(0.0));
        match outline {
            None => self.put(Rectangle::new([pixel((x, y)), pixel((right, bottom))], fill(color))),
            Some(_) => self.polygon(&[(x, y), (right, y), (right, bottom), (x, bottom)], color, outline),
        }
    }

    /// A circle.
    pub fn circle(&mut self, center: Point, radius: f64, color: Color, outline: Stroke) {
        self.put(Circle::new(pixel(center), fine(radius), fill(color)));
        self.put(Circle::new(pixel(center), fine(radius), line(outline)));
    }

    /// A filled circle without outline.
    pub fn dot(&mut self, center: Point, radius: f64, color: Color) {
        self.put(Circle::new(pixel(center), fine(radius), fill(color)));
    }

    /// A text; `_c` in it lowers the c, for which Unicode has no character.
    pub fn text(&mut self, (mut x, y): Point, text: &str, style: Type) {
        if !text.contains("_c") {
            return self.words((x, y), text, style);
        }
        let small = Type { size: 0.72 * style.size, ..style };
        let mut pieces = Vec::new();
        for (index, piece) in text.split("_c").enumerate() {
            if index > 0 {
                pieces.push((0.2 * style.size, "c", small));
            }
            pieces.push((0.0, piece, style));
        }
        let width: f64 = pieces.iter().map(|(_, piece, style)| text_width(piece, style.size, style.bold)).sum();
        x -= match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        for (drop, piece, style) in pieces {
            x += text_width(piece, style.size, style.bold);
            // SVG drops leading spaces.
            let seen = piece.trim_start();
            if !seen.is_empty() {
                let left = x - text_width(seen, style.size, style.bold);
                self.words((left, y + drop), seen, Type { anchor: Anchor::Start, ..style });
            }
        }
    }

    fn words(&mut self, at: Point, text: &str, style: Type) {
        let color = fill(style.color).color;
        let anchor = match style.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let turn = if style.upwards { FontTransform::Rotate270 } else { FontTransform::None };
        // plotters writes its sizes divided by 1.24.
        let font = typeface(1.24 * FINE * style.size, style.bold).transform(turn);
        let look = TextStyle::from(font).color(&color).pos(Pos::new(anchor, VPos::Bottom));
        self.put(Text::new(text.to_string(), pixel(at), look));
    }
}

#[cfg(test)]
mod tests {
    use super::super::style::INK;
    use super::*;

    #[test]
    fn a_document_has_its_outer_size_its_words_and_fine_coordinates() {
        let svg = document((20.0, 10.0), ("a < b", "c & d"), |canvas| {
            canvas.line((0.25, 1.0), (20.0, 9.96), Stroke::solid(INK, 1.5));
            canvas.text((3.0, 4.0), "k_c & x", Type::default());
        });
        let svg = svg.unwrap();
        assert!(svg.starts_with(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10\" viewBox=\"0 0 320 160\""
        ));
        assert!(svg.contains("<title>a &lt; b</title>\n<desc>c &amp; d</desc>"), "{svg}");
        assert!(svg.contains(r#"stroke-width="24" points="4,16 320,159 ""#), "{svg}");
        assert!(svg.matches("<text").count() == 3 && !svg.contains(" dy="), "{svg}");
        assert!(svg.contains("\n&amp; x\n") && svg.trim_end().ends_with("</svg>"), "{svg}");
    }

    #[test]
    fn dashes_are_attributes_of_one_line_and_dots_lie_between_them() {
        let draw = |dash| {
            let line = |canvas: &mut Canvas<'_>| canvas.line((0.0, 5.0), (40.0, 5.0), Stroke::dashed(INK, 2.0, dash));
            document((40.0, 10.0), ("", ""), line).unwrap()
        };
        let dashed = draw(Dash::Dashes(6.0, 4.0));
        assert!(dashed.contains("<g stroke-dasharray=\"96,64\">\n<polyline") && dashed.contains("</g>"), "{dashed}");
        let dotted = draw(Dash::DashDots(6.0, 4.0));
        assert!(dotted.contains(r#"<g stroke-dasharray="64,48,0,48" stroke-linecap="round">"#), "{dotted}");
    }
}
