//! Units as headers state them: in brackets or as the end of a name, in the spellings of laboratories.

use super::frame::{DRIVES, kind};
use super::names::POWER;
use super::swings::Swing;
use crate::units::{self, UnitError};

/// Symbols that are read in whatever case they are written, unless two differ in nothing else; in small letters the
/// first of them is meant: nobody writes a mega so, and nobody measures a modulus in millipascals.
const SYMBOLS: &[&str] = &[
    "m", "mm", "um", "nm", "cm", "km", "s", "ms", "min", "N", "mN", "uN", "nN", "kN", "MN", "Hz", "kHz", "rad", "mrad",
    "urad", "nrad", "deg", "V", "mV", "uV", "kV", "Pa", "kPa", "MPa", "mPa", "GPa",
];

/// Standard gravity \[m/s^2\].
const GRAVITY: f64 = 9.806_65;

/// Amplitude of a voltage that takes a milliwatt at the 50 ohms that levels of powers are stated for \[V\].
const MILLIWATT: f64 = 0.316_227_766_016_837_94;

/// The unit of a column's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    /// As it is shown and handed to [`units::parse`].
    pub text: String,
    /// What its numbers become.
    pub si: &'static str,
    /// A share of the amplitude.
    pub relative: bool,
    /// What its numbers are per, of a frequency response function.
    pub over: Option<Over>,
    /// Whether its numbers count the other way round, as a lag does.
    pub negated: bool,
    /// What of a swing its numbers are.
    pub swing: Swing,
    /// Whether its numbers are one over what is wanted: periods where a frequency is.
    reciprocal: bool,
    /// Whether its numbers are times by which a reading lags behind the drive, where an angle is wanted.
    lag: bool,
    /// What a unit that [`units`] does not have is in one that it has, and how many of these it is.
    foreign: Option<(String, f64)>,
    /// Whether its numbers are levels, 20 log10 of the size.
    decibel: bool,
}

/// The unit of the drive that the numbers of a frequency response function are per.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Over {
    /// What it is in SI; none of a level whose reference is not stated, a ratio of whatever was read and driven.
    pub si: Option<&'static str>,
    /// Its size in SI.
    size: f64,
    text: String,
}

impl Unit {
    /// A unit in SI.
    pub fn of(si: &'static str) -> Self {
        Self {
            text: si.into(),
            si,
            relative: false,
            over: None,
            negated: false,
            swing: Swing::Amplitude,
            reciprocal: false,
            lag: false,
            foreign: None,
            decibel: false,
        }
    }

    /// A level of a ratio whose reference is not stated.
    pub fn level() -> Self {
        Self { over: Some(Over { si: None, size: 1.0, text: String::new() }), decibel: true, ..Self::of("V") }
    }

    /// A level of a power, which goes with the square of an amplitude: as that of a voltage at a load.
    fn power() -> Self {
        Self { text: "dBm".into(), foreign: Some(("V".into(), MILLIWATT)), decibel: true, ..Self::of("V") }
    }

    /// The same, its numbers counted the other way round if so.
    pub fn counted(self, negated: bool) -> Self {
        Self { negated, ..self }
    }

    /// The same, its numbers of that measure of a swing.
    pub fn swinging(self, swing: Swing) -> Self {
        Self { swing, ..self }
    }

    /// A frequency whose numbers are periods in this unit of time.
    pub fn of_periods(self) -> Self {
        Self { si: "Hz", reciprocal: true, ..self }
    }

    /// An angle whose numbers are times in this unit, by which a reading lags behind the drive.
    pub fn of_lags(self) -> Self {
        Self { si: "rad", lag: true, negated: true, ..self }
    }

    /// Whether its numbers are times, which a frequency makes angles of.
    pub fn is_of_lags(&self) -> bool {
        self.lag
    }

    /// Whether its numbers are periods.
    pub fn is_of_periods(&self) -> bool {
        self.reciprocal
    }

    /// The same quantity in another unit.
    pub fn spelt(self, text: &str) -> Self {
        Self { text: text.into(), ..self }
    }

