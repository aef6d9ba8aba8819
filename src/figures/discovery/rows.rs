//! Rows with names at their left and panels at their right: where they stand, and how names are cut.

use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type};
use crate::figures::style::{GRID, text_width};

/// Size of the names.
pub const SIZE: f64 = 14.0;
/// Widest name before it is cut.
const WIDEST: f64 = 400.0;

/// Rows below each other.
pub struct Rows {
    /// Names, cut where too long.
    pub names: Vec<String>,
    /// Upper end.
    pub top: f64,
    /// Height of a row.
    pub row: f64,
    /// Left edge of the panels.
    pub left: f64,
}

impl Rows {
    /// Rows of these names from `top` on.
    pub fn of(names: impl IntoIterator<Item = String>, top: f64, row: f64) -> Self {
        let names: Vec<String> = names.into_iter().map(cut).collect();
        let widest = names.iter().map(|name| text_width(name, SIZE, false)).fold(0.0, f64::max);
        Self { names, top, row, left: widest + 36.0 }
    }

    /// Height of all rows.
    pub fn height(&self) -> f64 {
        self.row * self.names.len() as f64
    }

    /// Lower end.
    pub fn bottom(&self) -> f64 {
        self.top + self.height()
    }

    /// Middle of a row.
    pub fn y(&self, index: usize) -> f64 {
        self.top + self.row * (index as f64 + 0.5)
    }

    /// A panel over all rows without an axis of its own for them.
    pub fn panel(&self, left: f64, width: f64, x: Axis) -> Panel {
        Panel { left, top: self.top, width, height: self.height(), x, y: Axis::rows() }
    }

    /// The names, and a line along every row of the panels.
    pub fn draw(&self, canvas: &mut Canvas, panels: &[&Panel]) {
        for (index, name) in self.names.iter().enumerate() {
            let y = self.y(index);
            for panel in panels {
                canvas.line((panel.left, y), (panel.right(), y), Stroke::solid(GRID, 1.0));
            }
            canvas.text((self.left - 12.0, y + 5.0), name, Type { size: SIZE, ..Type::at(Anchor::End) });
        }
    }
}

/// A name that fits.
fn cut(name: String) -> String {
    if text_width(&name, SIZE, false) <= WIDEST {
        return name;
    }
    let mut short: String = name;
    while !short.is_empty() && text_width(&short, SIZE, false) > WIDEST - 12.0 {
        short.pop();
    }
    short.trim_end().to_string() + "…"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_cut_and_short_ones_kept() {
        let rows = Rows::of(["a".into(), "rate-strengthening + ".repeat(9)], 10.0, 30.0);
        assert_eq!(rows.names[0], "a");
        assert!(rows.names[1].ends_with('…') && rows.left < WIDEST + 40.0);
        assert_eq!((rows.bottom(), rows.y(1)), (70.0, 55.0));
    }
}
