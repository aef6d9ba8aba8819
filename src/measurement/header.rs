//! What a header says: which column it is and in which unit its numbers are.

use crate::scenario::parameters::MEASURED;
use crate::units::{self, UnitError};

/// Position of a column in [`MEASURED`] and in `scenario::parameters::COLUMNS`.
pub(crate) const SPEED: usize = 0;
pub(crate) const LOAD: usize = 1;
pub(crate) const DRIVE: usize = 2;
pub(crate) const FREQUENCY: usize = 3;
pub(crate) const AMPLITUDE: usize = 4;
pub(crate) const PHASE: usize = 5;
pub(crate) const AMPLITUDE_SD: usize = 6;
pub(crate) const PHASE_SD: usize = 7;
pub(crate) const MEAN: usize = 8;

/// Headers in SI as the documentation has them, in the order of the columns.
pub(crate) const STANDARD: [&str; 9] = [
    "speed_m_s",
    "load_n",
    "drive_m",
    "frequency_hz",
    "amplitude_rad",
    "phase_rad",
    "amplitude_sd_rad",
    "phase_sd_rad",
    "mean_rad",
];

/// Symbols that are read in whatever case they are written, unless two differ in nothing else.
const SYMBOLS: &[&str] = &[
    "m", "mm", "um", "nm", "cm", "km", "s", "ms", "min", "N", "mN", "uN", "kN", "MN", "Hz", "kHz", "rad", "mrad",
    "urad", "nrad", "deg",
];

/// The unit of a column's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    /// As it is handed to [`units::parse`].
    pub text: String,
    /// What its numbers become.
    pub si: &'static str,
    /// A share of the amplitude.
    pub relative: bool,
}

impl Unit {
    /// The SI unit of a column.
    pub fn si(column: usize) -> Self {
        let si = MEASURED[column].unit;
        Self { text: si.into(), si, relative: false }
    }

    /// A number of this unit in SI, rounded once.
    pub fn convert(&self, number: &str) -> Result<f64, UnitError> {
        units::parse(&format!("{number} {}", self.text), if self.relative { "1" } else { self.si })
    }
}

/// What a header may be.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Meaning {
    /// A column, its unit, and whether the header states the unit.
    Column(usize, Unit, bool),
    /// A column whose unit does not serve, and why.
    BadUnit(usize, String),
    /// Not one of the columns.
    Unknown,
}

/// The meaning of a header without help from the scenario.
pub(crate) fn meaning(header: &str) -> Meaning {
    let (name, bracket) = split(header);
    let name = plain(name);
    let exact = MEASURED.iter().position(|info| info.key == name);
    match (exact, bracket) {
        (Some(column), Some(text)) => match unit(text, column) {
            Ok(unit) => Meaning::Column(column, unit, true),
            Err(why) => Meaning::BadUnit(column, why),
        },
        (Some(column), None) => Meaning::Column(column, Unit::si(column), false),
        (None, bracket) => match (by_suffix(header, &name), bracket) {
            (Meaning::Column(column, suffix, _), Some(text)) => match unit(text, column) {
                Ok(unit) if unit.convert("1") == suffix.convert("1") => Meaning::Column(column, unit, true),
                Ok(_) => Meaning::BadUnit(column, "the name and the brackets state different units".into()),
                Err(why) => Meaning::BadUnit(column, why),
            },
            (meaning, _) => meaning,
        },
    }
}

/// The unit of a header that the scenario maps to a column: its bracket, its suffix, or nothing and thus SI.
pub(crate) fn mapped(header: &str, column: usize) -> Result<(Unit, bool), String> {
    let (name, bracket) = split(header);
    if let Some(text) = bracket {
        return unit(text, column).map(|unit| (unit, true));
    }
    let parts: Vec<&str> = name.trim().split('_').collect();
    let suffixes = (1..parts.len()).filter_map(|from| suffix(&parts[from..]));
    let found = suffixes.filter_map(|text| unit(&text, column).ok()).next();
    Ok(found.map_or_else(|| (Unit::si(column), false), |unit| (unit, true)))
}

