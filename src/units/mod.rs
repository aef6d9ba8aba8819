//! Numbers with units: a small parser that checks dimensions, and the way back for people.
//!
//! Base dimensions are kg, m, s and V; rad is a pure number, so `990 N m` serves as a torsional stiffness.

pub mod readable;
mod written;

use std::fmt::Write as _;
use strsim::osa_distance;

pub use written::{Frequencies, format, format_interval, interval_digits, printed};

/// A number of things: `1 point`, `2 points`.
pub fn count(number: usize, word: &str) -> String {
    if number == 1 { format!("1 {word}") } else { format!("{number} {word}s") }
}

/// Exponents of kg, m, s and V.
type Dimension = [i32; 4];

/// Why a text is not the quantity that was asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// The text does not start with a number.
    #[error("`{0}` does not start with a number; write e.g. \"{1}\"")]
    NotANumber(String, String),
    /// The number is too large for a double, infinite or not a number.
    #[error("`{0}` is not a finite number")]
    NotFinite(String),
    /// A number without its unit.
    #[error("`{0}` has no unit; write e.g. \"{1}\", or a bare number without quotes, which is in {2}")]
    NoUnit(String, String, String),
    /// A unit that is not known, and the nearest one that would fit.
    #[error("unknown unit `{unit}`; did you mean `{nearest}`?")]
    Unknown {
        /// As it was written.
        unit: String,
        /// The nearest valid spelling.
        nearest: String,
    },
    /// The unit is fine but measures something else.
    #[error("`{given}` is a unit of {given_kind}, but {expected_kind} is needed here, e.g. in {expected}")]
    Dimension {
        /// Unit as it was written.
        given: String,
        /// What that measures.
        given_kind: String,
        /// A unit that would do.
        expected: String,
        /// What is asked for.
        expected_kind: String,
    },
    /// The unit cannot be taken apart.
    #[error("cannot read the unit `{0}`: {1}")]
    Malformed(String, &'static str),
}

/// A size in SI, as a factor and a power of ten, so that `2.5 um` is exactly the double nearest to 2.5e-6.
type Size = (f64, i32);

/// Symbol, size, dimension, whether it takes prefixes.
const UNITS: &[(&str, Size, Dimension, bool)] = &[
    ("m", (1.0, 0), [0, 1, 0, 0], true),
    ("g", (1.0, -3), [1, 0, 0, 0], true),
    ("s", (1.0, 0), [0, 0, 1, 0], true),
    ("N", (1.0, 0), [1, 1, -2, 0], true),
    ("J", (1.0, 0), [1, 2, -2, 0], true),
    // As torques are often written.
    ("Nm", (1.0, 0), [1, 2, -2, 0], false),
    ("W", (1.0, 0), [1, 2, -3, 0], true),
    ("Pa", (1.0, 0), [1, -1, -2, 0], true),
    ("Hz", (1.0, 0), [0, 0, -1, 0], true),
    ("V", (1.0, 0), [0, 0, 0, 1], true),
    ("rad", (1.0, 0), [0, 0, 0, 0], true),
    ("min", (60.0, 0), [0, 0, 1, 0], false),
    ("cm", (1.0, -2), [0, 1, 0, 0], false),
    ("deg", (std::f64::consts::PI / 180.0, 0), [0, 0, 0, 0], false),
    ("°", (std::f64::consts::PI / 180.0, 0), [0, 0, 0, 0], false),
    ("%", (1.0, -2), [0, 0, 0, 0], false),
    ("decades", (1.0, 0), [0, 0, 0, 0], false),
    ("decade", (1.0, 0), [0, 0, 0, 0], false),
    ("1", (1.0, 0), [0, 0, 0, 0], false),
];

/// Prefixes; both micro signs (U+00B5, U+03BC) and `u`.
const PREFIXES: &[(&str, i32)] =
    &[("f", -15), ("p", -12), ("n", -9), ("u", -6), ("µ", -6), ("μ", -6), ("m", -3), ("k", 3), ("M", 6), ("G", 9)];

/// Powers of ten below this are read, and not taken for what was meant.
const RARE: i32 = -9;

