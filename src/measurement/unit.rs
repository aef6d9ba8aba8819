//! Units as headers state them: in brackets or as the end of a name, in the spellings of laboratories.

use super::frame::kind;
use crate::units::{self, UnitError};

/// Symbols that are read in whatever case they are written, unless two differ in nothing else; in small letters the first of
/// them is meant: nobody writes a mega so, and nobody measures a modulus in millipascals.
const SYMBOLS: &[&str] = &[
    "m", "mm", "um", "nm", "cm", "km", "s", "ms", "min", "N", "mN", "uN", "nN", "kN", "MN", "Hz", "kHz", "rad", "mrad",
    "urad", "nrad", "deg", "V", "mV", "uV", "kV", "Pa", "kPa", "MPa", "mPa", "GPa",
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
    let digits = text.chars().all(|c| c.is_ascii_digit());
    !digits && matches!(units::parse(&format!("1 {}", spelt(text)), "m"), Ok(_) | Err(UnitError::Dimension { .. }))
}

/// What the unit of a column may be.
pub(crate) struct Wanted {
    /// SI units that a column of its name may have.
    pub possible: &'static [&'static str],
    /// The one of them that it has where nothing states it.
    pub natural: Option<&'static str>,
    /// Whether it may be a share in percent.
    pub share: bool,
}

impl Wanted {
    /// The unit that a text stands for, or why it does not serve.
    pub fn unit(&self, text: &str) -> Result<Unit, String> {
        let si = self.natural.unwrap_or(self.possible[0]);
        if let (Some(prefix), true) = (gravity(text), self.possible.contains(&"m/s^2")) {
            return Ok(Unit { text: text.into(), si: "m/s^2", relative: false, gravity: Some(prefix) });
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
                Ok(Unit { text, si, relative: true, gravity: None })
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
            return Ok(Unit { text, si, relative: false, gravity: None });
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

/// The prefix of a unit of standard gravity.
pub(crate) fn gravity(text: &str) -> Option<&'static str> {
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
        (Some(first), Some(_)) if symbol.chars().all(char::is_lowercase) => (*first).into(),
        _ => symbol,
    }
}
