//! Frequency and height of the resonance peak against the roller's speed.

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Point, Stroke, Type, document};
use super::data::{self, Field, health};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::{MARKS, Mark};
use super::scheme::{limit_name, limits};
use super::style::{DOTS, HEIGHT, INK, TICK_SIZE, Table, Unit, WIDTH, cell, ramp, text_width};
use super::{Drawing, Figure, FigureError};
use crate::scenario::Signal;
use crate::sweep::{Curve, LimitCurve, LimitingCase, Outcome};

const THRESHOLD: [&str; 2] = ["faster than the arm", "ever moves: full slip"];

/// The figure.
pub struct Ridge;

/// The peak of a curve, in SI.
#[derive(Debug, Clone, Copy)]
struct Peak {
    speed: f64,
    frequency: f64,
    amplitude: f64,
    /// Whether it lies inside the sweep, not at its end.
    inside: bool,
}

/// A quantity of a peak that a panel shows, and the size of its unit.
type Shown = (fn(&Peak) -> f64, f64);

/// A line of peaks: one condition apart from the speed.
struct Line {
    label: String,
    peaks: Vec<Peak>,
    stroke: Stroke,
    mark: Mark,
    radius: f64,
}

/// What is shown, in SI.
struct Data<'a> {
    lines: Vec<Line>,
    limits: Vec<(&'a LimitCurve, Stroke)>,
    curves: Vec<&'a Curve>,
    reading: Signal,
}

impl<'a> Data<'a> {
    fn of(outcome: &'a Outcome) -> Result<Self, FigureError> {
        data::with_contact(outcome, "ridge")?;
        let missing = || FigureError::missing("ridge", "at least two positive speeds and three frequencies");
        let curves: Vec<&Curve> = data::curves(outcome).into_iter().filter(|c| c.frequency.len() > 2).collect();
        let groups = data::groups(&curves, Field::Speed);
        let fields: Vec<Field> =
            data::varying(&curves, outcome).into_iter().filter(|field| *field != Field::Speed).collect();
        let mut lines = Vec::new();
        for (i, group) in groups.iter().enumerate() {
            let mut peaks: Vec<Peak> = group.iter().filter_map(|curve| peak(curve)).collect();
            peaks.sort_by(|a, b| a.speed.total_cmp(&b.speed));
            let label =
                if fields.is_empty() { "computed".into() } else { data::describe(&group[0].condition, &fields) };
            // Later lines and marks are smaller, so that coinciding ones all show.
            let excess = (groups.len() - 1 - i).min(4) as f64;
            let (stroke, mark) = (Stroke::solid(ramp(i, groups.len()), 2.2 + 2.4 * excess), MARKS[i % MARKS.len()]);
            let radius = 2.4 * excess + if peaks.len() > 40 { 3.6 } else { 5.0 };
            lines.push(Line { label, peaks, stroke, mark, radius });
        }
        lines.retain(|line| line.peaks.iter().filter(|peak| peak.speed > 0.0).count() > 1);
        let first = curves.first().filter(|_| !lines.is_empty()).ok_or_else(missing)?;
        let limits = limits(outcome, first.condition.drive);
        Ok(Self { lines, limits, curves, reading: outcome.scenario.signals.reading })
    }

    fn threshold(&self) -> Option<f64> {
        let slip = self.limits.iter().find(|(limit, _)| limit.case == LimitingCase::FreeOrFullSlip)?;
        Some(slip.0.speed_peak)
    }

    fn unit(&self) -> Unit {
        Unit::of_signal(range(self.peaks().map(|p| p.amplitude)).1, self.reading.unit)
    }