    /// A number of this unit in SI, rounded once.
    pub fn convert(&self, number: &str) -> Result<f64, UnitError> {
        let level = |number: &str| number.parse().map(|level: f64| 10f64.powf(level / 20.0).to_string());
        let size = if self.decibel { level(number).unwrap_or_default() } else { number.to_string() };
        let value = match &self.foreign {
            Some((known, number)) => number * units::parse(&format!("{size} {known}"), self.si)?,
            None if self.lag => units::parse(&format!("{size} {}", self.text), "s")?,
            None if self.reciprocal => 1.0 / units::parse(&format!("{size} {}", self.text), "s")?,
            None => units::parse(&format!("{size} {}", self.text), if self.relative { "1" } else { self.si })?,
        };
        let value = self.over.as_ref().map_or(value, |over| value / over.size);
        let value = self.swing.factor() * value;
        Ok(if self.negated { -value } else { value })
    }

    /// Whether its numbers are levels in decibels.
    pub fn is_level(&self) -> bool {
        self.decibel
    }

    /// Whether its numbers are voltages, of none other of the electrical signals that stand for one.
    pub fn is_voltage(&self) -> bool {
        self.si == "V" && self.foreign.is_none() && !self.decibel && self.over.is_none()
    }

    /// Whether it is that of a current.
    pub fn is_current(&self) -> bool {
        self.foreign.is_some() && self.text.ends_with('A')
    }

    /// As it is told.
    pub fn shown(&self) -> String {
        if self.reciprocal {
            return format!("one over {}", self.text);
        }
        let over = self.over.as_ref().filter(|over| over.si.is_some());
        let ratio = over.map_or_else(|| self.text.clone(), |over| format!("{} per {}", self.text, over.text));
        match (self.decibel, &self.over) {
            (true, None) if self.foreign.is_some() => "dBm, a voltage at 50 ohms".into(),
            (true, Some(Over { si: None, .. })) => "dB".into(),
            (true, _) => format!("dB re 1 {ratio}"),
            (false, _) => ratio,
        }
    }
}

/// `mm`, `mm_s` and `mm_per_s` as units, `n_m` as a quotient and as a product; anything longer is none.
pub(crate) fn suffix(parts: &[&str]) -> impl Iterator<Item = String> {
    let list = match parts {
        [one] if !one.is_empty() => vec![(*one).to_string()],
        [above, "per", below] => vec![format!("{above}/{below}")],
        [above, below] => vec![format!("{above}/{below}"), format!("{above} {below}")],
        _ => Vec::new(),
    };
    list.into_iter()
}

/// Whether the text is a unit of anything.
pub(crate) fn known(text: &str) -> bool {
    let of_side = |side: &str| known(side) || gravity(side).is_some();
    if let Some(of) = level(text) {
        return of.is_empty() || of_side(of);
    }
    if let Some((above, below)) = quotient(text) {
        return of_side(above) && of_side(below);
    }
    let digits = text.chars().all(|c| c.is_ascii_digit());
    !digits && matches!(units::parse(&format!("1 {}", spelt(text)), "m"), Ok(_) | Err(UnitError::Dimension { .. }))
}

/// Whether the text is a unit of anything, gravity, shares and what an instrument tells of a voltage among them.
pub(super) fn is_unit(text: &str) -> bool {
    let plain = Swing::marked(text).0;
    text == "%" || known(plain) || gravity(plain).is_some() || electrical(plain).is_some()
}

/// The units that a row below the header states: nothing else stands in it.
pub(super) fn units_of(row: &[String], width: usize) -> Option<Vec<String>> {
    let inside =
        |cell: &str| cell.strip_prefix(['[', '(']).and_then(|cell| cell.strip_suffix([']', ')'])).map(String::from);
    let bare = |cell: &String| inside(cell.trim()).map_or(cell.trim().into(), |inner| inner.trim().to_string());
    let cells: Vec<String> = row.iter().map(bare).map(|cell| if cell == "-" { String::new() } else { cell }).collect();
    let unit = |cell: &String| cell.is_empty() || cell == "%" || known(cell) || gravity(cell).is_some();
    let stated = cells.iter().filter(|cell| !cell.is_empty()).count();
    (stated > 1 && cells.len() == width && cells.iter().all(unit)).then_some(cells)
}

