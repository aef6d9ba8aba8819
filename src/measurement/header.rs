//! What a header says: which column it is and in which unit its numbers are.

use super::frame::{DRIVES, Frame, READINGS, kind};
use super::likely::{MEANS, likely};
use super::names::{
    ALIASES, AMPLITUDE, AMPLITUDE_SD, DRIVE, FREQUENCY, MEAN, NAMES, PHASE, SAYING, SCATTERING, SERIES, SWEEP,
};
use super::unit::{Unit, Wanted, electrical, gravity, known, suffix};
use crate::scenario::parameters::MEASURED;

/// Spellings of one over a second.
const PER_SECOND: [&str; 5] = ["1/s", "s^-1", "s-1", "s⁻¹", "s−1"];

/// What a header may be.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Meaning {
    /// A column, its unit, and whether the header states the unit.
    Column(usize, Unit, bool),
    /// The same by another name, which serves where no column has the name itself.
    Alias(usize, Unit, bool),
    /// What words and unit together speak for; serves where no column has one of the names.
    Likely(usize, Unit),
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
    // The channel of an instrument, as in `TR1: Gain (dB)`.
    let header = header.split_once(": ").map_or(header, |(_, name)| name);
    let (name, bracket) = split(header);
    let name = plain(name);
    let name = averaged(&name);
    if let (Some(column), None) = (words(name), bracket) {
        return Meaning::Words(column);
    }
    if is_harmonic(name) {
        return Meaning::Harmonic;
    }
    match by_name(header, name, bracket, frame) {
        Meaning::Unknown => by_alias(header, name, bracket, frame)
            .or_else(|| by_alias(header, "frf", bracket.filter(|_| is_quotient(name)), frame))
            .or_else(|| likely(name, bracket).map(|(column, unit)| Meaning::Likely(column, unit)))
            .unwrap_or(Meaning::Unknown),
        found => found,
    }
}

/// Whether a name is that of a reading over that of a drive: `Acceleration/Force`.
fn is_quotient(name: &str) -> bool {
    let is = |name: &str, column: usize| {
        let known = NAMES.iter().copied().chain(ALIASES.iter().map(|alias| (alias.name, alias.column)));
        known.into_iter().any(|known| known == (name.trim_matches('_'), column))
    };
    name.split_once('/').is_some_and(|(over, under)| is(over, AMPLITUDE) && is(under, DRIVE))
}

/// One of [`NAMES`].
fn by_name(header: &str, name: &str, bracket: Option<&str>, frame: &Frame<'_>) -> Meaning {
    let exact = NAMES.iter().find(|(key, _)| *key == name);
    let Some(&(key, column)) = exact else {
        return match (by_suffix(header, name, frame), bracket) {
            (Some((wanted, Meaning::Column(column, suffix, _))), Some(text)) => match wanted.unit(text) {
                Ok(unit) if unit.convert("1") == suffix.convert("1") => Meaning::Column(column, unit, true),
                Ok(_) => Meaning::BadUnit(column, "the name and the brackets state different units".into()),
                Err(why) => Meaning::BadUnit(column, why),
            },
            (found, _) => found.map_or(Meaning::Unknown, |(_, meaning)| meaning),
        };
    };
    let wanted = wanted(key, column, frame);
    match bracket {
        Some(text) => match wanted.unit(text) {
            Ok(unit) => Meaning::Column(column, unit, true),
            Err(why) => Meaning::BadUnit(column, why),
        },
        None => match wanted.natural {
            Some(si) => Meaning::Column(column, Unit::of(si), false),
            None => Meaning::NoUnit(column),
        },
    }
}

/// `amplitude_sd_percent`: the longest known name, then a unit.
fn by_suffix(header: &str, name: &str, frame: &Frame<'_>) -> Option<(Wanted, Meaning)> {
    let rest = |key: &str| name.strip_prefix(key).and_then(|rest| rest.strip_prefix('_'));
    let found = NAMES.iter().filter(|(key, _)| rest(key).is_some());
    let (key, column) = *found.max_by_key(|(key, _)| key.len())?;
    let wanted = wanted(key, column, frame);
    // The unit as it was written, in capitals where it has them.
    let written = split(header).0.trim();
    let tail = written.get(key.len() + 1..).unwrap_or_default();
    if tail == "MN" && !header.contains(char::is_lowercase) {
        let why = "capitals do not tell milli from mega; write [mN] or [MN]".into();
        return Some((wanted, Meaning::BadUnit(column, why)));
    }
    let parts: Vec<&str> = tail.split(['_', ' ']).collect();
    let read: Vec<_> = suffix(&parts).map(|text| (wanted.unit(&text), known(&text))).collect();
    if let Some((Ok(unit), _)) = read.iter().find(|(unit, _)| unit.is_ok()) {
        return Some((wanted, Meaning::Column(column, unit.clone(), true)));
    }
    let why = read.into_iter().find_map(|(unit, known)| unit.err().filter(|_| known));
    Some((wanted, why.map_or(Meaning::Unknown, |why| Meaning::BadUnit(column, why))))
}

