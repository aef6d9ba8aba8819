//! The parameters of the explanation with their intervals, relative to their estimates.

use super::rows::Rows;

use crate::discover::{Discovery, Step, identified, open_ends};
use crate::figures::axes::{Axis, Panel};
use crate::figures::canvas::{Anchor, Canvas, Stroke, Type, document};
use crate::figures::legend::{Entry, Key, legend};
use crate::figures::marks::Mark;
use crate::figures::style::{GREY, GRID, INK, SLIP, STATIC, TOP, Table, WIDTH, cell, count, significant, text_width};
use crate::figures::{Drawing, Figure, FigureError};
use crate::fit::{Interval, Parameter};
use crate::units;
use crate::units::readable::quantity;

/// Room for the numbers at the right.
const NUMBERS: f64 = 390.0;
/// Deviations in percent within which the scale is linear.
const LINEAR: f64 = 1.0;
/// The scale ends here, whatever the intervals.
const LARGEST: f64 = 1000.0;
const TICKS: [f64; 5] = [1.0, 5.0, 20.0, 100.0, 1000.0];

/// Names of what is drawn.
const CLOSED: &str = "estimate, 95 % interval";
const OPEN: &str = "open: the data give no end on this side";
const DEVIATION: &str = "deviation from the estimate [%]";

/// The figure.
pub struct Parameters;

/// Deviation of a value from the estimate \[%\]; of an estimate of zero, in the larger half of the interval.
fn deviation(value: f64, i: &Interval) -> f64 {
    let unit = if i.value == 0.0 { i.low.abs().max(i.high.abs()) } else { i.value.abs() };
    if unit > 0.0 { 100.0 * (value - i.value) / unit } else { 0.0 }
}

fn place(percent: f64) -> f64 {
    (percent / LINEAR).asinh()
}

fn pairs(step: &Step) -> impl Iterator<Item = (&Parameter, &Interval)> {
    step.comparison.fit.parameters.iter().zip(&step.comparison.intervals)
}

fn draw(step: &Step, title: &str, alt: &str) -> Result<String, FigureError> {
    let rows = Rows::of(pairs(step).map(|(p, _)| p.key.clone()), TOP, 40.0);
    let room = pairs(step).map(|(p, i)| 20.0 + text_width(&numbers(p, i), 13.0, false)).fold(NUMBERS, f64::max);
    let width = WIDTH - rows.left - room - 16.0;
    let closed = pairs(step).flat_map(|(p, i)| {
        let (low, high) = open_ends(p, i);
        [(low, i.low), (high, i.high)].map(|(open, end)| if open { 0.0 } else { deviation(end, i).abs() })
    });
    let end = 1.25 * closed.filter(|d| d.is_finite()).fold(3.0, f64::max).min(LARGEST);
    let axis = Axis::linear(DEVIATION, -place(end), place(end)).step(1e9).sinh(LINEAR, 1.0);
    let panel = rows.panel(rows.left, width, axis);
    document((WIDTH, rows.bottom() + 62.0), (title, alt), |canvas| {
        let entries: [Entry; 2] = [
            (Key::Mark(Mark::Circle, STATIC, true), CLOSED.into()),
            (Key::Line(Stroke::solid(SLIP, 2.4)), OPEN.into()),
        ];
        for (index, entry) in entries.iter().enumerate() {
            legend(canvas, rows.left.min(200.0) + 260.0 * index as f64, 2.0, std::slice::from_ref(entry));
        }
        ticks(canvas, &panel, end);
        rows.draw(canvas, &[&panel]);
        panel.border(canvas, 0.0);
        for (index, (p, i)) in pairs(step).enumerate() {
            let (low, high) = open_ends(p, i);
            let name = if low && high { OPEN } else { CLOSED };
            canvas.series(name, |canvas| canvas.within(&panel, |canvas| interval(canvas, &panel, rows.y(index), p, i)));
            beside(canvas, &panel, rows.y(index), p, i);
        }
        let label = Type { size: 16.0, ..Type::at(Anchor::Middle) };
        let at = (panel.left + 0.5 * panel.width, panel.bottom() + 46.0);
        canvas.text(at, DEVIATION, label);
    })
}

fn interval(canvas: &mut Canvas, panel: &Panel, y: f64, p: &Parameter, i: &Interval) {
    let (open_low, open_high) = open_ends(p, i);
    let centre = panel.px(0.0);
    let (left, right) = (panel.left + 3.0, panel.right() - 3.0);
    for (open, end, edge) in [(open_low, i.low, left), (open_high, i.high, right)] {
        let x = panel.px(place(deviation(end, i)));
        if open {
            canvas.arrow((centre, y), (edge, y), Stroke::solid(SLIP, 2.4));
        } else if !(left..=right).contains(&x) {
            canvas.arrow((centre, y), (edge, y), Stroke::solid(STATIC, 2.4));
        } else {
            canvas.line((centre, y), (x, y), Stroke::solid(STATIC, 2.4));
            canvas.line((x, y - 7.0), (x, y + 7.0), Stroke::solid(STATIC, 2.0));
        }
    }
    canvas.dot((centre, y), 4.6, if open_low && open_high { SLIP } else { STATIC });
}

