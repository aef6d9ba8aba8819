//! An entry of the atlas of effects: curves coloured by strength, one column per condition.

use super::axes::{Axis, Panel, range};
use super::canvas::{Canvas, Dash, Stroke, Type, document};
use super::data::{self, Field, describe};
use super::legend::{Entry as Label, Key, legend, legend_width};
use super::marks::Mark;
use super::resonance::{phase_axis, unbroken};
use super::scheme::draw_curve;
use super::style::{GAP, INK, LEFT, Table, Unit, WIDTH, cell, ramp, significant};
use super::{Drawing, FigureError};
use crate::atlas::{CONDITIONS, Entry, Strength, varied};
use crate::parameter::ParameterInfo;
use crate::scenario::Signals;
use crate::solver::SteadyState;
use crate::sweep::Curve;

/// Largest amplitude shown, in those of the base.
const CEILING: f64 = 2.5;
const READING: [&str; 3] = [
    "Your misfit has the shape of one of these changes, in the same conditions and with the same sign.",
    "A change that shows where your readings show none: then this effect alone is not what is missing.",
    "Fit it to your readings with the command stickslip add; then measure the condition in which it parts most from its rivals.",
];
const AMPLITUDE: &str = "amplitude per drive α/u₀ [rad/m]";

/// A curve with its line and its label.
struct Line<'a> {
    curves: &'a [Curve],
    stroke: Stroke,
    label: String,
}

/// Draws one effect.
///
/// # Errors
/// [`FigureError::Render`] where an element cannot be drawn.
pub fn draw(entry: &Entry) -> Result<Drawing, FigureError> {
    let lines = lines(entry);
    let title = format!("{}: curves against strength", entry.effect.title());
    let all: Vec<&Curve> = lines.iter().flat_map(|line| line.curves).collect();
    let missing = all.iter().map(|curve| curve.states.len() - steady(curve)).sum::<usize>();
    let total: usize = all.iter().map(|curve| curve.states.len()).sum();
    let gaps = match missing {
        0 => String::new(),
        _ => format!(
            " At {missing} of {total} points the periodic state is unstable (open marks) or none was found (gaps).{}",
            absent(&lines)
        ),
    };
    let caption = format!(
        "Amplitude per drive (above) and phase (below) of the arm for {} strengths of the effect{}; black, the base without it.{gaps} What it does: {}",
        entry.strengths.len(),
        fixed(entry),
        entry.effect.fingerprint()
    );
    let alt = format!(
        "Small multiples in two rows, amplitude and phase against frequency, and {} columns, one per condition: the base in black and {} coloured curves, one per strength.",
        CONDITIONS.len(),
        entry.strengths.len()
    );
    let svg = drawing(&lines, (&title, &alt))?;
    let notes = notes(&lines);
    Ok(Drawing {
        name: entry.effect.name().into(),
        title,
        caption,
        alt,
        svg,
        narrow: None,
        csv: csv(&lines),
        notes,
        reading: READING.map(String::from),
    })
}

