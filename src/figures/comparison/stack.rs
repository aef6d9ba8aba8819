//! Small multiples for a narrow screen: one below the other, no wider than a phone shows them at a size to be read.

use super::grid::heading;
use crate::figures::FigureError;
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Canvas, Type, document};
use crate::figures::legend::{Entry, legend};

/// Panels of readings at most, so that a phone shows them with what stands below on little more than one screen.
pub const MOST: usize = 4;
/// Width in logical pixels: ticks of 15 of them have 13 on a phone that gives a figure 340.
pub const WIDTH: f64 = 380.0;
/// Room for tick labels; what the axis shows stands above the panels.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 16.0;
/// Height of a panel, above it two lines, below it an axis or a gap \[px\].
const HEIGHT: f64 = 132.0;
const HEADING: f64 = 46.0;
const FOOT: f64 = 58.0;
const GAP: f64 = 12.0;
/// Of a line of the legend and of the lines below it \[px\].
const LINE: f64 = 21.0;

/// A panel and what stands above it.
pub struct Part {
    /// Two lines.
    pub lines: (String, String),
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Whether the horizontal axis has its numbers and its name; else it shares those of a panel below.
    pub foot: bool,
}

/// Panels one below the other under one legend.
pub struct Stack {
    /// The legend above, one entry per line.
    pub legend: Vec<Entry>,
    /// Lines below it: what the vertical axes show, and of how many conditions.
    pub head: Vec<String>,
    /// The panels.
    pub parts: Vec<Part>,
}

impl Stack {
    /// Parts for the first of these conditions, their axes named below the last.
    pub fn conditions(lines: Vec<(String, String)>, (x, y): (&Axis, &Axis)) -> Vec<Part> {
        let last = lines.len().saturating_sub(1);
        let part = |(k, lines)| Part { lines, x: x.clone(), y: y.clone(), foot: k == last };
        lines.into_iter().enumerate().map(part).collect()
    }

    /// Where the first panel has its heading.
    fn top(&self) -> f64 {
        10.0 + LINE * (self.legend.len() + self.head.len()) as f64
    }

    /// The drawing with what `fill` puts into the panel of a number.
    ///
    /// # Errors
    /// [`FigureError::Render`] where plotters refuses an element.
    pub fn draw(&self, words: (&str, &str), fill: impl Fn(&mut Canvas, &Panel, usize)) -> Result<String, FigureError> {
        let below = |part: &Part| if part.foot { FOOT } else { GAP };
        let height = self.top() + self.parts.iter().map(|part| HEADING + HEIGHT + below(part)).sum::<f64>();
        document((WIDTH, height), words, |canvas| {
            let mut y = legend(canvas, 10.0, 0.0, &self.legend);
            for line in &self.head {
                y += LINE;
                canvas.text((10.0, y), line, Type { size: 14.0, ..Type::default() });
            }
            let mut top = self.top();
            for (index, part) in self.parts.iter().enumerate() {
                let (x, y) = (part.x.clone(), part.y.clone());
                let panel = Panel { left: LEFT, top: top + HEADING, width: WIDTH - LEFT - RIGHT, height: HEIGHT, x, y };
                canvas.register(&panel);
                let bare = panel.named(part.foot, false);
                bare.frame(canvas, part.foot, true);
                heading(canvas, &panel, (&part.lines.0, &part.lines.1));
                fill(canvas, &panel, index);
                top += HEADING + HEIGHT + below(part);
            }
        })
    }
}
