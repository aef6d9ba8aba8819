//! Small multiples: for each condition a panel of values over a strip of errors, under one legend.

use super::grid::{Cell, Grid, Rows, heading};
use super::sigma::{BAND, Sigma};
use crate::figures::FigureError;
use crate::figures::axes::{Axis, Panel, range};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::legend::Entry;
use crate::figures::style::{GREY, INK, LABEL_SIZE, LEFT, SHADE, WIDTH, significant};

/// What all panels share.
pub struct Multiples<'a> {
    /// The legend above.
    pub legend: Vec<Entry>,
    /// Label of the values.
    pub label: String,
    /// Frequencies.
    pub x: Axis,
    /// Values.
    pub y: Axis,
    /// Scale of the errors.
    pub scale: &'a Sigma,
    /// The number of every panel's condition, and what is said of it.
    pub shown: Vec<(usize, (String, String))>,
}

/// An axis of frequencies of that name with a margin.
pub fn frequencies(label: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let (low, high) = range(values);
    let margin = if high > low { 0.02 * (high - low) } else { 0.0 };
    Axis::frequency(label, low - margin, high + margin)
}

impl Multiples<'_> {
    /// The drawing with what `values` puts into the panel and `errors` into the strip of a condition.
    pub fn draw(
        self,
        words: (&str, &str),
        values: impl Fn(&mut Canvas, &Panel, usize),
        errors: impl Fn(&mut Canvas, &Panel, usize),
    ) -> Result<String, FigureError> {
        let rows = Rows::of(self.legend.clone());
        let grid = Grid::of(self.shown.len(), rows.height());
        document((WIDTH, grid.bottom()), words, |canvas| {
            rows.draw(canvas);
            let upright = Type { size: LABEL_SIZE, anchor: Anchor::Middle, upwards: true, ..Type::default() };
            canvas.text((LEFT - 74.0, grid.middle()), &self.label, upright);
            for (index, (condition, lines)) in self.shown.iter().enumerate() {
                let condition = *condition;
                let at = grid.cell(index);
                let Cell { left, top, width, .. } = at;
                let y = Axis { label: self.label.clone(), ..self.y.clone() };
                let main = Panel { left, top, width, height: grid.main, x: self.x.clone(), y };
                canvas.register(&main);
                // All panels share one label beside them.
                let bare = Panel { y: Axis { label: String::new(), ..main.y.clone() }, ..main.clone() };
                bare.frame(canvas, false, at.first);
                heading(canvas, &main, (&lines.0, &lines.1));
                values(canvas, &main, condition);
                let strip = Panel { top: at.strip, height: grid.strip, y: self.scale.axis("error [σ]"), ..main };
                self.ground(canvas, &strip);
                errors(canvas, &strip, condition);
                self.edge(canvas, &strip, &at);
            }
        })
    }

    /// The band of plausible errors and the line of none.
    fn ground(&self, canvas: &mut Canvas, strip: &Panel) {
        let band = self.scale.place(BAND);
        canvas.areas(strip, |canvas| {
            canvas.rectangle((strip.left, strip.py(band)), strip.width, strip.py(-band) - strip.py(band), SHADE, None);
            canvas.line((strip.left, strip.py(0.0)), (strip.right(), strip.py(0.0)), Stroke::solid(GREY, 0.8));
        });
    }

    /// Frame, ticks and labels of a strip.
    fn edge(&self, canvas: &mut Canvas, strip: &Panel, at: &Cell) {
        strip.border(canvas, 0.0);
        strip.labels(canvas, at.last, false);
        canvas.ticks(strip, (false, false), |canvas| {
            for tick in self.scale.ticks().into_iter().flat_map(|tick| [-tick, tick]) {
                let y = strip.py(self.scale.place(tick));
                canvas.line((strip.left, y), (strip.left + 4.0, y), Stroke::solid(INK, 1.0));
            }
        });
        if at.first {
            let small = Type { size: 13.0, ..Type::at(Anchor::End) };
            let top = self.scale.top();
            canvas.ticks(strip, (false, true), |canvas| {
                for (tick, text) in [(top, significant(top, 3)), (0.0, "0".into()), (-top, significant(-top, 3))] {
                    canvas.text((strip.left - 6.0, strip.py(self.scale.place(tick)) + 4.5), &text, small);
                }
            });
            let upright = Type { size: 13.0, anchor: Anchor::Middle, upwards: true, ..Type::default() };
            canvas.text((strip.left - 52.0, strip.top + 0.5 * strip.height), "error [σ]", upright);
        }
    }
}
