//! Measured points with error bars over the curve of the model, one panel per condition, the error beneath each.

mod text;

use super::multiples::{Multiples, frequencies};
use super::sigma::{BAND, Sigma};
use super::stack::{self, Stack};
use super::words::{self, Amplitude};

use crate::compare::{Compared, Comparison};
use crate::figures::axes::{Axis, Panel, range};
use crate::figures::canvas::{Canvas, Point, Stroke};
use crate::figures::legend::{Entry, Key};
use crate::figures::marks::Mark;
use crate::figures::resonance::{phase_axis, unbroken};
use crate::figures::style::{Color, INK, SHADE, SLIP, STATIC, count};
use crate::figures::{Drawing, Figure, FigureError};
use crate::fit::Prediction;
use std::f64::consts::PI;

/// Standard deviations on either side of a point that its bar spans.
pub const BAR: f64 = 1.96;
const MODEL: Color = STATIC;
/// Names of what is drawn.
pub const MEASURED: &str = "measured, 95 % bars";
const AMPLITUDES: &str = "error of amplitude";
const PHASES: &str = "error of phase";

/// What to do where there is no contact.
const ALONE: &str = "See whether the swing is in every panel or grows with the drive: the first is a number of the rig or the \
                     instrument, the second a force that is not linear.";

/// Amplitudes, or their companion for phases.
pub struct Overlay {
    phase: bool,
}

/// Amplitudes.
pub const AMPLITUDE: Overlay = Overlay { phase: false };
/// Phases.
pub const PHASE: Overlay = Overlay { phase: true };

/// What is shown.
pub struct Data<'a> {
    c: &'a Comparison,
    phase: bool,
    /// Whether phases lie on the branch from -270° to 90°.
    pub wraps: bool,
    amplitude: Amplitude,
    scale: Sigma,
    shown: Vec<usize>,
}

impl<'a> Data<'a> {
    /// What a comparison holds, for amplitudes or for phases.
    pub fn of(c: &'a Comparison, phase: bool) -> Self {
        let (low, high) = range(c.points.iter().flat_map(|p| [p.point.phase, Some(p.model.phase)]).flatten());
        let residuals = c.points.iter().flat_map(|p| [Some(p.amplitude_residual).filter(|_| !phase), p.phase_residual]);
        Self {
            c,
            phase,
            wraps: high > 0.5 * PI && low < -0.5 * PI,
            amplitude: Amplitude::of(c),
            scale: Sigma::over(residuals.flatten()),
            shown: words::shown(c).0,
        }
    }

    /// A phase in degrees; on the branch from -270° to 90° where the data cross -180°.
    fn degrees(&self, phase: f64) -> f64 {
        (if self.wraps && phase > 0.5 * PI { phase - 2.0 * PI } else { phase }).to_degrees()
    }

    /// The points of a condition.
    pub fn points(&self, condition: usize) -> impl Iterator<Item = &'a Compared> + use<'a> {
        self.c.points.iter().filter(move |p| p.condition == condition)
    }

    /// Frequency, value and half the length of the bar.
    pub fn measured(&self, condition: usize) -> Vec<(f64, f64, f64)> {
        let of = |p: &Compared| {
            let f = p.point.frequency;
            if self.phase {
                return Some((f, self.degrees(p.point.phase?), BAR * p.point.phase_sd.unwrap_or(0.0).to_degrees()));
            }
            let value = |a: f64| self.amplitude.value(a, p.point.drive);
            Some((f, value(p.point.amplitude), BAR * value(p.point.amplitude_sd)))
        };
        self.points(condition).filter_map(of).collect()
    }

    /// The curve of the model, as shown.
    pub fn curve(&self, condition: usize) -> Vec<Point> {
        let curve = &self.c.curves()[condition];
        let pairs = curve.frequency.iter().zip(if self.phase { &curve.phase } else { &curve.amplitude });
        let value = |(y, drive): (f64, f64)| match self.phase {
            true => self.degrees(y),
            false => self.amplitude.value(y, drive),
        };
        pairs.zip(&curve.drive).map(|((&f, &y), &drive)| (f, value((y, drive)))).collect()
    }