/// `amplitude_sd_percent`: the longest known name, then a unit.
fn by_suffix(header: &str, name: &str) -> Meaning {
    let rest = |key: &str| name.strip_prefix(key).and_then(|rest| rest.strip_prefix('_'));
    let found = MEASURED.iter().enumerate().filter(|(_, info)| rest(info.key).is_some());
    let Some((column, info)) = found.max_by_key(|(_, info)| info.key.len()) else { return Meaning::Unknown };
    // The unit as it was written, in capitals where it has them.
    let written = split(header).0.trim();
    let tail = written.get(info.key.len() + 1..).unwrap_or_default();
    let parts: Vec<&str> = tail.split('_').collect();
    match suffix(&parts).map(|text| (unit(&text, column), known(&text))) {
        Some((Ok(unit), _)) => Meaning::Column(column, unit, true),
        Some((Err(why), true)) => Meaning::BadUnit(column, why),
        _ => Meaning::Unknown,
    }
}

/// `mm`, `mm_s` and `mm_per_s` as units; anything longer is none.
fn suffix(parts: &[&str]) -> Option<String> {
    match parts {
        [one] if !one.is_empty() => Some((*one).to_string()),
        [above, below] | [above, "per", below] => Some(format!("{above}/{below}")),
        _ => None,
    }
}

/// Name and bracket of `speed [mm/s]` and `speed (mm/s)`.
fn split(header: &str) -> (&str, Option<&str>) {
    let header = header.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = header.strip_suffix(close)
            && let Some(at) = inner.rfind(open)
        {
            return (header[..at].trim(), Some(inner[at + 1..].trim()));
        }
    }
    (header, None)
}

/// Lower case, words joined by underscores.
fn plain(name: &str) -> String {
    name.to_lowercase().replace([' ', '-'], "_")
}

/// Whether the text is a unit of anything, apart from the symbol `1`.
fn known(text: &str) -> bool {
    matches!(units::parse(&format!("1 {}", spelt(text)), "m"), Ok(_) | Err(UnitError::Dimension { .. }))
}

/// The unit of a column from its text, or why it does not serve.
pub(crate) fn unit(text: &str, column: usize) -> Result<Unit, String> {
    if text.is_empty() {
        return Ok(Unit::si(column));
    }
    let text = spelt(text);
    let si = MEASURED[column].unit;
    let angle = |text: &str| ["rad", "deg", "°"].iter().any(|unit| text.contains(unit));
    if text == "%" {
        return if column == AMPLITUDE_SD {
            Ok(Unit { text, si, relative: true })
        } else {
            Err(format!("a share in % serves only for the amplitude's standard deviation, {si} is needed here"))
        };
    }
    units::parse(&format!("1 {text}"), si).map_err(|error| error.to_string())?;
    if si == "rad" && !angle(&text) {
        return Err(format!("`{text}` is no unit of an angle; use rad, mrad, urad or deg"));
    }
    Ok(Unit { text, si, relative: false })
}

/// The unit in the spelling of [`units`]: words and capitals are forgiven.
fn spelt(text: &str) -> String {
    let mut spelt = String::new();
    let mut symbol = String::new();
    for c in text.chars().chain([' ']) {
        if c.is_alphabetic() || matches!(c, '°' | 'º' | '%') {
            symbol.push(c);
        } else {
            spelt += &canonical(&std::mem::take(&mut symbol));
            spelt.push(c);
        }
    }
    spelt.trim().into()
}