/// What the unit of a column may be.
pub(crate) struct Wanted {
    /// SI units that a column of its name may have.
    pub possible: &'static [&'static str],
    /// The one of them that it has where nothing states it.
    pub natural: Option<&'static str>,
    /// Whether it may be a share in percent.
    pub share: bool,
    /// Whether it may be per drive, or a level.
    pub per_drive: bool,
}

impl Wanted {
    /// The unit that a text stands for, or why it does not serve.
    pub fn unit(&self, text: &str) -> Result<Unit, String> {
        let is_power = self.possible == POWER && text.eq_ignore_ascii_case("db");
        if is_power || text.eq_ignore_ascii_case("dbm") && (self.possible == POWER || self.possible.contains(&"V")) {
            return Ok(Unit::power());
        }
        if !self.per_drive {
            return self.plain(text);
        }
        match level(text) {
            Some("") if self.possible.contains(&"V") => Ok(Unit::level()),
            Some("") => Err("a level needs what it refers to, such as dB re 1 m".into()),
            Some(of) => Ok(Unit { decibel: true, ..self.ratio(of)? }),
            None => self.ratio(text),
        }
    }

    /// A unit, or one per drive.
    fn ratio(&self, text: &str) -> Result<Unit, String> {
        let Some((above, below)) = quotient(text) else { return self.plain(text) };
        let of_drive = Self { possible: DRIVES, natural: None, share: false, per_drive: false };
        let Ok(drive) = of_drive.plain(below) else { return self.plain(text) };
        let size = drive.convert("1").map_err(|error| error.to_string())?;
        Ok(Unit { over: Some(Over { si: Some(drive.si), size, text: drive.text }), ..self.plain(above)? })
    }

    /// A unit, of drives and readings with what it says of the swing.
    fn plain(&self, text: &str) -> Result<Unit, String> {
        if !self.possible.contains(&"V") {
            return self.sized(text);
        }
        let (unit, swing) = Swing::marked(text);
        Ok(self.sized(unit)?.swinging(swing))
    }

    fn sized(&self, text: &str) -> Result<Unit, String> {
        let si = self.natural.unwrap_or(self.possible[0]);
        if let (Some(prefix), true) = (gravity(text), self.possible.contains(&"m/s^2")) {
            return Ok(Unit {
                text: text.into(),
                foreign: Some((format!("{prefix}m/s^2"), GRAVITY)),
                ..Unit::of("m/s^2")
            });
        }
        if let (Some(prefix), true) = (electrical(text), self.possible.contains(&"V")) {
            return Ok(Unit { text: text.into(), foreign: Some((format!("{prefix}V"), 1.0)), ..Unit::of("V") });
        }
        let mut text = spelt(text);
        if self.possible.contains(&"N m") && !self.possible.contains(&"m") {
            // A torque in small letters.
            text = match text.as_str() {
                "nm" => "N m".into(),
                "mnm" => "mN m".into(),
                _ => text,
            };
        }
        if text == "%" {
            return if self.share {
                Ok(Unit { text, relative: true, ..Unit::of(si) })
            } else {
                Err(format!("a share in % serves only for the amplitude's standard deviation, {si} is needed here"))
            };
        }
        // Angles have no dimension: they need to be named.
        let angle = ["rad", "deg", "°"].iter().any(|unit| text.contains(unit));
        let fits = |si: &str| {
            let named = si == "Hz" || angle == si.contains("rad");
            named && units::parse(&format!("1 {text}"), si).is_ok()
        };
        if let Some(si) = self.possible.iter().find(|si| fits(si)) {
            return Ok(Unit { text, ..Unit::of(si) });
        }
        Err(match units::parse(&format!("1 {text}"), si) {
            Err(UnitError::Dimension { given, given_kind, .. }) if self.possible.len() > 1 => {
                format!("`{given}` is a unit of {given_kind}, which this column cannot hold")
            }
            Err(error) => error.to_string(),
            Ok(_) if si == "rad" => format!("`{text}` is no unit of an angle; use rad, mrad, urad or deg"),
            Ok(_) => format!("`{text}` is no unit of {}", kind(si)),
        })
    }
}

