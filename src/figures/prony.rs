//! Measured moduli with the series and the spring-pot that were fitted to them: one panel per reading.

use super::axes::{Axis, Panel};
use super::canvas::{Canvas, Dash, Point, Stroke, document};
use super::legend::{Entry, Key, legend, legend_width};
use super::marks::Mark;
use super::style::{Color, GAP, INK, LEFT, SHADE, SLIP, STATIC, TOP, Table, Unit, WIDTH, cell, significant};
use super::{Drawing, FigureError};
use crate::prony::{Analysis, Contact, Kind, branches, hertz};
use crate::units::{self, readable::percent};
use std::f64::consts::TAU;

/// Name of the figure; also the stem of its files.
pub const NAME: &str = "moduli";
const HEIGHT: f64 = 260.0;
const SERIES: Stroke = Stroke { color: STATIC, width: 2.4, dash: Dash::Solid };
const SPRING_POT: Stroke = Stroke { color: SLIP, width: 2.0, dash: Dash::Dashes(8.0, 5.0) };
const BRANCH: Stroke = Stroke { color: Color(0xaa, 0x44, 0x99), width: 4.0, dash: Dash::Solid };

/// Draws an analysis, and over its band the contact that stands for the series.
///
/// # Errors
/// [`FigureError::Render`] where an element cannot be drawn.
pub fn draw(analysis: &Analysis, contact: Option<&Contact>) -> Result<Drawing, FigureError> {
    let names = analysis.moduli.kind.names();
    let title = format!("Measured {} and fitted laws", names.join(" and "));
    let caption = format!(
        "Circles: measured. Solid: the series of {} ({} root mean square of the relative errors), shaded its 95 % band from \
         blocks of rows left out in turn. Dashed: the spring-pot ({}).",
        units::count(analysis.terms(), "term"),
        errors(analysis, &analysis.moduli.rms(&analysis.series.fitted)),
        errors(analysis, &analysis.moduli.rms(&analysis.spring_pot.fitted))
    );
    let against = if analysis.moduli.kind == Kind::Dynamic { "frequency" } else { "time" };
    let alt =
        format!("The measured {} against {against} on logarithmic axes, with two fitted curves.", names.join(" and "));
    let entries = entries(analysis, contact);
    let width = WIDTH - LEFT - legend_width(&entries) - 50.0;
    let bottom = TOP + (HEIGHT + GAP) * names.len() as f64 - GAP;
    let svg = document((WIDTH, bottom + 66.0), (&title, &alt), |canvas| {
        for (k, name) in names.iter().enumerate() {
            let top = TOP + (HEIGHT + GAP) * k as f64;
            let (x, y) = axes(analysis, k, name);
            let panel = Panel { left: LEFT, top, width, height: HEIGHT, x, y };
            pane(canvas, &panel, (analysis, contact), k);
        }
        legend(canvas, LEFT + width + 24.0, TOP - 12.0, &entries);
    })?;
    let reading = [
        "Circles on the solid line, and left-out blocks missed by little more than the rows that were fitted.",
        "Waves of the solid line about the circles (too few terms), or a distance on one side over decades, in storage and loss of \
         opposite sign: the moduli contradict each other.",
        "Measure a wider band where terms at its ends are large; take the law with fewer numbers where two do as well.",
    ];
    let drawn = Drawing::new((NAME, &title), (caption, alt), (svg, csv(analysis)), reading);
    Ok(Drawing { notes: notes(analysis), ..drawn })
}

/// Displayed place: frequency \[Hz\] or time \[s\].
fn place(analysis: &Analysis, x: f64) -> f64 {
    if analysis.moduli.kind == Kind::Dynamic { x / TAU } else { x }
}

