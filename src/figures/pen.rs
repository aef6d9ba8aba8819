//! How lines and texts look.

use super::style::{Color, Dash, INK, TICK_SIZE};

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width \[px\].
    pub width: f64,
    /// Dashes.
    pub dash: Dash,
}

impl Stroke {
    /// A solid line.
    pub fn solid(color: Color, width: f64) -> Self {
        Self { color, width, dash: Dash::Solid }
    }

    /// A dashed line.
    pub fn dashed(color: Color, width: f64, dash: Dash) -> Self {
        Self { color, width, dash }
    }
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
