//! Panels as they are drawn: frames with ticks and labels, curves and marks.

use super::axes::Panel;
use super::canvas::{Anchor, Canvas, Point, Stroke, Type};
use super::clip;
use super::marks::Mark;
use super::style::{Color, GRID, INK, LABEL_SIZE, TICK_SIZE, WHITE};

const X_SPACING: f64 = 88.0;
const Y_SPACING: f64 = 46.0;

impl Panel {
    /// Grid, frame, ticks and labels; tick labels and label of the horizontal axis only where `below` is set, those of
    /// the vertical axis only where `beside` is set.
    pub fn frame(&self, canvas: &mut Canvas, below: bool, beside: bool) {
        canvas.ticks(self, (below, beside), |canvas| self.grid(canvas));
        self.border(canvas, -1.0);
        self.labels(canvas, below, beside);
    }

    /// Lines at the named ticks.
    fn grid(&self, canvas: &mut Canvas) {
        let grid = Stroke::solid(GRID, 1.0);
        for (value, _) in self.x.ticks(self.width, X_SPACING).iter().filter(|(_, label)| !label.is_empty()) {
            canvas.line((self.px(*value), self.top), (self.px(*value), self.bottom()), grid);
        }
        for (value, _) in self.y.ticks(self.height, Y_SPACING).iter().filter(|(_, label)| !label.is_empty()) {
            canvas.line((self.left, self.py(*value)), (self.right(), self.py(*value)), grid);
        }
    }

    /// Frame with its tick marks; they point outwards for `direction` 1, inwards for -1.
    pub fn border(&self, canvas: &mut Canvas, direction: f64) {
        let thin = Stroke::solid(INK, 1.2);
        let length = |label: &str| direction * if label.is_empty() { 3.5 } else { 6.5 };
        canvas.ticks(self, (false, false), |canvas| {
            for (value, label) in self.x.ticks(self.width, X_SPACING) {
                let x = self.px(value);
                canvas.line((x, self.bottom()), (x, self.bottom() + length(&label)), thin);
            }
            for (value, label) in self.y.ticks(self.height, Y_SPACING) {
                let y = self.py(value);
                canvas.line((self.left, y), (self.left - length(&label), y), thin);
            }
        });
        let (l, r, t, b) = (self.left, self.right(), self.top, self.bottom());
        canvas.polyline(&[(l, t), (r, t), (r, b), (l, b), (l, t)], thin);
    }

    /// Tick labels and axis labels below and beside the panel.
    pub fn labels(&self, canvas: &mut Canvas, below: bool, beside: bool) {
        let style = Type { size: LABEL_SIZE, anchor: Anchor::Middle, ..Type::default() };
        let named = |ticks: Vec<(f64, String)>| ticks.into_iter().filter(|(_, label)| !label.is_empty());
        if below {
            canvas.ticks(self, (true, false), |canvas| {
                for (value, label) in named(self.x.ticks(self.width, X_SPACING)) {
                    canvas.text((self.px(value), self.bottom() + 21.0), &label, Type::at(Anchor::Middle));
                }
            });
            canvas.text((self.left + 0.5 * self.width, self.bottom() + 46.0), &self.x.label, style);
        }
        if beside {
            canvas.ticks(self, (false, true), |canvas| {
                for (value, label) in named(self.y.ticks(self.height, Y_SPACING)) {
                    let position = (self.left - 9.0, self.py(value) + 0.36 * TICK_SIZE);
                    canvas.text(position, &label, Type::at(Anchor::End));
                }
            });
            let position = (self.left - 68.0, self.top + 0.5 * self.height);
            canvas.text(position, &self.y.label, Type { upwards: true, ..style });
        }
    }

    /// A curve, clipped to the panel and interrupted where a value is missing.
    pub fn curve(&self, canvas: &mut Canvas, points: &[Point], stroke: Stroke) {
        let pixels: Vec<Point> = points.iter().map(|&(x, y)| (self.px(x), self.py(y))).collect();
        let window = ((self.left, self.top), (self.right(), self.bottom()));
        let runs = clip::polyline(&pixels, window);
        if !runs.is_empty() {
            canvas.within(self, |canvas| runs.iter().for_each(|run| canvas.polyline(&clip::thinned(run), stroke)));
        }
    }

    /// Marks at the points that lie in the panel; a mark without fill is open.
    pub fn marks(&self, canvas: &mut Canvas, points: &[Point], mark: Mark, radius: f64, color: Color, filled: bool) {
        let outline = if filled { Stroke::solid(WHITE, 0.8) } else { Stroke::solid(color, 1.6) };
        let (across, up) = (self.left - 0.5..=self.right() + 0.5, self.top - 0.5..=self.bottom() + 0.5);
        let pixels = points.iter().map(|&(x, y)| (self.px(x), self.py(y)));
        let inside: Vec<Point> = pixels.filter(|(x, y)| across.contains(x) && up.contains(y)).collect();
        if !inside.is_empty() {
            let color_inside = if filled { color } else { WHITE };
            let draw = |canvas: &mut Canvas, at| canvas.mark(mark, at, radius, color_inside, outline);
            canvas.within(self, |canvas| inside.iter().for_each(|&at| draw(canvas, at)));
        }
    }

    /// Bold text above the upper left corner.
    pub fn heading(&self, canvas: &mut Canvas, text: &str) {
        canvas.text((self.left, self.top - 9.0), text, Type::default().bold());
    }
}
