//! One curve per step over the measured points, at the conditions with the largest misfit of the base; the errors
//! beneath.

use super::{color, dash, ladder_of};
use crate::compare::Compared;
use crate::discover::{Discovery, Step};
use crate::figures::axes::Panel;
use crate::figures::canvas::{Canvas, Point, Stroke};
use crate::figures::comparison::multiples::{Multiples, frequencies};
use crate::figures::comparison::overlay::{BAR, Data, MEASURED};
use crate::figures::comparison::sigma::{BAND, Sigma};
use crate::figures::comparison::words;
use crate::figures::legend::{Entry, Key};
use crate::figures::marks::Mark;
use crate::figures::style::{INK, SHADE, Table, cell, count, significant};
use crate::figures::{Drawing, Figure, FigureError};

/// Panels at most.
const MOST: usize = 6;

/// The figure.
pub struct Overlay;

struct Steps<'a> {
    steps: &'a [Step],
    data: Vec<Data<'a>>,
    phase: bool,
    scale: Sigma,
    shown: Vec<usize>,
}

fn residual(p: &Compared, phase: bool) -> Option<f64> {
    if phase { p.phase_residual } else { Some(p.amplitude_residual) }
}

impl<'a> Steps<'a> {
    fn of(steps: &'a [Step]) -> Self {
        let base = &steps[0].comparison;
        let square =
            |phase: bool| -> f64 { base.points.iter().filter_map(|p| residual(p, phase)).map(|r| r * r).sum() };
        // Amplitudes, unless the base is chiefly wrong in phase.
        let phase = square(true) > 2.0 * square(false);
        let mut data: Vec<Data> = steps.iter().map(|step| Data::of(&step.comparison, phase)).collect();
        let wraps = data.iter().any(|d| d.wraps);
        data.iter_mut().for_each(|d| d.wraps = wraps);
        let shown = words::worst(base, MOST);
        let points = || steps.iter().flat_map(|s| &s.comparison.points).filter(|p| shown.contains(&p.condition));
        let scale = Sigma::over(points().filter_map(|p| residual(p, phase)));
        Self { steps, data, phase, scale, shown }
    }

    fn stroke(&self, index: usize, width: f64) -> Stroke {
        let count = self.steps.len();
        Stroke::dashed(color(index, count), width, dash(index, count))
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let curves = self.data.iter().flat_map(|d| self.shown.iter().flat_map(|&i| d.curve(i))).map(|p| p.1);
        let points = self.steps[0].comparison.points.iter().filter(|p| self.shown.contains(&p.condition));
        let multiples = Multiples {
            legend: self.legend(),
            label: self.data[0].label(),
            x: frequencies("frequency f", points.map(|p| p.point.frequency)),
            y: self.data[0].axis(&self.shown, curves),
            scale: &self.scale,
            shown: self.shown.iter().map(|&i| (i, words::heading(&self.steps[0].comparison, i))).collect(),
        };
        let values = |canvas: &mut Canvas, panel: &Panel, condition| self.main(canvas, panel, condition);
        multiples.draw((title, alt), values, |canvas, panel, condition| self.strip(canvas, panel, condition))
    }

    fn main(&self, canvas: &mut Canvas, panel: &Panel, condition: usize) {
        self.data[0].readings(canvas, panel, condition);
        for (index, data) in self.data.iter().enumerate() {
            let curve = data.curve(condition);
            canvas.series(&self.steps[index].name(), |canvas| {
                data.runs(&curve).iter().for_each(|run| panel.curve(canvas, run, self.stroke(index, 2.2)));
            });
        }
    }