fn canonical(symbol: &str) -> String {
    match symbol.to_lowercase().as_str() {
        "percent" | "pct" => return "%".into(),
        "degree" | "degrees" | "º" => return "deg".into(),
        _ => {}
    }
    let symbol = symbol.replace(['µ', 'μ'], "u");
    if SYMBOLS.contains(&symbol.as_str()) {
        return symbol;
    }
    let mut alike = SYMBOLS.iter().filter(|known| known.eq_ignore_ascii_case(&symbol));
    match (alike.next(), alike.next()) {
        (Some(one), None) => (*one).into(),
        _ => symbol,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn factor(header: &str, column: usize) -> f64 {
        match meaning(header) {
            Meaning::Column(found, unit, _) if found == column => unit.convert("1").expect("a number"),
            other => panic!("{header}: {other:?}"),
        }
    }

    #[test]
    fn names_units_and_capitals() {
        for (column, header) in STANDARD.iter().enumerate() {
            assert_eq!(factor(header, column), 1.0, "{header}");
            assert_eq!(factor(&header.to_uppercase(), column), 1.0, "{header}");
        }
        let one = [
            ("speed_mm_s", SPEED, 1e-3),
            ("Speed [mm/s]", SPEED, 1e-3),
            ("speed (MM/S)", SPEED, 1e-3),
            ("speed_mm_per_s", SPEED, 1e-3),
            ("speed", SPEED, 1.0),
            ("load_kN", LOAD, 1e3),
            ("load_kn", LOAD, 1e3),
            ("load [mN]", LOAD, 1e-3),
            ("drive_um", DRIVE, 1e-6),
            ("drive [µm]", DRIVE, 1e-6),
            ("drive [μm]", DRIVE, 1e-6),
            ("drive_µm", DRIVE, 1e-6),
            ("frequency [rad/s]", FREQUENCY, 1.0 / TAU),
            ("frequency_khz", FREQUENCY, 1e3),
            ("amplitude_urad", AMPLITUDE, 1e-6),
            ("amplitude_mrad", AMPLITUDE, 1e-3),
            ("phase [°]", PHASE, 1f64.to_radians()),
            ("phase_deg", PHASE, 1f64.to_radians()),
            ("phase_degrees", PHASE, 1f64.to_radians()),
            ("amplitude_sd_percent", AMPLITUDE_SD, 1e-2),
            ("Amplitude SD [%]", AMPLITUDE_SD, 1e-2),
            ("phase_sd_deg", PHASE_SD, 1f64.to_radians()),
            ("speed_mm_s [mm/s]", SPEED, 1e-3),
        ];
        for (header, column, value) in one {
            assert!((factor(header, column) / value - 1.0).abs() < 1e-14, "{header}");
        }
    }

    #[test]
    fn what_is_no_column_or_no_unit_of_it() {
        for header in ["", "rpm", "load_cell_temperature", "load_id", "phase2_rad", "speed_mms", "amplitude_v"] {
            assert_eq!(meaning(header), Meaning::Unknown, "{header}");
        }
        let bad = ["speed [N]", "load_mm", "phase_percent", "phase [%]", "phase [1]", "load_mn", "drive [furlong]"];
        for header in bad {
            assert!(matches!(meaning(header), Meaning::BadUnit(..) | Meaning::Unknown), "{header}");
        }
        assert!(matches!(meaning("speed_mm_s [m/s]"), Meaning::BadUnit(SPEED, _)));
        assert!(matches!(meaning("speed [N]"), Meaning::BadUnit(SPEED, _)));
    }

    #[test]
    fn foreign_headers_bring_their_unit_or_si() {
        let value = |header, column| mapped(header, column).expect("a unit").0.convert("1").expect("a number");
        assert_eq!(value("f [kHz]", FREQUENCY), 1e3);
        assert_eq!(value("roller_speed_mm_s", SPEED), 1e-3);
        assert_eq!(value("f", FREQUENCY), 1.0);
        assert_eq!(value("my_frequency", FREQUENCY), 1.0);
        assert!(mapped("f [N]", FREQUENCY).is_err());
    }
}