/// One of [`ALIASES`], also as an amplitude of it.
fn by_alias(header: &str, name: &str, bracket: Option<&str>, frame: &Frame<'_>) -> Option<Meaning> {
    let is_scattering = matches!(name.as_bytes(), [b's', b'1'..=b'9', b'1'..=b'9']);
    let name = if is_scattering { SCATTERING } else { name };
    let swings = |rest: &'_ str| ["_amplitude", "_ampl"].iter().find_map(|end| rest.strip_prefix(end).map(str::len));
    for alias in ALIASES {
        let Some(rest) = name.strip_prefix(alias.name) else { continue };
        // A small t is a time.
        if alias.name == "t" && !header.starts_with('T') {
            continue;
        }
        let rest = &rest[rest.len() - swings(rest).unwrap_or(rest.len())..];
        let possible = match alias.units {
            [] => possible("", alias.column),
            // A lag may be stated as a time.
            ["rad"] if alias.column == PHASE => &["rad", "s"],
            units => units,
        };
        let natural = frame.natural(alias.column).filter(|si| possible.contains(si));
        // What is one over a time is so many cycles or radians of it, as its name says.
        let spelt = |text: &str| match (alias.column == FREQUENCY && PER_SECOND.contains(&text), alias.bare) {
            (true, true) => "Hz".to_string(),
            (true, false) => "rad/s".to_string(),
            _ => text.to_string(),
        };
        let wanted = Wanted { possible, natural, share: false, per_drive: alias.column == AMPLITUDE };
        let negated = alias.name.ends_with("lag");
        let of = |unit: Unit, stated| {
            let unit = match (alias.column, unit.si) {
                (FREQUENCY, "s") => unit.of_periods(),
                (PHASE, "s") => unit.of_lags(),
                _ => unit.counted(negated),
            };
            Some(Meaning::Alias(alias.column, unit, stated))
        };
        let found = match (rest, bracket) {
            ("", Some(text)) => wanted.unit(&spelt(text)).ok().and_then(|unit| of(unit, true)),
            // A capital F is a force as well.
            ("", None) if alias.bare && split(header).0 != "F" => match natural {
                Some(si) => of(Unit::of(si), false),
                None => Some(Meaning::NoUnit(alias.column)),
            },
            // One letter behind another is an index more often than a unit.
            (rest, None) if alias.name.chars().count() > 1 || matches!(rest, "_hz" | "_s") || rest.len() > 2 => {
                let parts: Vec<&str> = rest.strip_prefix('_').map_or(Vec::new(), |tail| tail.split('_').collect());
                suffix(&parts).find_map(|text| wanted.unit(&text).ok()).and_then(|unit| of(unit, true))
            }
            _ => None,
        };
        if found.is_some() {
            return found;
        }
    }
    None
}

