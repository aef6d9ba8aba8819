//! What a header says: which column it is and in which unit its numbers are.

use super::frame::{DRIVES, Frame, READINGS, kind};
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
/// How many columns hold numbers.
pub(crate) const NUMBERS: usize = 9;
/// Position in `scenario::parameters::COLUMNS` of the columns that hold words.
pub(crate) const SERIES: usize = 9;
pub(crate) const SWEEP: usize = 10;
/// How many columns a table may have.
pub(crate) const ALL: usize = 11;

/// Names of columns in headers, and which column each is.
const NAMES: &[(&str, usize)] = &[
    ("speed", SPEED),
    ("load", LOAD),
    ("drive", DRIVE),
    ("force", DRIVE),
    ("torque", DRIVE),
    ("frequency", FREQUENCY),
    ("amplitude", AMPLITUDE),
    ("phase", PHASE),
    ("amplitude_sd", AMPLITUDE_SD),
    ("phase_sd", PHASE_SD),
    ("mean", MEAN),
];

/// Symbols that are read in whatever case they are written, unless two differ in nothing else.
const SYMBOLS: &[&str] = &[
    "m", "mm", "um", "nm", "cm", "km", "s", "ms", "min", "N", "mN", "uN", "kN", "MN", "Hz", "kHz", "rad", "mrad",
    "urad", "nrad", "deg", "V", "mV", "uV", "kV",
];

/// Standard gravity \[m/s^2\].
const GRAVITY: f64 = 9.806_65;

/// The unit of a column's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    /// As it is shown and handed to [`units::parse`].
    pub text: String,
    /// What its numbers become.
    pub si: &'static str,
    /// A share of the amplitude.
    pub relative: bool,
    /// The prefix of a unit of standard gravity.
    gravity: Option<&'static str>,
}

impl Unit {
    /// A unit in SI.
    pub fn of(si: &'static str) -> Self {
        Self { text: si.into(), si, relative: false, gravity: None }
    }

    /// A number of this unit in SI, rounded once.
    pub fn convert(&self, number: &str) -> Result<f64, UnitError> {
        match self.gravity {
            Some(prefix) => Ok(GRAVITY * units::parse(&format!("{number} {prefix}m/s^2"), self.si)?),
            None => units::parse(&format!("{number} {}", self.text), if self.relative { "1" } else { self.si }),
        }
    }
}

/// What a header may be.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Meaning {
    /// A column, its unit, and whether the header states the unit.
    Column(usize, Unit, bool),
    /// A column whose unit neither the header states nor the scenario implies.
    NoUnit(usize),
    /// A column whose unit does not serve, and why.
    BadUnit(usize, String),
    /// A column of words: [`SERIES`] or [`SWEEP`].
    Words(usize),
    /// Amplitude or phase of a harmonic.
    Harmonic,
    /// Not one of the columns.
    Unknown,
}

/// The meaning of a header without help from the scenario's mapping.
pub(crate) fn meaning(header: &str, frame: &Frame<'_>) -> Meaning {
    let (name, bracket) = split(header);
    let name = plain(name);
    if let (Some(column), None) = (words(&name), bracket) {
        return Meaning::Words(column);
    }
    if is_harmonic(&name) {
        return Meaning::Harmonic;
    }
    let exact = NAMES.iter().find(|(key, _)| *key == name);
    match (exact, bracket.filter(|text| !text.is_empty())) {
        (Some((key, column)), Some(text)) => match unit(text, key, *column, frame) {
            Ok(unit) => Meaning::Column(*column, unit, true),
            Err(why) => Meaning::BadUnit(*column, why),
        },
        (Some((key, column)), None) => match natural(key, *column, frame) {
            Some(si) => Meaning::Column(*column, Unit::of(si), false),
            None => Meaning::NoUnit(*column),
        },
        (None, bracket) => match (by_suffix(header, &name, frame), bracket) {
            (Some((key, Meaning::Column(column, suffix, _))), Some(text)) => match unit(text, key, column, frame) {
                Ok(unit) if unit.convert("1") == suffix.convert("1") => Meaning::Column(column, unit, true),
                Ok(_) => Meaning::BadUnit(column, "the name and the brackets state different units".into()),
                Err(why) => Meaning::BadUnit(column, why),
            },
            (found, _) => found.map_or(Meaning::Unknown, |(_, meaning)| meaning),
        },
    }
}

