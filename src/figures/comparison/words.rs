//! How conditions are named, and which of many are shown.

use crate::compare::{Comparison, Setting};
use crate::figures::data::{self, reading, reading_per_drive};
use crate::figures::style::{Unit, cell, significant};
use crate::measurement::{Direction, Series};
use crate::scenario::Signals;

/// Panels or curves that a figure shows at most.
pub const MOST: usize = 16;

/// The speed, as `V = 0.1 mm/s`.
pub fn speed(setting: &Setting) -> String {
    format!("V = {}", speed_value(setting.speed))
}

/// The speed alone.
pub fn speed_value(speed: f64) -> String {
    if speed == 0.0 { "0 mm/s".into() } else { Unit::speed().show(speed, 3) }
}

/// Load and drive, as `W = 20 N, u₀ = 2.5 µm`.
fn load_and_drive(setting: &Setting) -> String {
    format!("W = {} N, {}", significant(setting.load, 3), drive_equation(setting))
}

/// The drive, as `F₀ = 0.3 N`.
fn drive_equation(setting: &Setting) -> String {
    format!("{} = {}", setting.signal.symbol, drive(setting))
}

/// The drive alone.
pub fn drive(setting: &Setting) -> String {
    data::drive(setting.drive, &setting.signal, 3)
}

/// A condition in one line, given its index.
pub fn condition(comparison: &Comparison, condition: usize) -> String {
    let setting = &comparison.conditions[condition].setting;
    let told = match setting.contact {
        true => format!("{}, {}", speed(setting), load_and_drive(setting)),
        false => drive_equation(setting),
    };
    after_series(comparison, condition, told)
}

/// Without symbols, for narrow legends.
pub fn brief(comparison: &Comparison, condition: usize) -> String {
    let setting = &comparison.conditions[condition].setting;
    let told = match setting.contact {
        true => format!("{}, {} N, {}", speed_value(setting.speed), significant(setting.load, 3), drive(setting)),
        false => drive(setting),
    };
    after_series(comparison, condition, told)
}

/// What is told of a condition after its series, where that has a name or is not told from others by the rest.
fn after_series(comparison: &Comparison, condition: usize, told: String) -> String {
    match series(comparison, condition) {
        series if series.is_empty() => told,
        series => format!("{series}, {told}"),
    }
}

/// The series by its name, or by its number where nothing else tells it from others.
fn series(comparison: &Comparison, condition: usize) -> String {
    let setting = &comparison.conditions[condition].setting;
    match (setting.name.as_str(), setting.number) {
        ("", 0) => String::new(),
        ("", number) => format!("series {number}"),
        (name, _) => format!("series {}", short(name)),
    }
}

/// Two lines over the panel of a condition, given its index.
pub fn heading(comparison: &Comparison, condition: usize) -> (String, String) {
    let setting = &comparison.conditions[condition].setting;
    let course = comparison.table.series.get(condition).map_or_else(String::new, |series| course(series, setting));
    let parts = [series(comparison, condition), course];
    let series = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
    match (setting.contact, series.is_empty()) {
        (true, true) => (speed(setting), load_and_drive(setting)),
        (true, false) => (speed(setting), format!("{}, {series}", load_and_drive(setting))),
        (false, _) => (drive_equation(setting), series),
    }
}

/// How far the drive of a series changed, and whether its frequency went the unusual way.
fn course(series: &Series, setting: &Setting) -> String {
    let mut parts = Vec::new();
    let (least, most) = series.drives;
    let [low, high] = [least, most].map(|drive| data::drive(drive, &setting.signal, 3));
    if low != high {
        // One unit for both, where they have the same.
        let unit = |text: &str| text.split_once(' ').map(|(_, unit)| unit.to_string());
        let number = low.split(' ').next().unwrap_or(&low);
        let from = if unit(&low) == unit(&high) { number } else { &low };
        parts.push(format!("{from} to {high}"));
    }
    // Unless its name says so.
    if series.direction == Direction::Down && !series.name.to_lowercase().contains("down") {
        parts.push("down".into());
    }
    parts.join(", ")
}

/// A name of a user's that leaves room for what else is said.
fn short(name: &str) -> String {
    match name.char_indices().nth(18) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.into(),
    }
}

