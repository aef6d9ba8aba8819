//! How curves are told apart: colour for the leading property, dashes for the rest, and the legend that says so.

use super::axes::Panel;
use super::canvas::{Canvas, Point, Stroke};
use super::data::{self, Field};
use super::legend::{Entry, Key};
use super::marks::Mark;
use super::style::{DASH_BAND, DASH_SLIP, DASH_STATIC, DASHES, INK, SLIP, SLIP_BAND, STATIC, STATIC_BAND, ramp};
use crate::solver::SteadyState;
use crate::sweep::{Curve, LimitCurve, LimitingCase, Outcome};

/// Most curves that get a legend entry each.
const MOST_ENTRIES: usize = 16;

/// A curve with its looks.
#[derive(Debug, Clone)]
pub struct Styled<'a> {
    /// The curve.
    pub curve: &'a Curve,
    /// Its line.
    pub stroke: Stroke,
    /// What tells it from the others.
    pub label: String,
}

/// Curves with their looks, and the legend.
#[derive(Debug, Clone)]
pub struct Scheme<'a> {
    /// The curves in input order.
    pub curves: Vec<Styled<'a>>,
    /// Legend entries.
    pub legend: Vec<Entry>,
    /// Whether lines are wider than those that coincide with them and are drawn later, so that all of them show.
    pub nested: bool,
}