    fn peaks(&self) -> impl Iterator<Item = &Peak> {
        self.lines.iter().flat_map(|line| &line.peaks)
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let speed = Unit::speed();
        let unit = self.unit();
        let mut entries: Vec<Entry> = vec![(Key::Heading, "Peak of the curve".into())];
        entries
            .extend(self.lines.iter().map(|line| (Key::Mark(line.mark, line.stroke.color, true), line.label.clone())));
        if self.peaks().any(|peak| !peak.inside) {
            entries.push((Key::Mark(Mark::Circle, INK, false), "at the sweep's end".into()));
        }
        if !self.limits.is_empty() {
            entries.push((Key::Heading, "Limiting cases".into()));
        }
        entries.extend(self.limits.iter().map(|(limit, stroke)| (Key::Line(*stroke), limit_name(limit.case).into())));
        if let Some(v) = self.threshold() {
            entries.push((Key::Line(Stroke::dashed(INK, 1.4, DOTS)), format!("V = {}", speed.show(v, 4))));
            entries.push((Key::Heading, String::new()));
        }
        let explained = THRESHOLD.map(|text| 44.0 + text_width(text, TICK_SIZE, false)).into_iter().fold(0.0, f64::max);
        let width = WIDTH - 92.0 - 50.0 - legend_width(&entries).max(explained);
        let speeds = || self.peaks().map(|peak| speed.of(peak.speed)).chain(self.threshold().map(|v| speed.of(v)));
        let axis = || Axis::logarithmic("roller speed V [mm/s]", speeds(), 0.04);
        let frequencies = self.peaks().map(|p| p.frequency).chain(self.limits.iter().map(|(l, _)| l.peak_frequency));
        let (low, high) = range(frequencies);
        let pad = 0.12 * (high - low).max(0.5);
        let y = Axis::linear("peak frequency [Hz]", low - pad, high + pad);
        let upper = Panel { left: 92.0, top: 24.0, width, height: 305.0, x: axis(), y };
        let amplitudes = self.peaks().map(|p| p.amplitude).chain(self.limits.iter().map(|(l, _)| l.peak_amplitude));
        let (low, high) = range(amplitudes.map(|a| unit.of(a)));
        let pad = 0.1 * (high - low).max(0.01 * high);
        let y = Axis::linear(format!("peak amplitude [{}]", unit.label), low - pad, high + pad);
        let lower = Panel { left: 92.0, top: 357.0, width, height: 305.0, x: axis(), y };
        document((WIDTH, HEIGHT), (title, alt), |canvas| {
            self.panel(canvas, &upper, (|p| p.frequency, 1.0), |limit| limit.peak_frequency, false);
            self.panel(canvas, &lower, (|p| p.amplitude, unit.factor), |limit| limit.peak_amplitude, true);
            let end = legend(canvas, upper.right() + 30.0, 20.0, &entries);
            if self.threshold().is_some() {
                for (i, text) in THRESHOLD.iter().enumerate() {
                    canvas.text((upper.right() + 74.0, end - 9.0 + 19.0 * i as f64), text, Type::at(Anchor::Start));
                }
            }
        })
    }

    fn panel(
        &self,
        canvas: &mut Canvas,
        panel: &Panel,
        (quantity, factor): Shown,
        level: fn(&LimitCurve) -> f64,
        below: bool,
    ) {
        let speed = Unit::speed();
        panel.frame(canvas, below, true);
        for (limit, stroke) in &self.limits {
            let y = level(limit) / factor;
            let ends = [(panel.x.low, y), (panel.x.high, y)];
            canvas.series(limit_name(limit.case), |canvas| panel.curve(canvas, &ends, *stroke));
        }
        if let Some(v) = self.threshold() {
            let x = speed.of(v);
            let ends = [(x, panel.y.low), (x, panel.y.high)];
            let name = format!("V = {}", speed.show(v, 4));
            canvas.series(&name, |canvas| panel.curve(canvas, &ends, Stroke::dashed(INK, 1.4, DOTS)));
        }
        for line in &self.lines {
            canvas.series(&line.label, |canvas| line.draw(canvas, panel, (quantity, factor)));
        }
    }

    fn csv(&self) -> String {
        let unit = self.unit();
        let amplitude = format!("peak amplitude [{}]", unit.label);
        let mut table =
            Table::new(&["condition", "speed [mm/s]", "peak frequency [Hz]", &amplitude, "inside the sweep"]);
        for line in &self.lines {
            for Peak { speed, frequency, amplitude, inside } in &line.peaks {
                let numbers = [Unit::speed().of(*speed), *frequency, unit.of(*amplitude)].map(cell);
                let word = if *inside { "yes" } else { "no" };
                table.row(std::iter::once(line.label.clone()).chain(numbers).chain([word.to_string()]));
            }
        }
        table.finish()
    }
}