    /// What a model says of a reading under that drive, as shown.
    pub fn modelled(&self, prediction: &Prediction, drive: f64) -> f64 {
        if self.phase { self.degrees(prediction.phase) } else { self.amplitude.value(prediction.amplitude, drive) }
    }

    /// The parts of a curve to be joined: phases are not across half a turn.
    pub fn runs<'b>(&self, curve: &'b [Point]) -> Vec<&'b [Point]> {
        if self.phase { unbroken(curve) } else { vec![curve] }
    }

    /// Name and unit of the values.
    pub fn label(&self) -> String {
        if self.phase { "phase φ [°]".into() } else { self.amplitude.label() }
    }

    /// An axis for values, and for the readings of the conditions shown.
    pub fn axis(&self, shown: &[usize], values: impl IntoIterator<Item = f64>) -> Axis {
        let bars = shown.iter().flat_map(|&i| self.measured(i)).flat_map(|(_, y, bar)| [y - bar, y + bar]);
        let values = bars.chain(values);
        if self.phase { phase_axis(values) } else { Axis::around("", values) }
    }

    /// Draws the readings of a condition with their bars.
    pub fn readings(&self, canvas: &mut Canvas, panel: &Panel, condition: usize) {
        let points = self.measured(condition);
        canvas.series(MEASURED, |canvas| {
            canvas.within(panel, |canvas| {
                for &(f, y, bar) in &points {
                    panel.curve(canvas, &[(f, y - bar), (f, y + bar)], Stroke::solid(INK, 1.2));
                }
                for &(f, y, _) in &points {
                    canvas.dot((panel.px(f), panel.py(y)), 2.3, INK);
                }
            });
        });
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let curves = self.shown.iter().flat_map(|&i| self.curve(i)).map(|p| p.1);
        let multiples = Multiples {
            legend: self.legend(),
            label: self.label(),
            x: frequencies("frequency f", self.c.points.iter().map(|p| p.point.frequency)),
            y: self.axis(&self.shown, curves),
            scale: &self.scale,
            shown: self.shown.iter().map(|&i| (i, words::heading(self.c, i))).collect(),
        };
        let values = |canvas: &mut Canvas, panel: &Panel, condition| self.main(canvas, panel, condition);
        multiples.draw((title, alt), values, |canvas, panel, condition| self.strip(canvas, panel, condition))
    }

    /// Panels without the errors, for a narrow screen.
    fn narrow(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let shown = words::worst(self.c, stack::MOST);
        let curves = shown.iter().flat_map(|&i| self.curve(i)).map(|p| p.1);
        let x = frequencies("frequency f", self.c.points.iter().map(|p| p.point.frequency));
        let y = self.axis(&shown, curves);
        let all = self.c.conditions.len();
        let some = format!("{} of {all} conditions, the largest misfits", shown.len());
        let head = [Some(self.label()), Some(some).filter(|_| shown.len() < all)].into_iter().flatten().collect();
        let strip = |(_, text): &Entry| [AMPLITUDES, PHASES].contains(&text.as_str()) || text.starts_with("within");
        let legend = self.legend().into_iter().filter(|entry| !strip(entry)).collect();
        let lines = shown.iter().map(|&i| words::heading(self.c, i)).collect();
        let stack = Stack { legend, head, parts: Stack::conditions(lines, (&x, &Axis { label: self.label(), ..y })) };
        stack.draw((title, alt), |canvas, panel, index| self.main(canvas, panel, shown[index]))
    }

    fn main(&self, canvas: &mut Canvas, panel: &Panel, condition: usize) {
        let curve = self.curve(condition);
        canvas.series("model", |canvas| {
            self.runs(&curve).iter().for_each(|run| panel.curve(canvas, run, Stroke::solid(MODEL, 2.2)));
        });
        self.readings(canvas, panel, condition);
        let far: Vec<Point> = self.outliers(condition).collect();
        canvas.series("outlier", |canvas| panel.marks(canvas, &far, Mark::Diamond, 5.5, SLIP, true));
    }

    /// Places of the readings that stand out.
    fn outliers(&self, condition: usize) -> impl Iterator<Item = Point> + '_ {
        let far = |p: &&Compared| self.c.stands_out(p.point.row, self.phase);
        self.points(condition).filter(far).filter_map(move |p| {
            let amplitude = self.amplitude.value(p.point.amplitude, p.point.drive);
            let y = if self.phase { self.degrees(p.point.phase?) } else { amplitude };
            Some((p.point.frequency, y))
        })
    }

    fn strip(&self, canvas: &mut Canvas, panel: &Panel, condition: usize) {
        let residual = |p: &Compared| (p.point.frequency, self.scale.place(p.amplitude_residual));
        if !self.phase {
            let line: Vec<Point> = self.points(condition).map(residual).collect();
            canvas.series(AMPLITUDES, |canvas| self.residuals(canvas, panel, &line, MODEL));
        }
        let place = |p: &Compared| Some((p.point.frequency, self.scale.place(p.phase_residual?)));
        let line: Vec<Point> = self.points(condition).filter_map(place).collect();
        let color = if self.phase { MODEL } else { SLIP };
        canvas.series(PHASES, |canvas| self.residuals(canvas, panel, &line, color));
    }

    fn residuals(&self, canvas: &mut Canvas, panel: &Panel, points: &[Point], color: Color) {
        canvas.within(panel, |canvas| {
            panel.curve(canvas, points, Stroke::solid(color, 0.9));
            for &(f, y) in points {
                canvas.dot((panel.px(f), panel.py(y)), 1.9, color);
            }
        });
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = vec![
            (Key::Mark(Mark::Circle, INK, true), MEASURED.into()),
            (Key::Line(Stroke::solid(MODEL, 2.2)), "model".into()),
        ];
        if self.phase {
            entries.push((Key::Mark(Mark::Circle, MODEL, true), PHASES.into()));
        } else {
            entries.push((Key::Mark(Mark::Circle, MODEL, true), AMPLITUDES.into()));
            if self.c.points.iter().any(|p| p.phase_residual.is_some()) {
                entries.push((Key::Mark(Mark::Circle, SLIP, true), PHASES.into()));
            }
        }
        entries.push((Key::Patch(SHADE), format!("within ±{BAND} σ")));
        if self.shown.iter().any(|&i| self.outliers(i).next().is_some()) {
            entries.push((Key::Mark(Mark::Diamond, SLIP, true), "outlier".into()));
        }
        entries
    }
}

