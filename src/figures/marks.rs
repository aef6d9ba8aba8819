//! Shapes put together from simpler ones: marks of points, and arrows.

use super::canvas::{Canvas, Point, Stroke};
use super::style::Color;

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

impl Canvas<'_> {
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
}