    fn strip(&self, canvas: &mut Canvas, panel: &Panel, condition: usize) {
        for (index, data) in self.data.iter().enumerate() {
            let place = |p: &Compared| Some((p.point.frequency, self.scale.place(residual(p, self.phase)?)));
            let line: Vec<Point> = data.points(condition).filter_map(place).collect();
            let stroke = Stroke::solid(color(index, self.steps.len()), 1.5);
            canvas.series(&self.steps[index].name(), |canvas| panel.curve(canvas, &line, stroke));
        }
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = vec![(Key::Mark(Mark::Circle, INK, true), MEASURED.to_string())];
        let line = |(index, step): (usize, &Step)| (Key::Line(self.stroke(index, 2.2)), step.name());
        entries.extend(self.steps.iter().enumerate().map(line));
        entries.push((Key::Patch(SHADE), format!("error within ±{BAND} σ")));
        entries
    }

    /// Every condition, also those without a panel.
    fn csv(&self) -> String {
        let value = self.data[0].label();
        let header = ["kind", "step", "condition", "row", "frequency [Hz]", &value, "sd", "error [sigma]"];
        let mut table = Table::new(&header);
        for condition in 0..self.steps[0].comparison.conditions.len() {
            let label = words::condition(&self.steps[0].comparison, condition);
            let mut row = |kind: &str, step: &str, row: String, numbers: [f64; 4]| {
                let cells = [kind.to_string(), step.to_string(), label.clone(), row];
                table.row(cells.into_iter().chain(numbers.map(cell)));
            };
            let readings = |d: &Data<'a>| d.points(condition).filter(|p| residual(p, self.phase).is_some());
            for (p, (f, y, bar)) in readings(&self.data[0]).zip(self.data[0].measured(condition)) {
                row("reading", "", p.point.row.to_string(), [f, y, bar / BAR, f64::NAN]);
            }
            for (step, data) in self.steps.iter().zip(&self.data) {
                for (f, y) in data.curve(condition) {
                    row("curve", &step.name(), String::new(), [f, y, f64::NAN, f64::NAN]);
                }
                for p in readings(data) {
                    let error = residual(p, self.phase).unwrap_or(f64::NAN);
                    row("error", &step.name(), p.point.row.to_string(), [p.point.frequency, f64::NAN, f64::NAN, error]);
                }
            }
        }
        table.finish()
    }

    /// Largest error of a step over the panels.
    fn largest(&self, step: &Step) -> f64 {
        let points = step.comparison.points.iter().filter(|p| self.shown.contains(&p.condition));
        points.filter_map(|p| residual(p, self.phase)).map(f64::abs).fold(0.0, f64::max)
    }
}

impl Figure<Discovery> for Overlay {
    fn name(&self) -> &'static str {
        "ladder-overlay"
    }

    fn title(&self) -> &'static str {
        "How each step moves the curve"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "The last curve runs through the points in every panel, and its errors stay in the band.",
            "A last curve that is right in some panels and wrong in others: the step is a compromise, not the cause.",
            "Compare the panels in which the base fails most with those in which it does not: speed, load or drive tells.",
        ]
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let data = Steps::of(ladder_of(self, discovery)?);
        let what = if data.phase { "phase" } else { "amplitude" };
        let panels = count(data.shown.len(), "panel");
        let alt = format!(
            "Small multiples, {panels}: measured {what} against frequency as points with error bars, one line per step of the \
             ladder, and below each panel a strip with the errors of every step."
        );
        let svg = data.draw(self.title(), &alt)?;
        let all = data.steps[0].comparison.conditions.len();
        let of = if all > data.shown.len() {
            format!("the {} of {all} conditions where the base misfits most; the CSV has all", data.shown.len())
        } else {
            "every condition".into()
        };
        let caption = format!(
            "Measured {what} with 95 % bars, and the curve of every step of the ladder, pale for the base to dark for \
             the last one: {of}. The strips show the errors of the {what}. {}",
            data.scale.sentence()
        );
        let notes = data.steps.iter().map(|step| {
            (format!("Largest error, {}", step.name()), format!("{} σ", significant(data.largest(step), 3)))
        });
        let mut drawing = Drawing::of(self, (caption, alt), (svg, data.csv()), notes.collect());
        if !data.steps[0].comparison.model.has_contact {
            drawing.reading[2] =
                "Compare the panels in which the base fails most with those in which it does not: the drive tells."
                    .into();
        }
        Ok(drawing)
    }
}