/// What a dimension measures, for messages; several names where several quantities share it.
const KINDS: &[(Dimension, &str)] = &[
    ([0, 0, 0, 0], "a pure number or an angle"),
    ([0, 1, 0, 0], "a length"),
    ([0, 0, 1, 0], "a time"),
    ([1, 0, 0, 0], "a mass"),
    ([0, 0, -1, 0], "a frequency"),
    ([0, 1, -1, 0], "a speed"),
    ([0, 1, -2, 0], "an acceleration"),
    ([1, 1, -2, 0], "a force"),
    ([1, 0, -2, 0], "a stiffness"),
    ([1, 0, -1, 0], "a damping"),
    ([1, 2, -2, 0], "a torque, a torsional stiffness or an energy"),
    ([1, 2, -1, 0], "a torsional damping"),
    ([1, 2, 0, 0], "a moment of inertia"),
    ([1, 2, -3, 0], "a power"),
    ([1, -1, -2, 0], "a pressure"),
    ([0, 0, 0, 1], "a voltage"),
];

/// Reads `"20 mm/s"` as a value in SI; `si_unit` states the dimension that is needed, in units without prefix (`m/s`,
/// `kg`).
pub fn parse(text: &str, si_unit: &str) -> Result<f64, UnitError> {
    let text = text.trim();
    let example = format!("1 {}", if si_unit == "1" { "%" } else { si_unit });
    let (number, unit) = split_number(text);
    let number = number.replace('−', "-");
    let bare: f64 = number.parse().map_err(|_| UnitError::NotANumber(shorten(text), example.clone()))?;
    let (_, expected) = parse_unit(si_unit, si_unit)?;
    let ((factor, power), dimension) = match unit {
        "" if si_unit == "1" => ((1.0, 0), expected),
        "" => return Err(UnitError::NoUnit(shorten(text), format!("{number} {si_unit}"), si_unit.into())),
        unit => parse_unit(unit, si_unit)?,
    };
    if dimension != expected {
        return Err(UnitError::Dimension {
            given: shorten(unit),
            given_kind: kind(dimension),
            expected: si_unit.into(),
            expected_kind: kind(expected),
        });
    }
    let mut value = shift(&number, power).unwrap_or(bare * f64::powi(10.0, power)) * factor;
    // Radians and cycles have no dimension: which of them a second is meant has to be said.
    if si_unit == "Hz" && !unit.contains("Hz") {
        if !["rad", "deg", "°"].iter().any(|angle| unit.contains(angle)) {
            return Err(UnitError::Malformed(shorten(unit), "cycles or radians a second? write Hz or rad/s"));
        }
        value /= std::f64::consts::TAU;
    }
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite(shorten(text))) }
}

/// The unit in SI of a quantity, whatever it is: `N/m^5` for `"3 kN/m^5"`, `1` for a number without unit.
pub fn si_unit(text: &str) -> Result<String, UnitError> {
    let (_, unit) = split_number(text.trim());
    if unit.is_empty() {
        return Ok("1".into());
    }
    let (_, [mass, length, time, voltage]) = parse_unit(unit, "1")?;
    // One kilogram is part of a force.
    let powers = match mass {
        1 => [("N", 1), ("m", length - 1), ("s", time + 2), ("V", voltage)],
        _ => [("kg", mass), ("m", length), ("s", time), ("V", voltage)],
    };
    let side = |sign: i32| -> Vec<String> {
        let of = |&(symbol, power): &(&str, i32)| match power * sign {
            1 => Some(symbol.to_string()),
            power if power > 1 => Some(format!("{symbol}^{power}")),
            _ => None,
        };
        powers.iter().filter_map(of).collect()
    };
    let (above, below) = (side(1), side(-1));
    let above = if above.is_empty() { "1".into() } else { above.join(" ") };
    Ok(match below.as_slice() {
        [] => above,
        [one] => format!("{above}/{one}"),
        many => format!("{above}/({})", many.join(" ")),
    })
}

/// The number times a power of ten, rounded once.
fn shift(number: &str, power: i32) -> Option<f64> {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let exponent: i32 = exponent.parse().ok()?;
    format!("{mantissa}e{}", exponent.checked_add(power)?).parse().ok()
}