/// A prefix that shows the middle of the readings.
fn unit(analysis: &Analysis, k: usize) -> Unit {
    let creep = analysis.moduli.kind == Kind::Creep;
    let logs = analysis.moduli.points.iter().map(|point| point.y[k].ln());
    let middle = (logs.sum::<f64>() / analysis.moduli.points.len() as f64).exp();
    let prefixes = [(1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")];
    let size = if creep { middle.recip() } else { middle };
    let (factor, name) = prefixes.into_iter().find(|(factor, _)| size >= *factor).unwrap_or(prefixes[3]);
    if creep { Unit::new(factor.recip(), &format!("1/{name}")) } else { Unit::new(factor, name) }
}

fn axes(analysis: &Analysis, k: usize, name: &str) -> (Axis, Axis) {
    let unit = unit(analysis, k);
    let measured = analysis.moduli.points.iter().map(|point| unit.of(point.y[k]));
    let curve = analysis.curve.iter().map(|(_, readings)| unit.of(readings[k].value));
    let symbol = match (analysis.moduli.kind, k) {
        (Kind::Dynamic, 0) => "E′",
        (Kind::Dynamic, _) => "E″",
        (Kind::Relaxation, _) => "E(t)",
        (Kind::Creep, _) => "J(t)",
    };
    let x = if analysis.moduli.kind == Kind::Dynamic { "frequency f [Hz]" } else { "time t [s]" };
    let places = analysis.curve.iter().map(|(x, _)| place(analysis, *x));
    let y = Axis::logarithmic(format!("{name} {symbol} [{}]", unit.label), measured.chain(curve), 0.06);
    (Axis::logarithmic(x, places, 0.02), y)
}

fn pane(canvas: &mut Canvas, panel: &Panel, (analysis, contact): (&Analysis, Option<&Contact>), k: usize) {
    let unit = unit(analysis, k);
    let last = k + 1 == analysis.moduli.kind.readings();
    panel.frame(canvas, last, true);
    let at = |x: f64, value: f64| (place(analysis, x), unit.of(value));
    let edge = |end: fn(&crate::prony::Interval) -> f64| -> Vec<Point> {
        let pixel = |(x, y): Point| (panel.px(x), panel.py(y).clamp(panel.top, panel.bottom()));
        analysis.curve.iter().map(|(x, readings)| pixel(at(*x, end(&readings[k])))).collect()
    };
    let outline: Vec<Point> = edge(|i| i.low).into_iter().chain(edge(|i| i.high).into_iter().rev()).collect();
    if outline.iter().all(|(x, y)| x.is_finite() && y.is_finite()) {
        canvas.series("95 % band", |canvas| canvas.within(panel, |canvas| canvas.polygon(&outline, SHADE, None)));
    }
    canvas.series("measured", |canvas| {
        let points: Vec<Point> = analysis.moduli.points.iter().map(|point| at(point.x, point.y[k])).collect();
        panel.marks(canvas, &points, Mark::Circle, 2.8, INK, false);
    });
    canvas.series("spring-pot", |canvas| {
        let value = |x: f64| analysis.spring_pot.fitted.value(analysis.moduli.kind, x)[k];
        let points: Vec<Point> = analysis.curve.iter().map(|(x, _)| at(*x, value(*x))).collect();
        panel.curve(canvas, &points, SPRING_POT);
    });
    canvas.series("series", |canvas| {
        let points: Vec<Point> = analysis.curve.iter().map(|(x, readings)| at(*x, readings[k].value)).collect();
        panel.curve(canvas, &points, SERIES);
    });
    if let Some(contact) = contact.filter(|_| analysis.moduli.kind == Kind::Dynamic) {
        canvas.series("as a contact", |canvas| panel.curve(canvas, &of_contact(contact, k, &unit), BRANCH));
    }
}

/// The contact over its band.
fn of_contact(contact: &Contact, k: usize, unit: &Unit) -> Vec<Point> {
    const PLACES: usize = 41;
    let [low, high] = contact.band_hz;
    let frequencies = (0..PLACES).map(|i| low * (high / low).powf(i as f64 / (PLACES - 1) as f64));
    let value = |f: f64| if k == 0 { contact.modulus(TAU * f).re } else { contact.modulus(TAU * f).im };
    frequencies.map(|f| (f, unit.of(value(f)))).collect()
}

fn entries(analysis: &Analysis, contact: Option<&Contact>) -> Vec<Entry> {
    let exponent = significant(analysis.exponent.value, 3);
    let mut entries = vec![
        (Key::Mark(Mark::Circle, INK, false), "measured".to_string()),
        (Key::Line(SERIES), format!("series, {}", units::count(analysis.terms(), "term"))),
        (Key::Patch(SHADE), "its 95 % band".to_string()),
        (Key::Line(SPRING_POT), format!("spring-pot, a = {exponent}")),
    ];
    if let Some(contact) = contact.filter(|_| analysis.moduli.kind == Kind::Dynamic) {
        entries.push((
            Key::Line(BRANCH),
            format!("{}, {}", branches(contact), hertz(contact.band_hz[0], contact.band_hz[1])),
        ));
    }
    entries
}

/// Relative errors of each reading.
fn errors(analysis: &Analysis, rms: &[f64]) -> String {
    let one = |(name, share): (&&str, &f64)| format!("{name} {}", percent(*share, 2));
    analysis.moduli.kind.names().iter().zip(rms).map(one).collect::<Vec<_>>().join(", ")
}

fn notes(analysis: &Analysis) -> Vec<(String, String)> {
    let left_out = |mean: f64| format!("{} at blocks that were left out", percent(mean.sqrt(), 2));
    let rms = |fitted| errors(analysis, &analysis.moduli.rms(fitted));
    let (series, pot) = (&analysis.series, &analysis.spring_pot);
    let a = analysis.exponent;
    let [low, high] = [a.low, a.high].map(|end| significant(end, 3));
    vec![
        ("Series".into(), format!("{}; {}", rms(&series.fitted), left_out(series.score.mean))),
        ("Spring-pot".into(), format!("{}; {}; a {low} to {high}", rms(&pot.fitted), left_out(pot.score.mean))),
    ]
}

fn csv(analysis: &Analysis) -> String {
    let kind = analysis.moduli.kind;
    let x = if kind == Kind::Dynamic { "frequency [Hz]" } else { "time [s]" };
    let unit = kind.unit();
    let value = |name: &str| format!("{name} [{unit}]");
    let header = ["reading", "curve", x, &value("value"), &value("low"), &value("high")];
    let mut table = Table::new(&header);
    for (k, name) in kind.names().iter().enumerate() {
        let mut row = |curve: &str, x: f64, values: [Option<f64>; 3]| {
            let cells = values.map(|value| value.map_or(String::new(), cell));
            let start = [name.to_string(), curve.into(), cell(place(analysis, x))];
            table.row(start.into_iter().chain(cells));
        };
        analysis.moduli.points.iter().for_each(|point| row("measured", point.x, [Some(point.y[k]), None, None]));
        for (x, readings) in &analysis.curve {
            row("series", *x, [Some(readings[k].value), Some(readings[k].low), Some(readings[k].high)]);
            row("spring-pot", *x, [Some(analysis.spring_pot.fitted.value(kind, *x)[k]), None, None]);
        }
    }
    table.finish()
}