/// Which curves have no steady state at all, by condition.
fn absent(lines: &[Line<'_>]) -> String {
    let of = |(index, (name, _)): (usize, &(&str, _))| {
        let none: Vec<&str> =
            lines.iter().filter(|line| steady(&line.curves[index]) == 0).map(|line| line.label.as_str()).collect();
        (!none.is_empty()).then(|| format!("{} for {}", name.to_lowercase(), none.join(" and ")))
    };
    let all: Vec<String> = CONDITIONS.iter().enumerate().filter_map(of).collect();
    if all.is_empty() { String::new() } else { format!(" No steady state at any frequency: {}.", all.join("; ")) }
}

fn steady(curve: &Curve) -> usize {
    data::steady(curve, per_drive(curve)).iter().filter(|point| point.1.is_finite()).count()
}

fn per_drive(curve: &Curve) -> impl Fn(&SteadyState) -> f64 {
    let drive = curve.condition.drive;
    move |state| state.amplitude / drive
}

/// The base and every strength; colour by strength, dashes for negative ones.
fn lines<'a>(entry: &'a Entry) -> Vec<Line<'a>> {
    let negative = |strength: &Strength| varied(entry.effect).iter().any(|&index| strength.parameters[index] < 0.0);
    let below = entry.strengths.iter().filter(|strength| negative(strength)).count();
    let count = entry.strengths.len() - below;
    let base = Line { curves: &entry.base, stroke: Stroke::solid(INK, 4.6), label: "without".into() };
    let line = |(index, strength): (usize, &'a Strength)| {
        let rank = if index < below { below - 1 - index } else { index - below };
        // Weak ones are wider, so that they show under strong ones that lie on them.
        let width = 3.4 - 1.8 * rank as f64 / (count.max(2) - 1) as f64;
        let dash = if index < below { Dash::Dashes(7.0, 4.0) } else { Dash::Solid };
        // The darkest colour is too close to the black of the base.
        let stroke = Stroke::dashed(ramp(rank + 1, count + 1), width, dash);
        Line { curves: &strength.curves, stroke, label: label(entry, &strength.parameters) }
    };
    std::iter::once(base).chain(entry.strengths.iter().enumerate().map(line)).collect()
}

fn label(entry: &Entry, parameters: &[f64]) -> String {
    let one = |&index: &usize| equation(&entry.effect.parameters()[index], parameters[index]);
    varied(entry.effect).iter().map(one).collect::<Vec<_>>().join(", ")
}

/// What the caption says of the parameters that are not varied.
fn fixed(entry: &Entry) -> String {
    let (varied, infos) = (varied(entry.effect), entry.effect.parameters());
    let Some(first) = entry.strengths.first() else { return String::new() };
    let others = (0..infos.len()).filter(|index| !varied.contains(index));
    let texts: Vec<String> = others.map(|index| equation(&infos[index], first.parameters[index])).collect();
    if texts.is_empty() { String::new() } else { format!(" ({})", texts.join(", ")) }
}

fn equation(info: &ParameterInfo, value: f64) -> String {
    let unit = match info.unit {
        "1" => Unit::new(1.0, ""),
        "m/s" => Unit::speed(),
        "N/m" if value.abs() >= 1e6 => Unit::new(1e6, "MN/m"),
        "m" | "s" | "W" | "N/m" => Unit::fitting(value.abs(), info.unit),
        other => Unit::new(1.0, &other.replace("^2", "²").replace("^3", "³")),
    };
    if value == 0.0 { format!("{} = 0", info.symbol) } else { format!("{} = {}", info.symbol, unit.show(value, 2)) }
}