/// Splits `20 mm/s` where the number ends; an `e` belongs to the number only where digits follow it.
pub fn split_number(text: &str) -> (&str, &str) {
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let sign = |c: Option<char>| matches!(c, Some('+' | '-' | '−'));
    let mut chars = text.char_indices().peekable();
    let mut end = 0;
    while let Some((at, c)) = chars.next() {
        let mut rest = text[at + c.len_utf8()..].chars();
        let next = rest.next();
        let part = c.is_ascii_digit()
            || c == '.'
            || (at == 0 && sign(Some(c)))
            || (matches!(c, 'e' | 'E') && end > 0 && (digit(next) || sign(next) && digit(rest.next())));
        if !part {
            break;
        }
        end = at + c.len_utf8();
        if matches!(c, 'e' | 'E') && sign(next) {
            end += chars.next().map_or(0, |(_, c)| c.len_utf8());
        }
    }
    (&text[..end], text[end..].trim())
}

/// Size and dimension of `kg m^2`, `N m s/rad`, `J/(kg s)`; at most one solidus.
fn parse_unit(unit: &str, si_unit: &str) -> Result<(Size, Dimension), UnitError> {
    let malformed = |why| UnitError::Malformed(shorten(unit), why);
    let (above, below) = match unit.split_once('/') {
        Some((_, below)) if below.contains('/') => {
            return Err(malformed("more than one `/`; write a power instead, e.g. m/s^2"));
        }
        Some((above, below)) => (above.trim(), Some(below.trim())),
        None => (unit.trim(), None),
    };
    let mut size: Size = (1.0, 0);
    let mut dimension = [0; 4];
    let mut multiply = |factor: &str, side: i32| -> Result<(), UnitError> {
        let (symbol, power) = split_power(factor).ok_or_else(|| malformed("a power is a whole number up to 9"))?;
        let (one, of) = lookup(symbol)
            .ok_or_else(|| UnitError::Unknown { unit: shorten(symbol), nearest: nearest_unit(symbol, si_unit) })?;
        size = (size.0 * f64::powi(one.0, power * side), size.1 + one.1 * power * side);
        for (sum, exponent) in dimension.iter_mut().zip(of) {
            *sum += exponent * power * side;
        }
        Ok(())
    };
    let factors = |side: &str| -> Vec<String> {
        side.split(|c: char| c.is_whitespace() || matches!(c, '*' | '·' | '⋅'))
            .filter(|factor| !factor.is_empty())
            .map(String::from)
            .collect()
    };
    let numerator = factors(above);
    if numerator.is_empty() || numerator.len() > 16 {
        return Err(malformed("write factors separated by spaces, e.g. N m s/rad"));
    }
    for factor in &numerator {
        multiply(factor, 1)?;
    }
    if let Some(below) = below {
        let group = below.strip_prefix('(').and_then(|inner| inner.strip_suffix(')'));
        let denominator = factors(group.unwrap_or(below));
        if denominator.is_empty() || denominator.len() > 16 {
            return Err(malformed("nothing follows the `/`"));
        }
        if denominator.len() > 1 && group.is_none() {
            return Err(malformed("only one factor may follow `/`; put it last, e.g. N s/m, or use parentheses"));
        }
        for factor in &denominator {
            multiply(factor, -1)?;
        }
    }
    Ok((size, dimension))
}

/// `m^2` and `m²` as (`m`, 2).
fn split_power(factor: &str) -> Option<(&str, i32)> {
    const RAISED: &[(&str, i32)] = &[("⁻¹", -1), ("⁻²", -2), ("²", 2), ("³", 3)];
    for (ending, power) in RAISED {
        if let Some(symbol) = factor.strip_suffix(ending) {
            return Some((symbol, *power));
        }
    }
    match factor.split_once('^') {
        Some((symbol, power)) => power.parse().ok().filter(|p: &i32| p.abs() <= 9).map(|p| (symbol, p)),
        None => Some((factor, 1)),
    }
}