/// The column of words that a name stands for.
fn words(name: &str) -> Option<usize> {
    match name {
        "series" | "serie" => Some(SERIES),
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

/// What the unit of a column may be that has this name, or that the scenario maps to this key.
fn wanted(key: &str, column: usize, frame: &Frame<'_>) -> Wanted {
    let natural = match key {
        "force" => Some("N"),
        "torque" => Some("N m"),
        _ => frame.natural(column),
    };
    let per_drive = matches!(column, AMPLITUDE | AMPLITUDE_SD);
    Wanted { possible: possible(key, column), natural, share: column == AMPLITUDE_SD, per_drive }
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

/// The unit of a header that the scenario maps to a column: its bracket, what its name says, or nothing and thus SI. A
/// unit of another dimension is never taken for anything else.
pub(crate) fn mapped(header: &str, key: &str, column: usize, frame: &Frame<'_>) -> Result<(Unit, bool), String> {
    let (name, bracket) = split(header);
    let wanted = wanted(key, column, frame);
    if let Some(text) = bracket {
        return wanted.unit(text).map(|unit| (unit, true));
    }
    let parts: Vec<&str> = name.split(['_', ' ']).collect();
    let suffixes = (1..parts.len()).flat_map(|from| suffix(&parts[from..]));
    let mut stated = suffixes.filter(|text| known(text) || gravity(text).is_some());
    if let Some(first) = stated.next() {
        // Of a quotient and a product of the same words, the one that serves.
        let second = stated.next().filter(|second| *second == first.replace('/', " "));
        let unit = wanted.unit(&first).or_else(|why| second.and_then(|second| wanted.unit(&second).ok()).ok_or(why));
        return unit.map(|unit| (unit, true)).map_err(|why| format!("its name ends in a unit: {why}"));
    }
    let said = plain(name);
    if matches!(column, DRIVE | AMPLITUDE | AMPLITUDE_SD | MEAN)
        && let Some((word, si)) = SAYING.iter().find(|(word, _)| said.contains(word))
    {
        let unit = wanted.possible.iter().find(|possible| *possible == si).map(|si| (Unit::of(si), false));
        return unit.ok_or_else(|| format!("its name says `{word}`: {}", kind(si)));
    }
    Ok((Unit::of(wanted.natural.unwrap_or("m")), false))
}

/// The unit of a column of times; none of any other column.
pub(crate) fn time_unit(header: &str) -> Option<String> {
    let (name, bracket) = split(header);
    let name = plain(name);
    let wanted = Wanted { possible: &["s"], natural: Some("s"), share: false, per_drive: false };
    // Word and symbol, as in `Zeit t / s`.
    let name = name.strip_suffix("_t").filter(|word| ["time", "zeit"].contains(word)).unwrap_or(&name);
    if let Some(rest) = ["timestamp", "time", "zeit", "t"].iter().find_map(|key| name.strip_prefix(key)) {
        return match (rest, bracket) {
            ("", None) => Some("s".into()),
            ("", Some(text)) => wanted.unit(text).ok().map(|unit| unit.text),
            (rest, None) => wanted.unit(rest.strip_prefix('_')?).ok().map(|unit| unit.text),
            _ => None,
        };
    }
    None
}

/// What stands in place of a unit where none is known.
const ARBITRARY: [&str; 8] = ["a.u.", "au", "a. u.", "arb. u.", "arb. units", "arb", "skt", "w.e."];

/// Name and unit of `speed [mm/s]`, `speed (mm/s)`, `speed / mm/s` and `speed in mm/s`; none of `A (a.u.)`.
pub(crate) fn split(header: &str) -> (&str, Option<&str>) {
    let (name, unit) = name_and_unit(header);
    (name, unit.filter(|unit| !ARBITRARY.contains(&unit.to_lowercase().as_str())))
}

fn name_and_unit(header: &str) -> (&str, Option<&str>) {
    // The number of a run, as some programs write it behind every header.
    let is_number = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    let run = header.rsplit_once(" Run #").filter(|(_, number)| is_number(number));
    let header = run.map_or(header, |(name, _)| name).trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = header.strip_suffix(close)
            && let Some(at) = inner.rfind(open)
        {
            let name = header[..at].trim().trim_end_matches('/').trim_end();
            return (name, Some(inner[at + 1..].trim()).filter(|unit| !unit.is_empty()));
        }
    }
    // `|Z|(Ohm)-data`: what stands behind the unit says nothing more.
    if let Some((name, (unit, behind))) = header.split_once('(').and_then(|(a, b)| Some((a, b.split_once(')')?)))
        && behind.starts_with('-')
        && (known(unit) || electrical(unit).is_some())
    {
        return (name.trim(), Some(unit.trim()));
    }
    if let Some((name, unit)) = header.split_once('/') {
        let spaced = name.ends_with(char::is_whitespace) && !name.trim().is_empty();
        // Of `speed_mm/s` the unit is the speed's.
        let begun = name.rsplit_once('_').is_some_and(|(_, end)| known(end));
        let short = !name.is_empty() && !name.contains(char::is_whitespace) && !begun && known(unit);
        if spaced || short {
            return (name.trim_end(), Some(unit.trim()).filter(|unit| !unit.is_empty()));
        }
    }
    match header.rsplit_once(" in ") {
        Some((name, unit)) if known(unit) || gravity(unit).is_some() => (name.trim_end(), Some(unit.trim())),
        _ => (header, None),
    }
}

/// Lower case, words joined by underscores.
pub(crate) fn plain(name: &str) -> String {
    name.to_lowercase().replace([' ', '-', '.'], "_").trim_end_matches('_').to_string()
}

/// A name without the word for a mean, of what a mean is the same: of a displacement it is the place about which that
/// swings.
fn averaged(name: &str) -> &str {
    let of = ["amp", "ampl", "amplitude", "mag", "magnitude", "phi", "φ", "phase"];
    let rest = name.rsplit_once('_').filter(|(rest, word)| MEANS.contains(word) && of.contains(rest));
    rest.map_or(name, |(rest, _)| rest)
}

#[cfg(test)]
mod tests {
    use super::super::names::{LOAD, NUMBERS, PHASE, PHASE_SD, SPEED};
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
            ("load_mn", LOAD, 1e-3),
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
        let mapped = |header: &str, column: usize| mapped(header, MEASURED[column].key, column, &frame);
        let value =
            |header: &str, column: usize| mapped(header, column).expect("a unit").0.convert("1").expect("a number");
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