fn drawing(lines: &[Line<'_>], words: (&str, &str)) -> Result<String, FigureError> {
    let labels: Vec<Label> = lines.iter().map(|line| (Key::Line(line.stroke), line.label.clone())).collect();
    let step = legend_width(&labels) + 26.0;
    let per_row = (((WIDTH - LEFT) / step) as usize).clamp(1, labels.len());
    let head = 22.0 * labels.len().div_ceil(per_row) as f64 + 82.0;
    let columns = CONDITIONS.len() as f64;
    let width = (WIDTH - LEFT - 20.0 - GAP * (columns - 1.0)) / columns;
    let states =
        |line: &Line<'_>| line.curves.iter().flat_map(|c| data::steady(c, per_drive(c))).map(|p| p.1).collect();
    let of_base: Vec<f64> = lines.first().map(states).unwrap_or_default();
    let ceiling = CEILING * range(of_base).1;
    let amplitudes = lines.iter().flat_map(states).filter(|a: &f64| a.is_finite()).map(|a| a.min(ceiling));
    let y = Axis::around(AMPLITUDE, amplitudes.chain([0.0]));
    let degrees = |state: &SteadyState| state.phase.to_degrees();
    let phases = lines.iter().flat_map(|l| l.curves).flat_map(|c| data::steady(c, degrees)).map(|p| p.1);
    let phase = phase_axis(phases);
    let Some(span) = lines.first().map(|line| data::span(&line.curves.iter().collect::<Vec<_>>())) else {
        return Err(FigureError::missing("atlas", "curves"));
    };
    document((WIDTH, head + 600.0), words, |canvas| {
        for (index, label) in labels.iter().enumerate() {
            let (row, column) = (index / per_row, index % per_row);
            legend(canvas, LEFT + step * column as f64, 4.0 + 22.0 * row as f64, std::slice::from_ref(label));
        }
        for (index, (name, _)) in CONDITIONS.iter().enumerate() {
            let left = LEFT + (width + GAP) * index as f64;
            let axis = || Axis::linear("frequency f [Hz]", span.0, span.1).step(10.0);
            let upper = Panel { left, top: head, width, height: 300.0, x: axis(), y: y.clone() };
            let lower = Panel { left, top: head + 318.0, width, height: 220.0, x: axis(), y: phase.clone() };
            upper.frame(canvas, false, index == 0);
            lower.frame(canvas, true, index == 0);
            heading(canvas, &upper, name, &lines[0].curves[index]);
            for line in lines {
                let curve = &line.curves[index];
                canvas.series(&line.label, |canvas| {
                    draw_curve(&upper, canvas, curve, line.stroke, per_drive(curve));
                    for run in unbroken(&data::steady(curve, degrees)) {
                        lower.curve(canvas, run, line.stroke);
                        if run.len() == 1 {
                            lower.marks(canvas, run, Mark::Circle, 3.0, line.stroke.color, true);
                        }
                    }
                });
            }
        }
    })
}

fn heading(canvas: &mut Canvas, panel: &Panel, name: &str, curve: &Curve) {
    let condition = &curve.condition;
    canvas.text((panel.left, panel.top - 47.0), name, Type::default().bold());
    let above = describe(condition, &[Field::Speed, Field::Load]);
    canvas.text((panel.left, panel.top - 28.0), &above, Type::default());
    canvas.text((panel.left, panel.top - 9.0), &Field::Drive(Signals::ARM.drive).equation(condition), Type::default());
}

fn csv(lines: &[Line<'_>]) -> String {
    let header = [
        "strength",
        "roller speed [mm/s]",
        "load [N]",
        "drive [µm]",
        "frequency [Hz]",
        "amplitude per drive [rad/m]",
        "phase [deg]",
        "status",
    ];
    let mut table = Table::new(&header);
    for (line, curve) in lines.iter().flat_map(|line| line.curves.iter().map(move |curve| (line, curve))) {
        let c = &curve.condition;
        for (f, s) in curve.frequency.iter().zip(&curve.states) {
            let numbers = [1e3 * c.speed, c.load, 1e6 * c.drive, *f, per_drive(curve)(s), s.phase.to_degrees()];
            let cells = numbers.map(cell).into_iter().chain([s.status.word().to_string()]);
            table.row(std::iter::once(line.label.clone()).chain(cells));
        }
    }
    table.finish()
}

/// Per condition the peak of the base and of the strongest curve that is steady throughout and has its peak within the
/// range.
fn notes(lines: &[Line<'_>]) -> Vec<(String, String)> {
    let peak = |curve: &Curve| data::peak(&data::steady(curve, per_drive(curve)));
    let text = |(f, a): (f64, f64)| format!("{} rad/m at {f:.1} Hz", significant(a, 3));
    let note = |(index, (name, _)): (usize, &(&str, _))| {
        let base = peak(&lines.first()?.curves[index])?;
        let whole = |line: &&Line<'_>| steady(&line.curves[index]) == line.curves[index].states.len();
        let within = |line: &Line<'_>| {
            let curve = &line.curves[index];
            let ends = [curve.frequency.first(), curve.frequency.last()];
            peak(curve).filter(|(f, _)| !ends.contains(&Some(f))).map(|peak| (line.label.clone(), peak))
        };
        let (label, with) = lines.iter().skip(1).rev().filter(whole).find_map(within)?;
        Some((format!("Peak, {}", name.to_lowercase()), format!("{}; {}: {}", text(base), label, text(with))))
    };
    CONDITIONS.iter().enumerate().filter_map(note).collect()
}
