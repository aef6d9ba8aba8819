//! Selections that several figures make from an outcome.

use super::FigureError;
use super::axes::{Axis, range};
use super::canvas::Point;
use super::style::{Unit, significant};
use crate::scenario::{Formulation, Signal, Signals};
use crate::solver::{Status, SteadyState};
use crate::sweep::{Condition, Curve, LimitCurve, LimitingCase, Outcome};
use crate::units::{self, Frequencies};

/// A property of a condition that may tell curves apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// V.
    Speed,
    /// The drive, u0 of the paper's rig.
    Drive(Signal),
    /// W.
    Load,
    /// mu.
    Friction,
    /// Formulation, with the steps of the Euler procedure.
    Formulation,
}

/// All of them, of a rig with that drive.
fn fields(drive: Signal) -> [Field; 5] {
    [Field::Speed, Field::Drive(drive), Field::Load, Field::Friction, Field::Formulation]
}

impl Field {
    /// A number that is equal exactly where the property is, and orders it.
    pub fn value(self, condition: &Condition) -> f64 {
        match (self, condition.formulation) {
            (Self::Speed, _) => condition.speed,
            (Self::Drive(_), _) => condition.drive,
            (Self::Load, _) => condition.load,
            (Self::Friction, _) => condition.friction,
            (Self::Formulation, Formulation::Series) => 0.0,
            (Self::Formulation, Formulation::Paper) => condition.euler_steps.max(1) as f64,
        }
    }

    /// The property in words, without its symbol.
    pub fn text(self, condition: &Condition) -> String {
        match (self, condition.formulation) {
            (Self::Speed, _) => Unit::speed().show(condition.speed, 4),
            (Self::Drive(signal), _) => drive(condition.drive, &signal, 4),
            (Self::Load, _) => format!("{} N", significant(condition.load, 4)),
            (Self::Friction, _) => significant(condition.friction, 4),
            (Self::Formulation, Formulation::Series) => "series".into(),
            (Self::Formulation, Formulation::Paper) => format!("Euler, {} steps", condition.euler_steps),
        }
    }

    /// The symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Speed => "V",
            Self::Drive(signal) => signal.symbol,
            Self::Load => "W",
            Self::Friction => "µ",
            Self::Formulation => "",
        }
    }

    /// Symbol and property, as `V = 0.01 mm/s`.
    pub fn equation(self, condition: &Condition) -> String {
        if self == Self::Formulation {
            self.text(condition)
        } else {
            format!("{} = {}", self.symbol(), self.text(condition))
        }
    }

    /// Distinct values in ascending order.
    pub fn distinct(self, curves: &[&Curve]) -> Vec<f64> {
        let mut values: Vec<f64> = curves.iter().map(|curve| self.value(&curve.condition)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }
}

/// The properties in which the curves of an outcome differ.
pub fn varying(curves: &[&Curve], outcome: &Outcome) -> Vec<Field> {
    let fields = fields(outcome.scenario.signals.drive);
    fields.into_iter().filter(|field| field.distinct(curves).len() > 1).collect()
}

/// What the given fields say about a condition, separated by commas.
pub fn describe(condition: &Condition, fields: &[Field]) -> String {
    fields.iter().map(|field| field.equation(condition)).collect::<Vec<_>>().join(", ")
}

/// Curves grouped by everything but the given field, in input order.
pub fn groups<'a>(curves: &[&'a Curve], but: Field) -> Vec<Vec<&'a Curve>> {
    let kind = std::mem::discriminant::<Field>;
    let others: Vec<Field> = fields(Signals::ARM.drive).into_iter().filter(|field| kind(field) != kind(&but)).collect();
    let mut groups: Vec<Vec<&Curve>> = Vec::new();
    for &curve in curves {
        let same = |group: &&mut Vec<&Curve>| {
            others.iter().all(|field| field.value(&group[0].condition) == field.value(&curve.condition))
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(curve),
            None => groups.push(vec![curve]),
        }
    }
    groups
}