impl Figure<Comparison> for Overlay {
    fn name(&self) -> &'static str {
        if self.phase { "overlay-phase" } else { "overlay" }
    }

    fn title(&self) -> &'static str {
        if self.phase { "Measured and modelled phase" } else { "Measured and modelled amplitude" }
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Errors scattered about zero inside the band, about one in twenty outside.",
            "Errors that swing smoothly along the frequency: the model has the wrong shape there, however small they are.",
            "See in which panels the swing grows, with speed, load or drive; then read the contact below.",
        ]
    }

    fn draw(&self, comparison: &Comparison) -> Result<Drawing, FigureError> {
        if self.phase && comparison.points.iter().all(|p| p.point.phase.is_none()) {
            return Err(FigureError::missing(self.name(), "measured phases"));
        }
        let data = Data::of(comparison, self.phase);
        let alone = !comparison.model.has_contact;
        let alt = format!(
            "Small multiples, {}: measured points with error bars and a line for the model against frequency, and below \
             each a strip of errors with a band of plus and minus two standard deviations.",
            count(data.shown.len(), "panel")
        );
        let svg = data.draw(self.title(), &alt)?;
        // The first picture of a page of a comparison alone.
        let narrow = if self.phase { None } else { Some(data.narrow(self.title(), &alt)?) };
        let mut drawing = Drawing::of(self, (data.caption(), alt), (svg, data.csv()), data.notes());
        drawing.narrow = narrow;
        if alone {
            drawing.reading[2] = ALONE.into();
        }
        Ok(drawing)
    }
}
