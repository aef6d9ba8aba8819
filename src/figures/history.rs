//! Values of a history by run: one small panel each, every run a dot, levels between steps as lines.

use super::axes::{Axis, Panel, range};
use super::canvas::{Anchor, Canvas, Stroke, Type, document};
use super::style::{DOTS, GREY, INK, SLIP, STATIC, TOP, Table, WIDTH, cell, count, significant};
use super::{Drawing, FigureError};
use crate::history::{Kind, Series};

/// Most panels of a figure.
pub const MOST: usize = 12;
/// Most runs shown.
const RUNS: usize = 200;
const COLUMNS: usize = 3;
const LEFT: f64 = 76.0;
const GAP: f64 = 84.0;
const HEIGHT: f64 = 120.0;
const STEP: f64 = 178.0;

/// Draws the values of runs, those that moved first; the last run is this one. `name` is that of the files.
///
/// # Errors
/// [`FigureError::MissingData`] for fewer than two runs, [`FigureError::Render`] where an element cannot be drawn.
pub fn draw(series: &[Series], name: &str, title: &str) -> Result<Drawing, FigureError> {
    let runs = series.iter().map(|s| s.values.len()).max().unwrap_or(0);
    if runs < 2 {
        return Err(FigureError::missing(name, "two runs"));
    }
    let shown = chosen(series);
    let first = runs.saturating_sub(RUNS);
    let before = series.first().map_or(0, |one| one.before);
    let alt = format!("Small panels of {} against the number of the run.", count(shown.len(), "value"));
    let left_out = match series.len() - shown.len() {
        0 => String::new(),
        n => format!(" {n} more are in the CSV."),
    };
    let caption = format!(
        "Each dot is a run, the last one this run; lines are the levels between steps, dotted where one begins. A step has \
         to outlast a single run.{left_out}"
    );
    let svg = panels(&shown, (first, runs), before, (title, &alt))?;
    let reading = [
        "Dots on one level, or a step downwards.",
        "A red dotted line: an error or a time went up and stayed up. One dot off its level is no step yet.",
        "Look up the run where the step is in the table, and what was changed for it; then compare with the run before it \
         by --baseline.",
    ];
    Ok(Drawing::new((name, title), (caption, alt), (svg, csv(series, first, before)), reading))
}

/// A small panel for each of some series, from `first` to the last of its `runs`; there were runs `before` these.
fn panels(
    shown: &[&Series],
    (first, runs): (usize, usize),
    before: usize,
    words: (&str, &str),
) -> Result<String, FigureError> {
    let rows = shown.len().div_ceil(COLUMNS);
    let width = (WIDTH - LEFT - 20.0 - GAP * (COLUMNS - 1) as f64) / COLUMNS as f64;
    document((WIDTH, TOP + STEP * rows as f64), words, |canvas| {
        for (index, one) in shown.iter().enumerate() {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            let (left, top) = (LEFT + (width + GAP) * column as f64, TOP + STEP * row as f64);
            let (x, y) = axes(one, first, runs);
            let panel = Panel { left, top, width, height: HEIGHT, x, y };
            frame(canvas, &panel, &label(one), before + first + 1, before + runs);
            values(canvas, &panel, one, first, runs);
        }
    })
}

/// Runs from `first` on, and the values of a series in these.
fn axes(one: &Series, first: usize, runs: usize) -> (Axis, Axis) {
    let (low, high) = range(one.values.iter().copied().skip(first));
    // A series without scatter is drawn flat, not as the digits that rounding left.
    let pad = (0.02 * low.abs().max(high.abs())).max(0.15 * (high - low));
    let y = if low.is_finite() { Axis::linear("", low - pad, high + pad) } else { Axis::linear("", 0.0, 1.0) };
    (Axis::linear("run", first as f64 + 0.5, runs as f64 + 0.5), y)
}

/// The frame of a panel with its heading and the numbers of the first and the last run.
fn frame(canvas: &mut Canvas<'_>, panel: &Panel, heading: &str, first: usize, last: usize) {
    panel.frame(canvas, false, true);
    let style = Type { size: 12.5, ..Type::default() };
    canvas.text((panel.left - 40.0, panel.top - 10.0), heading, style.bold());
    for (run, at, anchor) in [(first, panel.left, Anchor::Start), (last, panel.right(), Anchor::End)] {
        canvas.text((at, panel.bottom() + 18.0), &format!("run {run}"), Type { anchor, ..style });
    }
}

/// Levels, steps and values of a series in its panel.
fn values(canvas: &mut Canvas<'_>, panel: &Panel, one: &Series, first: usize, runs: usize) {
    levels(one, runs).iter().for_each(|&(from, to, level)| {
        panel.curve(canvas, &[(from, level), (to, level)], Stroke::solid(GREY, 1.4));
    });
    for step in one.steps.iter().filter(|step| step.at >= first) {
        let at = panel.px(step.at as f64 + 0.5);
        let worse = one.kind.falls() && step.after > step.before;
        let stroke = Stroke::dashed(if worse { SLIP } else { STATIC }, 2.0, DOTS);
        canvas.line((at, panel.top), (at, panel.bottom()), stroke);
    }
    canvas.series(&one.name, |canvas| {
        for (place, value) in one.values.iter().enumerate().skip(first).filter(|(_, v)| v.is_finite()) {
            let last = place + 1 == runs;
            canvas.dot((panel.px(place as f64 + 1.0), panel.py(*value)), if last { 4.2 } else { 2.8 }, INK);
        }
    });
}

fn csv(series: &[Series], first: usize, before: usize) -> String {
    let mut table = Table::new(&["value", "unit", "run", "number"]);
    for one in series {
        for (place, value) in one.values.iter().enumerate().skip(first) {
            table.row([one.name.clone(), one.kind.unit().into(), (before + place + 1).to_string(), cell(*value)]);
        }
    }
    table.finish()
}

/// What is drawn: first what moved, then in order.
fn chosen(series: &[Series]) -> Vec<&Series> {
    let mut all: Vec<&Series> = series.iter().collect();
    all.sort_by_key(|one| one.steps.is_empty());
    all.truncate(MOST);
    all
}

/// From where to where a level reaches, in runs, and the level.
fn levels(one: &Series, runs: usize) -> Vec<(f64, f64, f64)> {
    let end = runs as f64 + 0.5;
    let from = |step: usize| one.steps.get(step).map_or(end, |step| step.at as f64 + 0.5);
    let Some(first) = one.steps.first() else { return Vec::new() };
    let after = one.steps.iter().enumerate().map(|(index, step)| (from(index), from(index + 1), step.after));
    std::iter::once((0.5, from(0), first.before)).chain(after).collect()
}

fn label(one: &Series) -> String {
    let latest = one.values.iter().rev().find(|value| value.is_finite());
    let what = match one.kind {
        Kind::Misfit => "χ² ",
        Kind::Error => "error ",
        Kind::Frequency => "peak ",
        Kind::Time => "",
    };
    let unit = if one.kind.unit() == "1" { String::new() } else { format!(" {}", one.kind.unit()) };
    let value = latest.map_or("–".into(), |value| format!("{}{unit}", significant(*value, 4)));
    let name: String = if one.name.chars().count() > 30 {
        one.name.chars().take(29).chain(['…']).collect()
    } else {
        one.name.clone()
    };
    format!("{name}: {what}{value}")
}