impl Line {
    /// A line through the peaks of moving rollers, and a mark at every peak.
    fn draw(&self, canvas: &mut Canvas, panel: &Panel, (quantity, factor): Shown) {
        let speed = Unit::speed();
        let moving = || self.peaks.iter().filter(|peak| peak.speed > 0.0);
        let points: Vec<Point> = moving().map(|peak| (speed.of(peak.speed), quantity(peak) / factor)).collect();
        panel.curve(canvas, &points, self.stroke);
        for (point, peak) in points.iter().zip(moving()) {
            panel.marks(canvas, &[*point], self.mark, self.radius, self.stroke.color, peak.inside);
        }
        for peak in self.peaks.iter().filter(|peak| peak.speed == 0.0) {
            let edge = [(panel.x.low, quantity(peak) / factor)];
            panel.marks(canvas, &edge, self.mark, self.radius + 2.0, self.stroke.color, peak.inside);
        }
    }
}

fn peak(curve: &Curve) -> Option<Peak> {
    let (frequency, amplitude) = data::peak(&data::steady(curve, |s| s.amplitude))?;
    let (low, high) = range(curve.frequency.iter().copied());
    Some(Peak { speed: curve.condition.speed, frequency, amplitude, inside: frequency > low && frequency < high })
}

impl Figure for Ridge {
    fn name(&self) -> &'static str {
        "ridge"
    }

    fn title(&self) -> &'static str {
        "Resonance peak against roller speed"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Frequency falls from static contact to full slip as V grows, and may dip a little below it at the end; height passes through a minimum, where slip takes most energy.",
            "Jumps between neighbouring speeds: too coarse a grid of frequencies, or states that are not steady.",
            "Measure near the minimum: a small change of the contact shows there most.",
        ]
    }

    fn draw(&self, outcome: &Outcome) -> Result<Drawing, FigureError> {
        let data = Data::of(outcome)?;
        let unit = data.unit();
        let mut caption = String::from(
            "Frequency (above) and height (below) of the resonance peak against the roller's speed, from a parabola through \
             the largest point of each curve and its neighbours.",
        );
        let mut notes = Vec::new();
        if let Some(low) = data.peaks().min_by(|a, b| a.amplitude.total_cmp(&b.amplitude)) {
            let text = format!(
                "{} at V = {} and {:.2} Hz",
                unit.show(low.amplitude, 4),
                Unit::speed().show(low.speed, 3),
                low.frequency
            );
            caption += &format!(" The peak is lowest, {text}.");
            notes.push(("Lowest peak".into(), text));
        }
        for (limit, _) in &data.limits {
            let text = format!("{} at {:.2} Hz", unit.show(limit.peak_amplitude, 4), limit.peak_frequency);
            notes.push((format!("Peak, case {}", limit_name(limit.case)), text));
        }
        if let Some(v) = data.threshold() {
            let text = Unit::speed().show(v, 4);
            caption += &format!(
                " Above V = {text} (dotted) the arm in full slip never catches up with the roller; with Coulomb friction alone the peak is then exactly that of full slip."
            );
            notes.push(("Threshold of full slip, max bωα".into(), text));
        }
        if data.peaks().any(|peak| peak.speed == 0.0) {
            caption +=
                " The logarithmic axis has no place for V = 0: those peaks are the larger marks on its left end.";
        }
        if data.lines.len() > 1 {
            caption += " Lines and marks are nested, so that coinciding ones all show.";
        }
        caption += &health(&data.curves);
        let alt = "Two stacked graphs against roller speed on a logarithmic axis; peak frequency above and peak amplitude below, with the static and full-slip values as horizontal lines.".to_string();
        let svg = data.draw(self.title(), &alt)?;
        Ok(Drawing::of(self, (caption, alt), (svg, data.csv()), notes).told_of(&outcome.scenario))
    }
}