/// Size and dimension of one symbol, prefix included.
fn lookup(symbol: &str) -> Option<(Size, Dimension)> {
    if let Some((_, size, dimension, _)) = UNITS.iter().find(|unit| unit.0 == symbol) {
        return Some((*size, *dimension));
    }
    PREFIXES.iter().find_map(|(prefix, power)| {
        let rest = symbol.strip_prefix(prefix)?;
        let unit = UNITS.iter().find(|unit| unit.3 && unit.0 == rest)?;
        Some(((unit.1.0, unit.1.1 + power), unit.2))
    })
}

/// The valid spelling nearest to `symbol`, preferring the symbols that occur in the unit that is needed.
fn nearest_unit(symbol: &str, si_unit: &str) -> String {
    // A power without its sign.
    let base = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
    if base.len() < symbol.len() && lookup(base).is_some() {
        return format!("{base}^{}", &symbol[base.len()..]);
    }
    let mut known = Vec::new();
    for (unit, _, _, prefixed) in UNITS {
        known.push((*unit).to_string());
        if *prefixed {
            known.extend(
                PREFIXES.iter().filter(|p| p.0.is_ascii() && p.1 >= RARE).map(|(prefix, _)| format!("{prefix}{unit}")),
            );
        }
    }
    let parts: Vec<&str> = si_unit.split([' ', '/', '^']).filter(|part| !part.is_empty()).collect();
    let fits = |unit: &str| {
        let of = |symbol: &str| lookup(symbol).map(|(_, dimension)| dimension);
        parts.iter().any(|part| of(part) == of(unit))
    };
    let symbol: String = symbol.chars().take(12).collect();
    let rank = |unit: &String| {
        let distance = osa_distance(&symbol.to_lowercase(), &unit.to_lowercase());
        let start = unit.chars().next() == symbol.chars().next();
        let length = unit.chars().count().abs_diff(symbol.chars().count());
        (distance + usize::from(!fits(unit)), !fits(unit), !unit.eq_ignore_ascii_case(&symbol), !start, length)
    };
    known.into_iter().min_by_key(rank).unwrap_or_default()
}

/// What the dimension measures, in words where there are some.
fn kind(dimension: Dimension) -> String {
    if let Some((_, name)) = KINDS.iter().find(|(known, _)| *known == dimension) {
        return (*name).into();
    }
    let mut text = String::from("a quantity in");
    for (symbol, power) in ["kg", "m", "s", "V"].iter().zip(dimension) {
        match power {
            0 => {}
            1 => drop(write!(text, " {symbol}")),
            _ => drop(write!(text, " {symbol}^{power}")),
        }
    }
    text
}

