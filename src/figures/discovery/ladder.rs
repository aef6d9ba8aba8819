//! The error falling step by step: chi2 per reading, and the error of the amplitude beside the noise.

use super::ladder_of;
use super::rows::Rows;
use crate::discover::{Discovery, Step};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Canvas, Point, Stroke, Type, document};
use crate::figures::legend::{Entry, Key, legend};
use crate::figures::marks::Mark;
use crate::figures::style::{DASH_SLIP, GAP, GREY, INK, SLIP, STATIC, TOP, Table, WHITE, WIDTH, cell, significant};
use crate::figures::{Drawing, Figure, FigureError};

const RIGHT: f64 = 30.0;

/// Names of what is drawn.
const ALL: &str = "all readings";
const NOISE: &str = "noise alone";
const LEFT_OUT: &str = "conditions left out of the fit, predicted";

/// The figure.
pub struct Ladder;

fn noise(steps: &[Step]) -> f64 {
    steps[0].comparison.overall.noise_percent
}

fn draw(steps: &[Step], title: &str, alt: &str) -> Result<String, FigureError> {
    let rows = Rows::of(steps.iter().map(Step::name), TOP, 58.0);
    let width = 0.5 * (WIDTH - rows.left - GAP - RIGHT);
    let overall = |step: &Step| step.comparison.overall;
    let chi2: Vec<f64> = steps.iter().map(|s| overall(s).chi2_per_point).collect();
    let error: Vec<f64> = steps.iter().map(|s| overall(s).rms_error_percent).collect();
    let left_out: Vec<f64> = steps.iter().map(|s| s.held_out.map_or(f64::NAN, |h| h.rms_percent)).collect();
    let noise = noise(steps);
    let axis = |label: &str, values: Vec<f64>| Axis::logarithmic(label, values, 0.14);
    let left_out_chi2: Vec<f64> = steps.iter().map(|s| s.held_out.map_or(f64::NAN, |h| h.chi2_per_point)).collect();
    let first =
        rows.panel(rows.left, width, axis("χ² per reading", [chi2.as_slice(), &left_out_chi2, &[1.0]].concat()));
    let errors = [error.as_slice(), &left_out, &[noise]].concat();
    let second = rows.panel(rows.left + width + GAP, width, axis("rms error of the amplitude [%]", errors));
    document((WIDTH, rows.bottom() + 62.0), (title, alt), |canvas| {
        entries(canvas, rows.left.min(300.0), &left_out);
        for panel in [&first, &second] {
            panel.frame(canvas, true, false);
        }
        rows.draw(canvas, &[&first, &second]);
        for (panel, level) in [(&first, 1.0), (&second, noise)] {
            let x = panel.px(level);
            let line = |canvas: &mut Canvas| {
                canvas.line((x, panel.top), (x, panel.bottom()), Stroke::dashed(SLIP, 1.8, DASH_SLIP));
            };
            canvas.series(NOISE, |canvas| canvas.within(panel, line));
        }
        for (panel, values) in [(&first, &left_out_chi2), (&second, &left_out)] {
            for (index, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
                let at = (panel.px(value), rows.y(index));
                let mark = |canvas: &mut Canvas| canvas.mark(Mark::Diamond, at, 8.0, WHITE, Stroke::solid(INK, 1.8));
                canvas.series(LEFT_OUT, |canvas| canvas.within(panel, mark));
            }
        }
        steps_of(canvas, &rows, &first, &chi2, |value| significant(value, 3));
        steps_of(canvas, &rows, &second, &error, |value| format!("{} %", significant(value, 3)));
    })
}

fn entries(canvas: &mut Canvas, left: f64, left_out: &[f64]) {
    let mut entries: Vec<Entry> = vec![
        (Key::Mark(Mark::Circle, STATIC, true), ALL.into()),
        (Key::Line(Stroke::dashed(SLIP, 1.8, DASH_SLIP)), NOISE.into()),
    ];
    if left_out.iter().any(|value| value.is_finite()) {
        entries.push((Key::Mark(Mark::Diamond, INK, false), LEFT_OUT.into()));
    }
    for (index, entry) in entries.iter().enumerate() {
        legend(canvas, left + 170.0 * index as f64, 2.0, std::slice::from_ref(entry));
    }
}

