//! One curve per step over the measured points, at the conditions with the largest misfit of the base; the errors beneath.

use super::{DiscoveryFigure, color, dash, drawing, ladder_of, name};
use crate::compare::Compared;
use crate::discover::{Discovery, Step};
use crate::figures::axes::{Axis, Panel, range};
use crate::figures::canvas::{Anchor, Canvas, Point, Stroke, Type, document};
use crate::figures::comparison::grid::{Cell, Grid, LEFT, Rows, heading};
use crate::figures::comparison::overlay::{BAR, Data};
use crate::figures::comparison::sigma::{BAND, Sigma};
use crate::figures::comparison::words;
use crate::figures::legend::{Entry, Key};
use crate::figures::marks::Mark;
use crate::figures::resonance::{phase_axis, unbroken};
use crate::figures::style::{GREY, INK, LABEL_SIZE, SHADE, Table, WIDTH, cell, significant};
use crate::figures::{Drawing, FigureError};

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
        let chi2 = |i: &usize| {
            let metrics = &base.conditions[*i].metrics;
            metrics.chi2_per_point * metrics.readings as f64
        };
        let mut shown: Vec<usize> = (0..base.conditions.len()).collect();
        shown.sort_by(|a, b| chi2(b).total_cmp(&chi2(a)).then(a.cmp(b)));
        shown.truncate(MOST);
        shown.sort_unstable();
        let points = || steps.iter().flat_map(|s| &s.comparison.points).filter(|p| shown.contains(&p.condition));
        let scale = Sigma::over(points().filter_map(|p| residual(p, phase)));
        Self { steps, data, phase, scale, shown }
    }

    fn stroke(&self, index: usize, width: f64) -> Stroke {
        let count = self.steps.len();
        Stroke::dashed(color(index, count), width, dash(index, count))
    }

    fn axes(&self) -> (Axis, Axis) {
        let points = || self.steps[0].comparison.points.iter().filter(|p| self.shown.contains(&p.condition));
        let (low, high) = range(points().map(|p| p.point.frequency));
        let margin = if high > low { 0.02 * (high - low) } else { 0.0 };
        let bars = self.shown.iter().flat_map(|&i| self.data[0].measured(i)).flat_map(|(_, y, bar)| [y - bar, y + bar]);
        let curves = self.data.iter().flat_map(|d| self.shown.iter().flat_map(|&i| d.curve(i))).map(|p| p.1);
        let values = bars.chain(curves);
        let y = if self.phase { phase_axis(values) } else { Axis::around("", values) };
        (Axis::linear("", low - margin, high + margin), Axis { label: String::new(), ..y })
    }

    fn draw(&self, title: &str, alt: &str) -> Result<String, FigureError> {
        let rows = Rows::of(self.legend());
        let grid = Grid::of(self.shown.len(), rows.height());
        let (x, y) = self.axes();
        document((WIDTH, grid.bottom()), (title, alt), |canvas| {
            rows.draw(canvas);
            let upright = Type { size: LABEL_SIZE, anchor: Anchor::Middle, upwards: true, ..Type::default() };
            let label = if self.phase { "phase φ [°]".into() } else { self.data[0].amplitude.label() };
            canvas.text((LEFT - 74.0, grid.middle()), &label, upright);
            for (index, &condition) in self.shown.iter().enumerate() {
                let at = grid.cell(index);
                let Cell { left, top, width, .. } = at;
                let main = Panel { left, top, width, height: grid.main, x: x.clone(), y: y.clone() };
                self.main(canvas, &main, condition, at.first);
                let strip = Panel { top: at.strip, height: grid.strip, y: Axis::linear("", -1.0, 1.0), ..main };
                self.strip(canvas, &strip, condition, &at);
            }
        })
    }

    fn main(&self, canvas: &mut Canvas, panel: &Panel, condition: usize, beside: bool) {
        panel.frame(canvas, false, beside);
        let setting = self.data[0].setting(condition);
        heading(canvas, panel, (&words::speed(setting), &words::load_and_drive(setting)));
        let points = self.data[0].measured(condition);
        for &(f, y, bar) in &points {
            panel.curve(canvas, &[(f, y - bar), (f, y + bar)], Stroke::solid(INK, 1.0));
        }
        for &(f, y, _) in &points {
            canvas.dot((panel.px(f), panel.py(y)), 2.0, INK);
        }
        for (index, data) in self.data.iter().enumerate() {
            let curve = data.curve(condition);
            for run in unbroken(&curve) {
                panel.curve(canvas, run, self.stroke(index, 2.2));
            }
        }
    }

    fn strip(&self, canvas: &mut Canvas, panel: &Panel, condition: usize, at: &Cell) {
        let band = self.scale.place(BAND);
        canvas.rectangle((panel.left, panel.py(band)), panel.width, panel.py(-band) - panel.py(band), SHADE, None);
        canvas.line((panel.left, panel.py(0.0)), (panel.right(), panel.py(0.0)), Stroke::solid(GREY, 0.8));
        for (index, data) in self.data.iter().enumerate() {
            let place = |p: &Compared| Some((p.point.frequency, self.scale.place(residual(p, self.phase)?)));
            let line: Vec<Point> = data.points(condition).filter_map(place).collect();
            panel.curve(canvas, &line, Stroke::solid(color(index, self.steps.len()), 1.5));
        }
        panel.border(canvas, 0.0);
        let foot = Panel { x: Axis { label: "frequency f [Hz]".into(), ..panel.x.clone() }, ..panel.clone() };
        foot.labels(canvas, at.last, false);
        if at.first {
            let small = Type { size: 13.0, ..Type::at(Anchor::End) };
            let top = self.scale.top();
            for (tick, text) in [(top, significant(top, 3)), (0.0, "0".into()), (-top, significant(-top, 3))] {
                canvas.text((panel.left - 6.0, panel.py(self.scale.place(tick)) + 4.5), &text, small);
            }
            let upright = Type { size: 13.0, anchor: Anchor::Middle, upwards: true, ..Type::default() };
            canvas.text((panel.left - 52.0, panel.top + 0.5 * panel.height), "error [σ]", upright);
        }
    }

    fn legend(&self) -> Vec<Entry> {
        let mut entries = vec![(Key::Mark(Mark::Circle, INK, true), "measured, 95 % bars".to_string())];
        let line = |(index, step): (usize, &Step)| (Key::Line(self.stroke(index, 2.2)), name(step));
        entries.extend(self.steps.iter().enumerate().map(line));
        entries.push((Key::Patch(SHADE), format!("error within ±{BAND} σ")));
        entries
    }

    /// Every condition, also those without a panel.
    fn csv(&self) -> String {
        let value = if self.phase { "phase [deg]".into() } else { self.data[0].amplitude.label() };
        let header = ["kind", "step", "condition", "row", "frequency [Hz]", &value, "sd", "error [sigma]"];
        let mut table = Table::new(&header);
        for condition in 0..self.steps[0].comparison.conditions.len() {
            let label = words::condition(self.data[0].setting(condition));
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
                    row("curve", &name(step), String::new(), [f, y, f64::NAN, f64::NAN]);
                }
                for p in readings(data) {
                    let error = residual(p, self.phase).unwrap_or(f64::NAN);
                    row("error", &name(step), p.point.row.to_string(), [p.point.frequency, f64::NAN, f64::NAN, error]);
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

impl DiscoveryFigure for Overlay {
    fn name(&self) -> &'static str {
        "ladder-overlay"
    }

    fn title(&self) -> &'static str {
        "How each step moves the curve"
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let data = Steps::of(ladder_of(self, discovery)?);
        let what = if data.phase { "phase" } else { "amplitude" };
        let panels = words::count(data.shown.len(), "panel");
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
            "Measured {what} with 95 % bars, and the curve of every step of the ladder, pale for the calibrated base to dark for \
             the last one: {of}. The strips show the errors of the {what}. {}",
            data.scale.sentence()
        );
        let notes = data.steps.iter().map(|step| {
            (format!("Largest error, {}", name(step)), format!("{} σ", significant(data.largest(step), 3)))
        });
        let reading = [
            "The last curve runs through the points in every panel, and its errors stay in the band.",
            "A last curve that is right in some panels and wrong in others: the step is a compromise, not the cause.",
            "Compare the panels in which the base fails most with those in which it does not: speed, load or drive tells.",
        ];
        Ok(drawing(self, (caption, alt), (svg, data.csv()), (notes.collect(), reading)))
    }
}