/// Estimate, interval and verdict in words.
fn beside(canvas: &mut Canvas, panel: &Panel, y: f64, p: &Parameter, i: &Interval) {
    let text = Type { size: 13.0, ..Type::default() };
    canvas.text((panel.right() + 14.0, y - 2.0), &numbers(p, i), text);
    canvas.text((panel.right() + 14.0, y + 14.0), identified(p, i), Type { color: GREY.mix(INK, 0.5), ..text });
}

/// Estimate and interval.
fn numbers(p: &Parameter, i: &Interval) -> String {
    let show = |value: f64| quantity(value, p.unit, 4);
    let digits = units::interval_digits([i.value, i.low, i.high]);
    let [value, low, high] =
        [(i.value, digits[0]), (i.low, digits[1]), (i.high, digits[2])].map(|(x, n)| quantity(x, p.unit, n));
    match open_ends(p, i) {
        (false, false) => format!("{value} ({low} to {high})"),
        (true, false) => format!("at most {}", show(i.high)),
        (false, true) => format!("at least {}", show(i.low)),
        (true, true) => format!("{} used", show(i.value)),
    }
}

fn ticks(canvas: &mut Canvas, panel: &Panel, end: f64) {
    canvas.ticks(panel, (true, false), |canvas| named_ticks(canvas, panel, end));
}

fn named_ticks(canvas: &mut Canvas, panel: &Panel, end: f64) {
    let mut right = f64::NEG_INFINITY;
    let positive = TICKS.iter().filter(|tick| **tick <= end);
    let all: Vec<f64> = positive.clone().rev().map(|tick| -tick).chain([0.0]).chain(positive.copied()).collect();
    for tick in all {
        let x = panel.px(place(tick));
        canvas.line((x, panel.top), (x, panel.bottom()), Stroke::solid(GRID, 1.0));
        let text = significant(tick, 3);
        let half = 0.5 * text_width(&text, 15.0, false);
        if x - half > right + 8.0 {
            canvas.text((x, panel.bottom() + 21.0), &text, Type::at(Anchor::Middle));
            right = x + half;
        }
    }
}

fn csv(step: &Step) -> String {
    let header = ["parameter", "unit", "estimate", "low", "high", "lower end open", "upper end open", "identified"];
    let mut table = Table::new(&header);
    for (p, i) in pairs(step) {
        let (low, high) = open_ends(p, i);
        let words = |open: bool| if open { "yes" } else { "no" }.to_string();
        let cells = [p.key.clone(), p.unit.to_string()].into_iter().chain([i.value, i.low, i.high].map(cell));
        table.row(cells.chain([words(low), words(high), identified(p, i).to_string()]));
    }
    table.finish()
}

impl Figure<Discovery> for Parameters {
    fn name(&self) -> &'static str {
        "parameters"
    }

    fn title(&self) -> &'static str {
        "What the data determine"
    }

    fn reading(&self) -> [&'static str; 3] {
        [
            "Short intervals: the readings fix the number, and a second set should give it again.",
            "Arrows: these readings leave the number open, however well the curve fits.",
            "Do not use an open number outside the range of these readings; measure where it matters.",
        ]
    }

    fn draw(&self, discovery: &Discovery) -> Result<Drawing, FigureError> {
        let step = discovery.explanation();
        let all = pairs(step).count();
        if all == 0 {
            return Err(FigureError::missing(self.name(), "free parameters"));
        }
        let bounded = pairs(step).filter(|(p, i)| open_ends(p, i) == (false, false)).count();
        let alt = format!(
            "Horizontal intervals of {} about their estimates, in percent; {bounded} of them end on both sides.",
            count(all, "parameter")
        );
        let caption = format!(
            "Every parameter of the explanation with its 95 % interval, as deviation from the estimate on a scale that is linear \
             within ±{LINEAR} % and logarithmic beyond. {bounded} of {all} are bounded by the data on both sides. Arrows in red: \
             the interval has no end there but that of the search."
        );
        let svg = draw(step, self.title(), &alt)?;
        let notes = vec![("Bounded on both sides".to_string(), format!("{bounded} of {all}"))];
        Ok(Drawing::of(self, (caption, alt), (svg, csv(step)), notes))
    }
}