/// The column of words that a name stands for.
fn words(name: &str) -> Option<usize> {
    match name {
        "series" => Some(SERIES),
        "sweep" => Some(SWEEP),
        _ => None,
    }
}

/// `amplitude_2`, `phase_3_deg`: of a harmonic of the drive's frequency.
fn is_harmonic(name: &str) -> bool {
    let rest = name.strip_prefix("amplitude_").or_else(|| name.strip_prefix("phase_"));
    let rest = rest.map(|rest| rest.strip_prefix("sd_").unwrap_or(rest));
    rest.and_then(|rest| rest.split('_').next()).is_some_and(|order| matches!(order.as_bytes(), [b'2'..=b'9']))
}

/// SI units in which a column of this name may be.
fn possible(key: &str, column: usize) -> &'static [&'static str] {
    match (key, column) {
        ("force", _) => &["N", "V"],
        ("torque", _) => &["N m", "V"],
        (_, DRIVE) => DRIVES,
        (_, AMPLITUDE | AMPLITUDE_SD | MEAN) => READINGS,
        _ => std::slice::from_ref(&MEASURED[column].unit),
    }
}

/// The SI unit of a column of this name that states none.
fn natural(key: &str, column: usize, frame: &Frame<'_>) -> Option<&'static str> {
    match key {
        "force" => Some("N"),
        "torque" => Some("N m"),
        _ => frame.natural(column),
    }
}

/// The unit of a header that the scenario maps to a column: its bracket, its suffix, or nothing and thus SI.
pub(crate) fn mapped(header: &str, key: &str, column: usize, frame: &Frame<'_>) -> Result<(Unit, bool), String> {
    let (name, bracket) = split(header);
    if let Some(text) = bracket.filter(|text| !text.is_empty()) {
        return unit(text, key, column, frame).map(|unit| (unit, true));
    }
    let parts: Vec<&str> = name.trim().split(['_', ' ']).collect();
    let suffixes = (1..parts.len()).flat_map(|from| suffix(&parts[from..]));
    let found = suffixes.filter_map(|text| unit(&text, key, column, frame).ok()).next();
    let si = natural(key, column, frame).unwrap_or("m");
    Ok(found.map_or_else(|| (Unit::of(si), false), |unit| (unit, true)))
}

/// `amplitude_sd_percent`: the longest known name, then a unit.
fn by_suffix(header: &str, name: &str, frame: &Frame<'_>) -> Option<(&'static str, Meaning)> {
    let rest = |key: &str| name.strip_prefix(key).and_then(|rest| rest.strip_prefix('_'));
    let found = NAMES.iter().filter(|(key, _)| rest(key).is_some());
    let (key, column) = *found.max_by_key(|(key, _)| key.len())?;
    // The unit as it was written, in capitals where it has them.
    let written = split(header).0.trim();
    let tail = written.get(key.len() + 1..).unwrap_or_default();
    let parts: Vec<&str> = tail.split(['_', ' ']).collect();
    let read: Vec<_> = suffix(&parts).map(|text| (unit(&text, key, column, frame), known(&text))).collect();
    if let Some((Ok(unit), _)) = read.iter().find(|(unit, _)| unit.is_ok()) {
        return Some((key, Meaning::Column(column, unit.clone(), true)));
    }
    let why = read.into_iter().find_map(|(unit, known)| unit.err().filter(|_| known));
    Some((key, why.map_or(Meaning::Unknown, |why| Meaning::BadUnit(column, why))))
}

/// `mm`, `mm_s` and `mm_per_s` as units, `n_m` as a quotient and as a product; anything longer is none.
fn suffix(parts: &[&str]) -> impl Iterator<Item = String> {
    let list = match parts {
        [one] if !one.is_empty() => vec![(*one).to_string()],
        [above, "per", below] => vec![format!("{above}/{below}")],
        [above, below] => vec![format!("{above}/{below}"), format!("{above} {below}")],
        _ => Vec::new(),
    };
    list.into_iter()
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
fn unit(text: &str, key: &str, column: usize, frame: &Frame<'_>) -> Result<Unit, String> {
    let possible = possible(key, column);
    let si = natural(key, column, frame).unwrap_or(possible[0]);
    if let (Some(prefix), true) = (gravity(text), possible.contains(&"m/s^2")) {
        return Ok(Unit { text: text.into(), si: "m/s^2", relative: false, gravity: Some(prefix) });
    }
    let mut text = spelt(text);
    if key == "torque" && matches!(text.as_str(), "nm" | "mnm") {
        text = if text == "nm" { "N m".into() } else { "mN m".into() };
    }
    let text = text;
    let angle = |text: &str| ["rad", "deg", "°"].iter().any(|unit| text.contains(unit));
    if text == "%" {
        return if column == AMPLITUDE_SD {
            Ok(Unit { text, si, relative: true, gravity: None })
        } else {
            Err(format!("a share in % serves only for the amplitude's standard deviation, {si} is needed here"))
        };
    }
    // Angles have no dimension: they need to be named.
    let fits = |si: &str| {
        let named = si == "Hz" || angle(&text) == si.contains("rad");
        named && units::parse(&format!("1 {text}"), si).is_ok()
    };
    if let Some(si) = possible.iter().find(|si| fits(si)) {
        return Ok(Unit { text, si, relative: false, gravity: None });
    }
    units::parse(&format!("1 {text}"), si).map_err(|error| error.to_string())?;
    let wrong = if si == "rad" { "is no unit of an angle; use rad, mrad, urad or deg" } else { "is no such unit" };
    Err(format!("`{text}` {wrong}{}", if si == "rad" { String::new() } else { format!(": {} is needed", kind(si)) }))
}

/// The prefix of a unit of standard gravity.
fn gravity(text: &str) -> Option<&'static str> {
    match text {
        "g" | "G" | "gn" | "g_n" | "g0" => Some(""),
        "mg" => Some("m"),
        "ug" | "µg" | "μg" => Some("u"),
        _ => None,
    }
}

/// The unit in the spelling of [`units`]: words and capitals are forgiven, and powers without their sign.
fn spelt(text: &str) -> String {
    let mut spelt = String::new();
    let mut symbol = String::new();
    let mut chars = text.chars().chain([' ']).peekable();
    while let Some(c) = chars.next() {
        if c.is_alphabetic() || matches!(c, '°' | 'º' | '%') {
            symbol.push(c);
            continue;
        }
        let power = c.is_ascii_digit() || matches!(c, '-' | '−') && chars.peek().is_some_and(char::is_ascii_digit);
        let raised = !symbol.is_empty() && power;
        spelt += &canonical(&std::mem::take(&mut symbol));
        if raised {
            spelt.push('^');
        }
        spelt.push(if c == '−' { '-' } else { c });
    }
    spelt.trim().into()
}

fn canonical(symbol: &str) -> String {
    match symbol.to_lowercase().as_str() {
        "percent" | "pct" => return "%".into(),
        "degree" | "degrees" | "º" => return "deg".into(),
        "sec" => return "s".into(),
        _ => {}
    }
    let symbol = symbol.replace(['µ', 'μ'], "u");
    if let Some(prefix) = symbol.strip_suffix("Nm") {
        return format!("{prefix}N m");
    }
    if SYMBOLS.contains(&symbol.as_str()) {
        return symbol;
    }
    let mut alike = SYMBOLS.iter().filter(|known| known.eq_ignore_ascii_case(&symbol));
    match (alike.next(), alike.next()) {
        (Some(one), None) => (*one).into(),
        // `mn` in small letters: a mega would be written as a capital.
        (Some(milli), Some(_)) if symbol.chars().all(char::is_lowercase) => (*milli).into(),
        _ => symbol,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Headers in SI as the documentation has them, in the order of the columns.
    const STANDARD: [&str; NUMBERS] = [
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

    /// The meaning for the paper's rig.
    fn read(header: &str) -> Meaning {
        meaning(header, &Frame::of(&crate::scenario::paper()))
    }

    fn factor(header: &str, column: usize) -> f64 {
        match read(header) {
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
            (LOAD, 1e-3),
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
        for header in ["", "rpm", "load_cell_temperature", "load_id", "phase2_rad", "speed_mms"] {
            assert_eq!(read(header), Meaning::Unknown, "{header}");
        }
        let bad = ["speed [N]", "load_mm", "phase_percent", "phase [%]", "phase [1]", "drive [furlong]"];
        for header in bad {
            assert!(matches!(read(header), Meaning::BadUnit(..) | Meaning::Unknown), "{header}");
        }
        assert!(matches!(read("speed_mm_s [m/s]"), Meaning::BadUnit(SPEED, _)));
        assert!(matches!(read("speed [N]"), Meaning::BadUnit(SPEED, _)));
    }

    #[test]
    fn foreign_headers_bring_their_unit_or_si() {
        let paper = crate::scenario::paper();
        let frame = Frame::of(&paper);
        let mapped = |header, column| mapped(header, MEASURED[column].key, column, &frame);
        let value = |header, column| mapped(header, column).expect("a unit").0.convert("1").expect("a number");
        assert_eq!(value("f [kHz]", FREQUENCY), 1e3);
        assert_eq!(value("roller_speed_mm_s", SPEED), 1e-3);
        assert_eq!(value("f", FREQUENCY), 1.0);
        assert_eq!(value("my_frequency", FREQUENCY), 1.0);
        assert!(mapped("f [N]", FREQUENCY).is_err());
    }

    #[test]
    fn the_unit_tells_the_quantity() {
        let all = [
            ("force_n", DRIVE, "N", 1.0),
            ("force_mn", DRIVE, "N", 1e-3),
            ("force_kn", DRIVE, "N", 1e3),
            ("Force [µN]", DRIVE, "N", 1e-6),
            ("force_v", DRIVE, "V", 1.0),
            ("torque_n_m", DRIVE, "N m", 1.0),
            ("torque_mn_m", DRIVE, "N m", 1e-3),
            ("torque_nm", DRIVE, "N m", 1.0),
            ("torque [mNm]", DRIVE, "N m", 1e-3),
            ("torque [N·m]", DRIVE, "N m", 1.0),
            ("drive_rad", DRIVE, "rad", 1.0),
            ("drive_m_s2", DRIVE, "m/s^2", 1.0),
            ("drive_g", DRIVE, "m/s^2", 9.80665),
            ("drive_rad_s2", DRIVE, "rad/s^2", 1.0),
            ("drive_mv", DRIVE, "V", 1e-3),
            ("amplitude_m", AMPLITUDE, "m", 1.0),
            ("amplitude_um_s", AMPLITUDE, "m/s", 1e-6),
            ("amplitude_mm_s2", AMPLITUDE, "m/s^2", 1e-3),
            ("amplitude [m/s²]", AMPLITUDE, "m/s^2", 1.0),
            ("amplitude [m s^-2]", AMPLITUDE, "m/s^2", 1.0),
            ("amplitude [m/s2]", AMPLITUDE, "m/s^2", 1.0),
            ("amplitude [m·s−2]", AMPLITUDE, "m/s^2", 1.0),
            ("amplitude_g", AMPLITUDE, "m/s^2", 9.80665),
            ("amplitude [mg]", AMPLITUDE, "m/s^2", 9.80665e-3),
            ("amplitude_v", AMPLITUDE, "V", 1.0),
            ("amplitude_rad_s", AMPLITUDE, "rad/s", 1.0),
            ("amplitude_deg_s", AMPLITUDE, "rad/s", 1f64.to_radians()),
            ("amplitude_urad_s2", AMPLITUDE, "rad/s^2", 1e-6),
            ("amplitude_sd_mm", AMPLITUDE_SD, "m", 1e-3),
            ("amplitude_sd_g", AMPLITUDE_SD, "m/s^2", 9.80665),
        ];
        let frame = Frame::any();
        for (header, column, si, value) in all {
            let Meaning::Column(found, unit, true) = meaning(header, &frame) else { panic!("{header}") };
            assert_eq!((found, unit.si), (column, si), "{header}");
            assert!((unit.convert("1").expect("a number") / value - 1.0).abs() < 1e-14, "{header}");
        }
        assert_eq!(meaning("amplitude", &frame), Meaning::NoUnit(AMPLITUDE));
        assert_eq!(
            (meaning("series", &frame), meaning("Sweep", &frame)),
            (Meaning::Words(SERIES), Meaning::Words(SWEEP))
        );
        for header in ["amplitude_2_m", "phase_3_deg", "Amplitude 9 [mm]", "amplitude_sd_2_m"] {
            assert_eq!(meaning(header, &frame), Meaning::Harmonic, "{header}");
        }
        for header in ["amplitude_hz", "amplitude [1/s]", "force_mm", "torque [N]", "drive_m_s", "amplitude_kg"] {
            assert!(matches!(meaning(header, &frame), Meaning::BadUnit(..)), "{header}");
        }
    }
}
