//! Legends beside the panels.

use super::canvas::{Canvas, Stroke, Type};
use super::marks::Mark;
use super::style::{Color, GREY, TICK_SIZE, WHITE, text_width};

/// What a legend entry shows before its text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Key {
    /// A line.
    Line(Stroke),
    /// A mark; filled or open.
    Mark(Mark, Color, bool),
    /// A patch of colour.
    Patch(Color),
    /// Nothing: the entry is a heading.
    Heading,
}

/// An entry of a legend.
pub type Entry = (Key, String);

/// Width that a legend takes \[px\].
pub fn legend_width(entries: &[Entry]) -> f64 {
    let width = |(key, text): &Entry| {
        let heading = *key == Key::Heading;
        text_width(text, TICK_SIZE, heading) + if heading { 0.0 } else { 44.0 }
    };
    entries.iter().map(width).fold(0.0, f64::max)
}

/// Draws a legend downwards from its upper left corner; returns the lower end.
pub fn legend(canvas: &mut Canvas, left: f64, top: f64, entries: &[Entry]) -> f64 {
    let mut y = top;
    for (key, text) in entries {
        y += if *key == Key::Heading && y > top { 30.0 } else { 21.0 };
        let style = Type::default();
        if *key == Key::Heading {
            canvas.text((left, y), text, style.bold());
            continue;
        }
        canvas.key(text, |canvas| entry(canvas, (left, y), *key, text));
    }
    y
}

/// One entry with its text on the line `y`.
fn entry(canvas: &mut Canvas, (left, y): (f64, f64), key: Key, text: &str) {
    let middle = y - 5.0;
    match key {
        Key::Line(stroke) => canvas.line((left, middle), (left + 36.0, middle), stroke),
        Key::Mark(mark, color, true) => canvas.mark(mark, (left + 18.0, middle), 5.0, color, Stroke::solid(GREY, 0.5)),
        Key::Mark(mark, color, false) => {
            canvas.mark(mark, (left + 18.0, middle), 5.0, WHITE, Stroke::solid(color, 1.6));
        }
        Key::Patch(color) => {
            canvas.rectangle((left + 4.0, middle - 7.0), 28.0, 14.0, color, Some(Stroke::solid(GREY, 0.7)));
        }
        Key::Heading => {}
    }
    canvas.text((left + 44.0, y), text, Type::default());
}