/// At most 60 characters of a text, for messages.
fn shorten(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(text: &str, si_unit: &str, expected: f64) {
        let value = parse(text, si_unit).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!((value - expected).abs() <= 1e-14 * expected.abs(), "{text}: {value} is not {expected}");
    }

    #[test]
    fn the_unit_in_si_is_that_of_the_same_quantity() {
        for (text, unit) in [
            ("3 kN/m^5", "N/m^5"),
            ("0 N s^2/m^2", "N s^2/m^2"),
            ("2 um", "m"),
            ("1 m/s", "m/s"),
            ("5 %", "1"),
            ("4", "1"),
            ("1 1/s", "1/s"),
            ("3 V s/m", "s V/m"),
        ] {
            let found = si_unit(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            let one = format!("1 {found}");
            assert_eq!(parse(&one, &found), Ok(1.0), "{text}");
            assert_eq!(found, unit);
            assert!(text.trim().parse::<f64>().is_ok() || parse(text, &found).is_ok(), "{text} in {found}");
        }
        assert!(si_unit("3 furlongs").is_err());
    }

    #[test]
    fn intervals_have_the_digits_that_they_resolve() {
        let shown = |values, unit| format_interval(values, unit).join(" ");
        assert_eq!(shown([79209.6, 78959.4, 79460.5], "N/m"), "79210 N/m 78960 N/m 79460 N/m");
        assert_eq!(shown([0.999_712, 0.9981, 1.0013], "1"), "0.9997 0.9981 1.0013");
        assert_eq!(shown([2.27904e-3, 1.92521e-3, 2.71552e-3], "s"), "2.28 ms 1.93 ms 2.72 ms");
        assert_eq!(
            shown([0.960_470_155, 0.960_469_903, 0.960_470_402], "Hz"),
            "960.47015 mHz 960.4699 mHz 960.4704 mHz"
        );
        assert_eq!(shown([-5.2, -9.1, -1.3], "N"), "-5.2 N -9.1 N -1.3 N");
        // As wide as the value, one end at infinity, no width.
        assert_eq!(shown([1.0, 1e-9, 12345.6], "N"), "1 N 1 nN 12.3 kN");
        assert_eq!(shown([1.0, 0.123_456, f64::INFINITY], "1"), "1 0.123 inf");
        assert_eq!(shown([2.345_67; 3], "1"), "2.35 2.35 2.35");
    }

    #[test]
    fn frequencies_have_the_digits_of_their_spacing() {
        let of = |from: f64, step: f64| Frequencies::of((0..50).map(move |i| from + step * f64::from(i)));
        assert_eq!(of(52.0, 2.0).show(71.0 + 1e-9), "71 Hz");
        assert_eq!((of(52.0, 2.0).show(71.234), of(52.0, 2.0).difference(1.26)), ("71.23 Hz".into(), "1.3 Hz".into()));
        assert_eq!(of(0.5, 0.002).show(0.512_34), "0.51234 Hz");
        assert_eq!(of(53.9, 0.055).show(54.061_234), "54.061 Hz");
        assert_eq!(of(1e6, 100.0).show(1_000_300.0), "1000.3 kHz");
        assert_eq!(of(1e6, 100.0).difference(140.0), "0.14 kHz");
        assert_eq!(Frequencies::of([]).show(3.0), "3 Hz");
        assert_eq!(Frequencies::of([72.0]).show(72.0), "72 Hz");
    }

    #[test]
    fn every_form_of_the_interface_is_read() {
        close("20 mm/s", "m/s", 0.02);
        for micro in ["2.5 um", "2.5 µm", "2.5 μm", "2.5um", " +2.5e0  um ", "0.0025 mm", "2500 nm"] {
            close(micro, "m", 2.5e-6);
        }
        close("990 N m/rad", "N m/rad", 990.0);
        close("990 N m", "N m/rad", 990.0);
        close("990 N*m", "N m/rad", 990.0);
        close("990 N·m/rad", "N m/rad", 990.0);
        close("60 mm", "m", 0.06);
        close("6 cm", "m", 0.06);
        close("5.0e-3 kg m^2", "kg m^2", 5e-3);
        close("5 g m²", "kg m^2", 5e-3);
        close("0.43 N m s/rad", "N m s/rad", 0.43);
        close("12 N s/m", "N s/m", 12.0);
        close("1.6e4 N/m", "N/m", 1.6e4);
        close("16 kN/m", "N/m", 1.6e4);
        close("16 N/mm", "N/m", 1.6e4);
        close("16 N mm^-1", "N/m", 1.6e4);
        assert_eq!(parse("2.5 um", "m"), Ok(2.5e-6), "rounded once");
        assert_eq!(parse("1.7e-1 mm/s", "m/s"), Ok(1.7e-4), "rounded once");
        close("72 Hz", "Hz", 72.0);
        close("100 rad/s", "Hz", 50.0 / std::f64::consts::PI);
        close("0.3 ms", "s", 3e-4);
        close("5 %", "1", 0.05);
        close("0.5", "1", 0.5);
        close("10 deg", "rad", 10f64.to_radians());
        close("−10°", "rad", -10f64.to_radians());
        close("1e5 N m/rad^3", "N m/rad^3", 1e5);
        close("3 N m s^2/rad^2", "N m s^2/rad^2", 3.0);
        close("3 kg m^2", "N m s^2/rad^2", 3.0);
        close("1.2 kN", "N", 1200.0);
        close("100 W", "W", 100.0);
        close("1.5 decades", "decades", 1.5);
        close("2 kg/(m s^2)", "Pa", 2.0);
    }

    #[test]
    fn messages_say_what_was_expected() {
        let say = |text, unit| parse(text, unit).unwrap_err().to_string();
        assert_eq!(say("20 mm", "m/s"), "`mm` is a unit of a length, but a speed is needed here, e.g. in m/s");
        assert_eq!(say("20 mms", "m"), "unknown unit `mms`; did you mean `mm`?");
        assert_eq!(say("30 mn", "m"), "unknown unit `mn`; did you mean `mm`?");
        assert_eq!(say("5 kg m2", "kg m^2"), "unknown unit `m2`; did you mean `m^2`?");
        assert_eq!(say("30 sec", "s"), "unknown unit `sec`; did you mean `s`?");
        assert_eq!(say("50 hz", "Hz"), "unknown unit `hz`; did you mean `Hz`?");
        assert_eq!(say("72 1/s", "Hz"), "cannot read the unit `1/s`: cycles or radians a second? write Hz or rad/s");
        assert_eq!(say("20 n", "N"), "unknown unit `n`; did you mean `N`?");
        assert_eq!(
            say("20", "N"),
            "`20` has no unit; write e.g. \"20 N\", or a bare number without quotes, which is in N"
        );
        assert_eq!(say("fast", "m/s"), "`fast` does not start with a number; write e.g. \"1 m/s\"");
        assert_eq!(say("1e999 N", "N"), "`1e999 N` is not a finite number");
        assert!(say("1 N/m s", "N s/m").contains("only one factor"));
        assert!(say("1 m/s/s", "m/s^2").contains("more than one"));
    }

    #[test]
    fn values_are_written_for_people() {
        assert_eq!(format(2.5e-6, "m"), "2.5 µm");
        assert_eq!(format(1e-4, "m/s"), "0.1 mm/s");
        assert_eq!(format(1e-6, "m/s"), "0.001 mm/s");
        assert_eq!(format(0.02, "m/s"), "20 mm/s");
        assert_eq!(format(20.0, "N"), "20 N");
        assert_eq!(format(0.06, "m"), "60 mm");
        assert_eq!(format(8.9e4, "N/m"), "89000 N/m");
        assert_eq!(format(71.194, "Hz"), "71.194 Hz");
        assert_eq!(format(0.0, "m/s"), "0 m/s");
        assert_eq!(format(-0.0, "N"), "0 N");
        assert_eq!(format(0.5, "1"), "0.5");
        assert_eq!(format(5e-3, "kg m^2"), "0.005 kg m^2");
        assert_eq!(format(1e9, "N m/rad^3"), "1e9 N m/rad^3");
        assert_eq!(format(1500.0, "m/s^2"), "1500 m/s^2");
        assert_eq!(format(0.0015, "m/s^2"), "1.5 mm/s^2");
        assert_eq!(printed("N s^2/m^2"), "N s²/m²");
    }

    #[test]
    fn written_values_are_read_again() {
        for unit in ["m", "m/s", "N", "Hz", "s", "rad", "N m/rad", "1", "kg m^2", "decades", "W"] {
            for exponent in -14..14 {
                let value = -1.23457 * 10f64.powi(exponent);
                let text = format(value, unit);
                let again = parse(&text, unit).unwrap_or_else(|error| panic!("{text}: {error}"));
                assert!((again / value - 1.0).abs() < 1e-5, "{text}");
            }
        }
    }

    #[test]
    fn garbage_is_an_error_and_never_a_panic() {
        for text in ["", " ", "-", ".", "e", "1e", "1e+", "1.2.3 m", "1 /", "1 m/", "1 m/()", "1 m^", "1 ^2", "1 m^99"]
        {
            assert!(parse(text, "m").is_err(), "{text:?}");
        }
        for text in ["1 ²", "1 µ", "°", "1 m^-", "1 (m", "--1 m", "−−1 m", "nan m", "inf m", "1e400 m", "\u{0}", "½ m"]
        {
            assert!(parse(text, "m").is_err(), "{text:?}");
        }
        assert!(parse(&"9".repeat(100_000), "m").is_err());
        assert!(parse(&format!("1 {}", "m ".repeat(100_000)), "m").is_err());
    }
}