/// Fails for a rig without a contact, of which the figure of that name has nothing to show.
///
/// # Errors
/// [`FigureError::MissingData`] in that case.
pub fn with_contact(outcome: &Outcome, figure: &str) -> Result<(), FigureError> {
    let need = "a rig with a [contact], and this one has none";
    if outcome.scenario.contact.is_some() { Ok(()) } else { Err(FigureError::missing(figure, need)) }
}

/// A drive with its unit, to so many digits: as the sentences have it, but for the paper's rig, whose figures have
/// their own way.
pub fn drive(value: f64, signal: &Signal, digits: usize) -> String {
    if *signal == Signals::ARM.drive {
        return Unit::fitting(value, signal.unit).show(value, digits);
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    units::printed(&units::format(rounded, signal.unit))
}

/// Name and symbol of what is read, as on an axis.
pub fn reading(signals: &Signals) -> String {
    let reading = &signals.reading;
    if signals.of_arm() {
        return format!("amplitude {}", reading.symbol);
    }
    format!("{} amplitude {}", reading.name, reading.symbol)
}

/// The same per drive.
pub fn reading_per_drive(signals: &Signals) -> String {
    let (drive, reading) = (&signals.drive, &signals.reading);
    let name = if signals.of_arm() { "amplitude" } else { reading.name };
    // The symbol says of which kind; a longer name does not fit beside a small panel.
    let per = if drive.order == 0 { drive.name } else { "drive" };
    format!("{name} per {per} {}/{}", reading.symbol, drive.symbol)
}

/// How the frequencies of an outcome are written; those of the paper's rig as the paper has them.
pub fn frequencies(outcome: &Outcome) -> Frequencies {
    if outcome.scenario.signals.of_arm() {
        return Frequencies { factor: 1.0, unit: "Hz", decimals: 2 };
    }
    Frequencies::of(outcome.curves.first().into_iter().flat_map(|curve| curve.frequency.iter().copied()))
}

/// All curves that have at least one frequency.
pub fn curves(outcome: &Outcome) -> Vec<&Curve> {
    outcome.curves.iter().filter(|curve| !curve.frequency.is_empty() && !curve.states.is_empty()).collect()
}

/// The limiting case for a drive, or for the first drive where that one is not listed.
pub fn limit(outcome: &Outcome, case: LimitingCase, drive: f64) -> Option<&LimitCurve> {
    let same = |limit: &&LimitCurve| limit.case == case && !limit.frequency.is_empty();
    let of_drive = outcome.limits.iter().filter(same).find(|limit| limit.drive == drive);
    of_drive.or_else(|| outcome.limits.iter().find(same))
}

/// A quantity against frequency: missing (NaN) where the point is not a steady state.
pub fn steady(curve: &Curve, quantity: impl Fn(&SteadyState) -> f64) -> Vec<Point> {
    let value = |state: &SteadyState| if state.status == Status::Steady { quantity(state) } else { f64::NAN };
    curve.frequency.iter().zip(&curve.states).map(|(&f, state)| (f, value(state))).collect()
}

/// A quantity at the self-excited points, which are shown as open marks.
pub fn self_excited(curve: &Curve, quantity: impl Fn(&SteadyState) -> f64) -> Vec<Point> {
    let points = curve.frequency.iter().zip(&curve.states);
    points.filter(|(_, s)| matches!(s.status, Status::SelfExcited(_))).map(|(&f, s)| (f, quantity(s))).collect()
}

/// The range of frequencies that a figure of these curves spans; widened where there is only one frequency.
pub fn span(curves: &[&Curve]) -> Point {
    let (low, high) = range(curves.iter().flat_map(|curve| curve.frequency.iter().copied()));
    let axis = Axis::linear("", low, high);
    (axis.low, axis.high)
}

/// Whether two curves have the same amplitudes to a millionth of the largest.
pub fn coincide(a: &Curve, b: &Curve) -> bool {
    let limit = 1e-6 * range(a.states.iter().map(|state| state.amplitude)).1;
    let mut pairs = a.states.iter().zip(&b.states);
    a.frequency == b.frequency && pairs.all(|(s, t)| (s.amplitude - t.amplitude).abs() <= limit)
}

/// The word for a status in a CSV file.
pub fn status_word(status: &Status) -> &'static str {
    match status {
        Status::Steady => "steady",
        Status::SelfExcited(_) => "self-excited",
        Status::Stuck => "stuck",
        Status::Failed(_) => "failed",
    }
}

