//! A small SVG writer: unrounded coordinates, deterministic text, no identifiers (so that drawings may share a page).

use super::style::{Color, FONT, INK, TICK_SIZE};
use std::fmt::Write;

/// A point in logical pixels.
pub type Point = (f64, f64);

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width \[px\].
    pub width: f64,
    /// SVG dash pattern; empty for a solid line.
    pub dash: &'static str,
}

impl Stroke {
    /// A solid line.
    pub fn solid(color: Color, width: f64) -> Self {
        Self { color, width, dash: "" }
    }

    /// A dashed line.
    pub fn dashed(color: Color, width: f64, dash: &'static str) -> Self {
        Self { color, width, dash }
    }

    fn attributes(self) -> String {
        let dash = if self.dash.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{}""#, self.dash) };
        format!(r#"stroke="{}" stroke-width="{}"{dash}"#, self.color, number(self.width))
    }
}

/// Which end of a text sits at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The left end.
    Start,
    /// The middle.
    Middle,
    /// The right end.
    End,
}

/// How a text is set; the position is the baseline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Type {
    /// Size \[px\].
    pub size: f64,
    /// Which end sits at the position.
    pub anchor: Anchor,
    /// Colour.
    pub color: Color,
    /// Bold face.
    pub bold: bool,
    /// Reads upwards.
    pub upwards: bool,
}

impl Default for Type {
    fn default() -> Self {
        Self { size: TICK_SIZE, anchor: Anchor::Start, color: INK, bold: false, upwards: false }
    }
}

impl Type {
    /// The usual size with the given anchor.
    pub fn at(anchor: Anchor) -> Self {
        Self { anchor, ..Self::default() }
    }

    /// The same in another colour.
    pub fn colored(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// The same in bold face.
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }
}

/// Marks of points; told apart by shape, not by colour alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Circle.
    Circle,
    /// Square.
    Square,
    /// Triangle pointing up.
    Triangle,
    /// Diamond.
    Diamond,
}

/// The shapes in the order in which they are given out.
pub const MARKS: [Mark; 4] = [Mark::Circle, Mark::Square, Mark::Triangle, Mark::Diamond];

/// A drawing under construction.
#[derive(Debug, Clone)]
pub struct Canvas {
    width: f64,
    height: f64,
    body: String,
}

impl Canvas {
    /// A white canvas.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new() }
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    /// A straight line.
    pub fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// An open polygon.
    pub fn polyline(&mut self, points: &[Point], stroke: Stroke) {
        if points.len() > 1 {
            let (d, style) = (path(points), stroke.attributes());
            self.push(format_args!(r#"<path d="{d}" fill="none" {style} stroke-linejoin="round"/>"#));
        }
    }

    /// A filled polygon, with an outline where a stroke is given.
    pub fn polygon(&mut self, points: &[Point], fill: Color, outline: Option<Stroke>) {
        let style = outline.map_or_else(String::new, |stroke| format!(" {}", stroke.attributes()));
        self.push(format_args!(r#"<path d="{}Z" fill="{fill}"{style} stroke-linejoin="round"/>"#, path(points)));
    }

    /// A filled rectangle from its upper left corner.
    pub fn rectangle(&mut self, corner: Point, width: f64, height: f64, fill: Color, outline: Option<Stroke>) {
        let style = outline.map_or_else(String::new, |stroke| format!(" {}", stroke.attributes()));
        let (x, y, w, h) = (number(corner.0), number(corner.1), number(width.max(0.0)), number(height.max(0.0)));
        self.push(format_args!(r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}"{style}/>"#));
    }

    /// A circle.
    pub fn circle(&mut self, center: Point, radius: f64, fill: Color, outline: Stroke) {
        let (x, y, r, style) = (number(center.0), number(center.1), number(radius), outline.attributes());
        self.push(format_args!(r#"<circle cx="{x}" cy="{y}" r="{r}" fill="{fill}" {style}/>"#));
    }

    /// A mark of about the given radius.
    pub fn mark(&mut self, mark: Mark, (x, y): Point, r: f64, fill: Color, outline: Stroke) {
        match mark {
            Mark::Circle => self.circle((x, y), r, fill, outline),
            Mark::Square => {
                let h = 0.88 * r;
                self.polygon(&[(x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)], fill, Some(outline));
            }
            Mark::Triangle => {
                let points = [(x, y - 1.15 * r), (x + r, y + 0.75 * r), (x - r, y + 0.75 * r)];
                self.polygon(&points, fill, Some(outline));
            }
            Mark::Diamond => {
                let h = 1.2 * r;
                self.polygon(&[(x, y - h), (x + h, y), (x, y + h), (x - h, y)], fill, Some(outline));
            }
        }
    }

    /// A text; markup in it is escaped.
    pub fn text(&mut self, (x, y): Point, text: &str, style: Type) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y) = (number(x), number(y));
        let weight = if style.bold { r#" font-weight="bold""# } else { "" };
        let turn = if style.upwards { format!(r#" transform="rotate(-90 {x} {y})""#) } else { String::new() };
        let (size, color, text) = (number(style.size), style.color, escape(text));
        // Unicode has no lowered c.
        let text = text.replace(
            "_c",
            &format!(r#"<tspan dy="{}" font-size="{}">c</tspan>"#, number(0.2 * style.size), number(0.72 * style.size)),
        );
        let text =
            text.replace("</tspan>,", &format!(r#"</tspan><tspan dy="{}">,</tspan>"#, number(-0.2 * style.size)));
        self.push(format_args!(
            r#"<text x="{x}" y="{y}" font-size="{size}" fill="{color}" text-anchor="{anchor}"{weight}{turn}>{text}</text>"#
        ));
    }

    /// An arrow with a filled head.
    pub fn arrow(&mut self, from: Point, to: Point, stroke: Stroke) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1e-9);
        let (ux, uy) = (dx / length, dy / length);
        let head = (4.5 * stroke.width).clamp(9.0, 14.0);
        let base = (to.0 - head * ux, to.1 - head * uy);
        self.line(from, base, stroke);
        let half = 0.4 * head;
        let wings = [(base.0 - half * uy, base.1 + half * ux), (base.0 + half * uy, base.1 - half * ux)];
        self.polygon(&[to, wings[0], wings[1]], stroke.color, None);
    }

    /// Everything until [`Canvas::unclip`] shows only inside the rectangle.
    pub fn clip(&mut self, corner: Point, width: f64, height: f64) {
        let (x, y, w, h) = (number(corner.0), number(corner.1), number(width), number(height));
        self.push(format_args!(
            r#"<svg x="{x}" y="{y}" width="{w}" height="{h}" viewBox="{x} {y} {w} {h}" overflow="hidden">"#
        ));
    }

    /// Ends the clipping.
    pub fn unclip(&mut self) {
        self.push(format_args!("</svg>"));
    }

    /// The SVG document with its title and text alternative.
    pub fn finish(self, title: &str, alt: &str) -> String {
        let (w, h) = (number(self.width), number(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
             font-family=\"{FONT}\">\n<title>{}</title>\n<desc>{}</desc>\n\
             <rect x=\"0\" y=\"0\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(title),
            escape(alt),
            self.body
        )
    }
}

/// Hundredths of a pixel, without trailing zeros.
fn number(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn path(points: &[Point]) -> String {
    let steps = points.iter().enumerate();
    steps.map(|(i, &(x, y))| format!("{}{} {}", if i == 0 { 'M' } else { 'L' }, number(x), number(y))).collect()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