/// What a level in decibels refers to; nothing where that is not stated.
fn level(text: &str) -> Option<&str> {
    let rest = text.get(..2).filter(|start| start.eq_ignore_ascii_case("db")).map(|_| text[2..].trim_start())?;
    let words = ["rel.", "rel", "ref.", "ref", "re.", "re", ":"];
    let rest = words.iter().find_map(|word| rest.strip_prefix(word)).unwrap_or(rest).trim_start();
    let rest = rest.strip_prefix("1 ").unwrap_or(rest).trim();
    Some(rest.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')).unwrap_or(rest))
}

/// Both sides of a quotient of units, of `m/s^2/N` those of the last stroke; none of a speed or the like, which is one
/// unit.
fn quotient(text: &str) -> Option<(&str, &str)> {
    let bare = |side: &'_ str| -> std::ops::Range<usize> {
        let inner = side.trim();
        let inner = inner.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')).unwrap_or(inner);
        let start = inner.as_ptr() as usize - side.as_ptr() as usize;
        start..start + inner.len()
    };
    let (above, below) = text.rsplit_once('/')?;
    let (above, below) = (&above[bare(above)], &below[bare(below)]);
    (!above.is_empty() && !below.is_empty() && !below.starts_with('s')).then_some((above, below))
}

/// The prefix of a unit of standard gravity.
pub(crate) fn gravity(text: &str) -> Option<&'static str> {
    match text {
        "g" | "G" | "gn" | "g_n" | "g0" => Some(""),
        "mg" => Some("m"),
        "ug" | "µg" | "μg" => Some("u"),
        _ => None,
    }
}

/// The prefix of an electrical unit that is neither of a motion nor of a force, and of a signal that goes with one as a
/// voltage does: a current, an impedance, an admittance.
pub(crate) fn electrical(text: &str) -> Option<&'static str> {
    const UNITS: [&str; 8] = ["A", "S", "Ohm", "ohm", "Ohms", "ohms", "Ω", "\u{2126}"];
    let prefix = UNITS.iter().find_map(|unit| text.strip_suffix(unit))?;
    ["", "p", "n", "u", "m", "k", "M", "G"].into_iter().find(|known| *known == prefix.trim().replace(['µ', 'μ'], "u"))
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

/// The symbol of a unit that is written out, as `kilohertz` or `Volts`.
fn written_out(word: &str) -> Option<String> {
    const UNITS: [(&str, &str); 7] = [
        ("hertz", "Hz"),
        ("volt", "V"),
        ("newton", "N"),
        ("meter", "m"),
        ("metre", "m"),
        ("metro", "m"),
        ("radian", "rad"),
    ];
    const PREFIXES: [(&str, &str); 9] = [
        ("", ""),
        ("nano", "n"),
        ("micro", "u"),
        ("mikro", "u"),
        ("milli", "m"),
        ("mili", "m"),
        ("kilo", "k"),
        ("mega", "M"),
        ("giga", "G"),
    ];
    let word = word.strip_suffix('s').unwrap_or(word);
    let (unit, symbol) = UNITS.iter().find(|(unit, _)| word.ends_with(unit))?;
    let (_, prefix) = PREFIXES.iter().find(|(prefix, _)| word.strip_suffix(unit) == Some(prefix))?;
    Some(format!("{prefix}{symbol}"))
}

fn canonical(symbol: &str) -> String {
    match symbol.to_lowercase().as_str() {
        "percent" | "pct" => return "%".into(),
        "degree" | "degrees" | "grad" | "gradi" | "grados" | "graus" | "º" => return "deg".into(),
        "sec" => return "s".into(),
        word => {
            if let Some(symbol) = written_out(word) {
                return symbol;
            }
        }
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
        (Some(first), Some(_)) if symbol.chars().all(char::is_lowercase) => (*first).into(),
        _ => symbol,
    }
}
