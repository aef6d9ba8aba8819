//! Where small multiples stand, and what they share: headings, a legend in rows above.

use crate::figures::axes::Panel;
use crate::figures::canvas::{Canvas, Type};
use crate::figures::legend::{Entry, legend, legend_width};
use crate::figures::style::{GAP, LEFT, RIGHT, WIDTH};

/// Above a panel: two lines of heading.
const HEADING: f64 = 52.0;
/// Between a panel and its strip.
const CLEARANCE: f64 = 10.0;
/// Below the lowest panel of a column: tick labels and axis label.
const FOOT: f64 = 58.0;

/// Panels in rows and columns, each with a strip beneath.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Number of panels.
    pub count: usize,
    /// Panels side by side.
    pub columns: usize,
    /// Upper end.
    pub top: f64,
    /// Height of the panel proper.
    pub main: f64,
    /// Height of the strip.
    pub strip: f64,
}

/// The place of one panel of a grid.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Left edge.
    pub left: f64,
    /// Upper edge of the panel proper.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Upper edge of the strip.
    pub strip: f64,
    /// Whether the panel is the first of its row.
    pub first: bool,
    /// Whether the panel is the last of its column.
    pub last: bool,
}

impl Grid {
    /// A grid for that many panels.
    pub fn of(count: usize, top: f64) -> Self {
        let (columns, main, strip) = match count {
            0 | 1 => (1, 320.0, 80.0),
            2 => (2, 250.0, 70.0),
            3 => (3, 210.0, 64.0),
            4 => (2, 210.0, 64.0),
            5 | 6 => (3, 180.0, 58.0),
            _ => (4, 150.0, 54.0),
        };
        Self { count, columns, top, main, strip }
    }

    /// Height of a row with its heading.
    fn row(&self) -> f64 {
        HEADING + self.main + CLEARANCE + self.strip
    }

    /// Lower end of the figure.
    pub fn bottom(&self) -> f64 {
        self.top + self.row() * self.count.div_ceil(self.columns).max(1) as f64 + FOOT
    }

    /// Middle of the panels in height.
    pub fn middle(&self) -> f64 {
        0.5 * (self.top + self.bottom() - FOOT)
    }

    /// The place of a panel.
    pub fn cell(&self, index: usize) -> Cell {
        let (row, column) = (index / self.columns, index % self.columns);
        let width = (WIDTH - LEFT - RIGHT - GAP * (self.columns - 1) as f64) / self.columns as f64;
        let top = self.top + self.row() * row as f64 + HEADING;
        Cell {
            left: LEFT + (width + GAP) * column as f64,
            top,
            width,
            strip: top + self.main + CLEARANCE,
            first: column == 0,
            last: index + self.columns >= self.count,
        }
    }
}

/// Two lines above a panel, the first in bold face.
pub fn heading(canvas: &mut Canvas, panel: &Panel, lines: (&str, &str)) {
    canvas.text((panel.left, panel.top - 26.0), lines.0, Type::default().bold());
    canvas.text((panel.left, panel.top - 8.0), lines.1, Type { size: 14.0, ..Type::default() });
}

/// A legend in rows across the figure.
pub struct Rows {
    entries: Vec<Entry>,
    step: f64,
    per_row: usize,
}

impl Rows {
    /// Entries side by side, as many as fit.
    pub fn of(entries: Vec<Entry>) -> Self {
        let step = legend_width(&entries) + 30.0;
        let per_row = (((WIDTH - LEFT) / step) as usize).clamp(1, entries.len().max(1));
        Self { entries, step, per_row }
    }

    /// Height that it takes.
    pub fn height(&self) -> f64 {
        22.0 * self.entries.len().div_ceil(self.per_row) as f64 + 10.0
    }

    /// Draws it from the top.
    pub fn draw(&self, canvas: &mut Canvas) {
        for (index, entry) in self.entries.iter().enumerate() {
            let (row, column) = (index / self.per_row, index % self.per_row);
            legend(canvas, LEFT + self.step * column as f64, 4.0 + 22.0 * row as f64, std::slice::from_ref(entry));
        }
    }
}