/// One sentence that counts the points that are not steady states; empty where all are.
pub fn health(curves: &[&Curve]) -> String {
    let states = || curves.iter().flat_map(|curve| &curve.states);
    let count = |word: &str| states().filter(|state| status_word(&state.status) == word).count();
    let (excited, failed, total) = (count("self-excited"), count("failed"), states().count());
    if excited + failed == 0 {
        return String::new();
    }
    format!(
        " Of {total} points {excited} {} self-excited (open marks: lock-in averages) and {failed} failed (gaps); no line joins across them.",
        if excited == 1 { "is" } else { "are" }
    )
}

/// The maximum of a curve through its largest point and its two neighbours: position and value.
///
/// Exact for a parabola on any grid; the grid point itself at either end; `None` where no value is finite.
pub fn peak(points: &[Point]) -> Option<Point> {
    let finite: Vec<Point> = points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    let best = (0..finite.len()).max_by(|&i, &j| finite[i].1.total_cmp(&finite[j].1).then(j.cmp(&i)))?;
    if best == 0 || best + 1 == finite.len() {
        return Some(finite[best]);
    }
    let [(x0, y0), (x1, y1), (x2, y2)] = [finite[best - 1], finite[best], finite[best + 1]];
    let (left, right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let curvature = (right - left) / (x2 - x0);
    if curvature >= 0.0 || curvature.is_nan() {
        return Some(finite[best]);
    }
    // Newton's form y = y1 + slope (x - x1) + curvature (x - x1)^2 with the slope at x1.
    let slope = left + curvature * (x1 - x0);
    let shift = -slope / (2.0 * curvature);
    Some((x1 + shift, y1 + 0.5 * slope * shift))
}

/// Where a curve crosses a level, by bisection of the cubic through the four points around each crossing.
pub fn crossings(points: &[Point], level: f64) -> Vec<f64> {
    let mut roots = Vec::new();
    for i in 1..points.len() {
        let (before, after) = (points[i - 1].1 - level, points[i].1 - level);
        if !(before.is_finite() && after.is_finite()) || (before < 0.0) == (after < 0.0) {
            continue;
        }
        let first = i.saturating_sub(2).min(points.len().saturating_sub(4));
        let nodes = &points[first..(first + 4).min(points.len())];
        let (mut low, mut high) = (points[i - 1].0, points[i].0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if (interpolate(nodes, middle) - level < 0.0) == (before < 0.0) { low = middle } else { high = middle }
        }
        roots.push(0.5 * (low + high));
    }
    roots
}

fn interpolate(nodes: &[Point], x: f64) -> f64 {
    let weight = |i: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, node)| (x - node.0) / (nodes[i].0 - node.0)).product()
    };
    nodes.iter().enumerate().map(|(i, node)| node.1 * weight(i)).sum()
}

/// At most `count` of the items, evenly spread, the first and the last among them.
pub fn spread<T: Clone>(items: &[T], count: usize) -> Vec<T> {
    if items.len() <= count || count < 2 {
        return items.iter().take(count.max(1).max(items.len().min(count))).cloned().collect();
    }
    (0..count).map(|k| items[k * (items.len() - 1) / (count - 1)].clone()).collect()
}