impl<'a> Scheme<'a> {
    /// Colours by the first property that varies (speed before all others), dashes by the rest.
    pub fn of(curves: &[&'a Curve], outcome: &Outcome) -> Self {
        let fields = data::varying(curves, outcome);
        let only = if outcome.scenario.contact.is_some() {
            Field::Speed
        } else {
            Field::Drive(outcome.scenario.signals.drive)
        };
        let lead = fields.first().copied().unwrap_or(only);
        let rest: Vec<Field> = fields.iter().copied().filter(|field| *field != lead).collect();
        let values = lead.distinct(curves);
        let groups = data::groups(curves, lead);
        // A line is wider than those of its colour scale that will lie on it.
        let nested = rest.is_empty();
        let above = |i: usize| curves[i + 1..].iter().filter(|later| data::coincide(curves[i], later)).count().min(4);
        let styled: Vec<Styled<'_>> = curves
            .iter()
            .enumerate()
            .map(|(i, &curve)| {
                let rank = values.iter().position(|value| *value == lead.value(&curve.condition)).unwrap_or(0);
                let group = groups.iter().position(|group| group.iter().any(|c| std::ptr::eq(*c, curve))).unwrap_or(0);
                let width = 2.2 + if nested { 1.6 * above(i) as f64 } else { 0.0 };
                let stroke = Stroke::dashed(ramp(rank, values.len()), width, DASHES[group % DASHES.len()]);
                Styled { curve, stroke, label: label(curve, lead, &rest) }
            })
            .collect();
        let legend = if styled.len() <= MOST_ENTRIES {
            let title = if fields.len() == 1 || fields.is_empty() { heading(lead) } else { "Condition".into() };
            let entries = styled.iter().map(|s| (Key::Line(s.stroke), s.label.clone()));
            std::iter::once((Key::Heading, title)).chain(entries).collect()
        } else {
            grouped_legend(&styled, lead, &rest, &groups)
        };
        Self { curves: styled, legend, nested }
    }
}

fn label(curve: &Curve, lead: Field, rest: &[Field]) -> String {
    let mut text = lead.text(&curve.condition);
    for field in rest {
        let plain = matches!(field, Field::Load | Field::Formulation);
        text += ", ";
        text += &if plain { field.text(&curve.condition) } else { field.equation(&curve.condition) };
    }
    text
}

/// Legend heading of a property.
pub fn heading(field: Field) -> String {
    match field {
        Field::Speed => "Roller speed V".into(),
        Field::Drive(signal) => {
            let (first, rest) = signal.name.split_at(1);
            format!("{}{rest} {}", first.to_uppercase(), signal.symbol)
        }
        Field::Load => "Load W".into(),
        Field::Friction => "Friction µ".into(),
        Field::Formulation => "Formulation".into(),
    }
}

fn grouped_legend(styled: &[Styled<'_>], lead: Field, rest: &[Field], groups: &[Vec<&Curve>]) -> Vec<Entry> {
    let mut seen: Vec<(f64, Entry)> = Vec::new();
    for Styled { curve, stroke, .. } in styled {
        let value = lead.value(&curve.condition);
        if !seen.iter().any(|(other, _)| *other == value) {
            seen.push((value, (Key::Line(Stroke::solid(stroke.color, 3.0)), lead.text(&curve.condition))));
        }
    }
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let shown = data::spread(&seen, if rest.is_empty() { 20 } else { 14 });
    let thinned = if shown.len() < seen.len() { " (some of)" } else { "" };
    let mut legend = vec![(Key::Heading, format!("{}{thinned}", heading(lead)))];
    legend.extend(shown.into_iter().map(|(_, entry)| entry));
    if !rest.is_empty() {
        legend.push((Key::Heading, "Condition".into()));
        for (index, group) in groups.iter().enumerate().take(6) {
            let stroke = Stroke::dashed(INK, 2.0, DASHES[index % DASHES.len()]);
            legend.push((Key::Line(stroke), data::describe(&group[0].condition, rest)));
        }
    }
    legend
}

/// Draws the steady part of a curve as a line, lone points as dots, and self-excited points as open marks.
pub fn draw_curve(
    panel: &Panel,
    canvas: &mut Canvas,
    curve: &Curve,
    stroke: Stroke,
    quantity: impl Fn(&SteadyState) -> f64,
) {
    let points = data::steady(curve, &quantity);
    panel.curve(canvas, &points, stroke);
    let lone: Vec<Point> = (0..points.len())
        .filter(|&i| points[i].1.is_finite())
        .filter(|&i| i == 0 || !points[i - 1].1.is_finite())
        .filter(|&i| i + 1 == points.len() || !points[i + 1].1.is_finite())
        .map(|i| points[i])
        .collect();
    panel.marks(canvas, &lone, Mark::Circle, 5.0, stroke.color, true);
    panel.marks(canvas, &data::self_excited(curve, &quantity), Mark::Circle, 4.0, stroke.color, false);
}

/// The two limiting cases for a drive with their lines.
pub fn limits(outcome: &Outcome, drive: f64) -> Vec<(&LimitCurve, Stroke)> {
    let cases = [
        (LimitingCase::FreeOrFullSlip, limit_stroke(LimitingCase::FreeOrFullSlip)),
        (LimitingCase::StaticContact, limit_stroke(LimitingCase::StaticContact)),
    ];
    cases.into_iter().filter_map(|(case, stroke)| Some((data::limit(outcome, case, drive)?, stroke))).collect()
}

/// Draws part of a limiting case; a lone point as a mark.
pub fn draw_limit(panel: &Panel, canvas: &mut Canvas, points: &[Point], case: LimitingCase, stroke: Stroke) {
    canvas.series(limit_name(case), |canvas| {
        panel.curve(canvas, points, stroke);
        if points.len() == 1 {
            let (mark, color) = match case {
                LimitingCase::FreeOrFullSlip => (Mark::Triangle, SLIP),
                LimitingCase::StaticContact => (Mark::Square, STATIC),
            };
            panel.marks(canvas, points, mark, 6.0, color, false);
        }
    });
}

/// The line of a limiting case in its own colour.
pub fn limit_stroke(case: LimitingCase) -> Stroke {
    match case {
        LimitingCase::FreeOrFullSlip => Stroke::dashed(SLIP, 2.4, DASH_SLIP),
        LimitingCase::StaticContact => Stroke::dashed(STATIC, 2.4, DASH_STATIC),
    }
}

/// A pale line of a limiting case, wide enough to show under curves that lie on it.
pub fn limit_band(case: LimitingCase, curves: &[Styled<'_>]) -> Stroke {
    let width = 4.4 + curves.iter().map(|styled| styled.stroke.width).fold(2.2, f64::max);
    match case {
        LimitingCase::FreeOrFullSlip => Stroke::solid(SLIP_BAND, width),
        LimitingCase::StaticContact => Stroke::dashed(STATIC_BAND, width, DASH_BAND),
    }
}

/// Name of a limiting case.
pub fn limit_name(case: LimitingCase) -> &'static str {
    match case {
        LimitingCase::FreeOrFullSlip => "I/III: free or full slip",
        LimitingCase::StaticContact => "II: static contact",
    }
}

/// Limit curve as points of displayed values, restricted to a range of frequencies.
pub fn limit_points(limit: &LimitCurve, values: &[f64], (low, high): (f64, f64), factor: f64) -> Vec<Point> {
    let points = limit.frequency.iter().zip(values).map(|(&f, &value)| (f, value / factor));
    points.filter(|(f, _)| (low - 1e-9..=high + 1e-9).contains(f)).collect()
}