/// Marks from row to row, joined, with their numbers.
fn steps_of(canvas: &mut Canvas, rows: &Rows, panel: &Panel, values: &[f64], show: impl Fn(f64) -> String) {
    let line: Vec<Point> = values.iter().enumerate().map(|(i, &value)| (panel.px(value), rows.y(i))).collect();
    canvas.series(ALL, |canvas| canvas.within(panel, |canvas| canvas.polyline(&line, Stroke::solid(STATIC, 1.6))));
    for (&(x, y), &value) in line.iter().zip(values) {
        canvas.series(ALL, |canvas| canvas.within(panel, |canvas| canvas.dot((x, y), 5.0, STATIC)));
        let text = show(value);
        let small = Type { size: 13.0, color: GREY.mix(INK, 0.6), ..Type::default() };
        let width = crate::figures::style::text_width(&text, 13.0, false);
        let left = (x + 10.0).min(panel.right() - width - 4.0);
        canvas.within(panel, |canvas| canvas.text((left, y - 9.0), &text, small));
    }
}

fn csv(steps: &[Step]) -> String {
    let header = [
        "step",
        "chi2 per reading",
        "rms error [%]",
        "noise [%]",
        "left-out rms error [%]",
        "left-out chi2 per reading",
        "rms phase error [deg]",
        "remaining regions",
    ];
    let mut table = Table::new(&header);
    for step in steps {
        let c = &step.comparison;
        let held_out = step.held_out.map_or([f64::NAN; 2], |h| [h.rms_percent, h.chi2_per_point]);
        let numbers = [c.overall.chi2_per_point, c.overall.rms_error_percent, c.overall.noise_percent];
        let phase = c.overall.rms_phase_deg.unwrap_or(f64::NAN);
        let numbers = numbers.into_iter().chain(held_out).chain([phase, c.regions.len() as f64]).map(cell);
        table.row(std::iter::once(step.name()).chain(numbers));
    }
    table.finish()
}

impl Figure<Discovery> for Ladder {
    fn name(&self) -> &'static str {
        "ladder"
    }

    fn title(&self) -> &'static str {
        "The error, step by step"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "The last row lies on the dashed lines, diamonds and points together: nothing but noise is left, and it predicts.",
            "The last row stays right of the dashed lines: something is left. Diamonds right of the points: the step bends to the \
             data rather than explaining them.",
            "Trust the steps that bring a large fall; doubt those that bring a small one, and see the ranking.",
        ]
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let steps = ladder_of(self, discovery)?;
        let (first, last) = (&steps[0].comparison.overall, &steps[steps.len() - 1].comparison.overall);
        let fall = |from: f64, to: f64| format!("{} to {}", significant(from, 3), significant(to, 3));
        let chi2 = fall(first.chi2_per_point, last.chi2_per_point);
        let error = fall(first.rms_error_percent, last.rms_error_percent);
        let noise = significant(noise(steps), 3);
        let alt = format!(
            "Two panels with one row per step, from the base to the explanation: chi square per reading goes from \
             {chi2}, the root mean square error of the amplitude from {error} percent; the noise is {noise} percent."
        );
        let caption = format!(
            "One row per step, from the base downwards. Left: mean square of the errors in standard deviations, from \
             {chi2}; noise alone gives 1. Right: root mean square error of the amplitude, from {error} %; the noise is {noise} %. \
             Diamonds: each condition predicted by a fit to all others, so that a step that only bends to the data shows. Both \
             axes are logarithmic."
        );
        let svg = draw(steps, self.title(), &alt)?;
        let notes = vec![
            ("χ² per reading".to_string(), chi2),
            ("Error of the amplitude".to_string(), format!("{error} % (noise {noise} %)")),
        ];
        Ok(Drawing::of(self, (caption, alt), (svg, csv(steps)), notes))
    }
}