/// What a row of a figure stands for, with the symbols that name it.
pub fn row(comparison: &Comparison) -> String {
    let drive = comparison.table.signals.drive;
    let words = format!("{} {}", drive.name, drive.symbol);
    match comparison.model.has_contact {
        true => format!("condition (speed V, load W, {words})"),
        false if comparison.conditions.iter().any(|c| c.setting.number > 0) => format!("series ({words})"),
        false => format!("condition ({words})"),
    }
}

/// Indices of the `most` conditions with the largest misfit, in their own order.
pub fn worst(comparison: &Comparison, most: usize) -> Vec<usize> {
    let chi2 = |i: &usize| {
        let metrics = &comparison.conditions[*i].metrics;
        metrics.chi2_per_point * metrics.readings as f64
    };
    let has_readings = |i: &usize| comparison.conditions[*i].metrics.readings > 0;
    let mut order: Vec<usize> = (0..comparison.conditions.len()).filter(has_readings).collect();
    order.sort_by(|a, b| chi2(b).total_cmp(&chi2(a)).then(a.cmp(b)));
    order.truncate(most);
    order.sort_unstable();
    order
}

/// Indices of the conditions shown, in their own order: all of them, or where there are too many the worst by chi2; and
/// what the caption says of that.
pub fn shown(comparison: &Comparison) -> (Vec<usize>, String) {
    let count = comparison.conditions.len();
    let told = match count > MOST {
        true => format!(" Of {count} conditions the {MOST} with the largest misfit are shown; the CSV has all."),
        false => String::new(),
    };
    (worst(comparison, MOST), told)
}

/// Whether amplitudes are shown per drive: where there are several drives, so that one scale serves all, or where a
/// drive changes along a curve.
pub fn per_drive(comparison: &Comparison) -> bool {
    comparison.conditions.windows(2).any(|pair| pair[0].setting.drive != pair[1].setting.drive)
        || comparison.table.series.iter().any(|series| series.drives.0 != series.drives.1)
}

/// How amplitudes are shown: per drive, or in a unit with prefix.
pub struct Amplitude {
    per_drive: bool,
    unit: Unit,
    signals: Signals,
}

impl Amplitude {
    /// The way that suits a comparison.
    pub fn of(comparison: &Comparison) -> Self {
        let (per_drive, signals) = (per_drive(comparison), comparison.table.signals);
        let points = || comparison.points.iter().map(|p| &p.point);
        let unit = if per_drive {
            let largest = points().map(|p| p.amplitude / p.drive).filter(|ratio| ratio.is_finite()).fold(0.0, f64::max);
            // Of the paper's rig the ratio has no prefix, here as in the atlas.
            let largest = if signals.of_arm() { 1.0 } else { largest };
            Unit::of_ratio(largest, (signals.reading.unit, signals.drive.unit))
        } else {
            Unit::of_signal(points().map(|p| p.amplitude).fold(0.0, f64::max), signals.reading.unit)
        };
        Self { per_drive, unit, signals }
    }

    /// An amplitude under a drive, as shown.
    pub fn value(&self, amplitude: f64, drive: f64) -> f64 {
        self.unit.of(if self.per_drive { amplitude / drive } else { amplitude })
    }

    /// Name with unit.
    pub fn label(&self) -> String {
        let name = if self.per_drive { reading_per_drive(&self.signals) } else { reading(&self.signals) };
        format!("{name} [{}]", self.unit.label)
    }
}

/// Header of the columns of a CSV file that name a condition.
pub fn columns_of_condition(comparison: &Comparison) -> Vec<String> {
    let drive = &comparison.table.signals.drive;
    let name = if comparison.table.signals.of_arm() { "drive" } else { drive.name };
    let drive = format!("{name} [{}]", drive.unit);
    match comparison.model.has_contact {
        true => vec!["speed [m/s]".into(), "load [N]".into(), drive],
        false => vec!["series".into(), drive],
    }
}

/// What stands in those columns for a condition.
pub fn cells_of_condition(comparison: &Comparison, condition: usize) -> Vec<String> {
    let setting = &comparison.conditions[condition].setting;
    let name = comparison.table.series.get(condition).map_or("", |series| &series.name);
    // In full, unlike in a label.
    let series = if name.is_empty() { (condition + 1).to_string() } else { name.to_string() };
    match setting.contact {
        true => [setting.speed, setting.load, setting.drive].map(cell).to_vec(),
        false => vec![series, cell(setting.drive)],
    }
}
