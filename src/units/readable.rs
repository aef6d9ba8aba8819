//! Numbers as a reader wants them: SI prefixes, sensible digits, a true minus sign.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shown where there is no number.
pub const NONE: &str = "–";

/// A number with its wording.
#[derive(Debug, Clone, PartialEq, Default, JsonSchema, Serialize, Deserialize)]
pub struct Quantity {
    /// The value in SI; absent where there is none (not a number).
    pub value: Option<f64>,
    /// What the page shows, with unit.
    pub text: String,
}

/// A computed value with four significant digits, as value and wording.
pub fn computed(value: f64, unit: &str) -> Quantity {
    Quantity { value: finite(value), text: quantity(value, unit, 4) }
}

/// A value as somebody set it: up to six digits, no trailing zeros.
pub fn setting(value: f64, unit: &str) -> Quantity {
    let (scaled, unit) = scale(round(value, 6), unit);
    Quantity { value: finite(value), text: join(&trim(&plain(scaled, 6)), &unit) }
}

/// Value and unit with the given number of significant digits, e.g. `6.240 µrad` for 6.2401e-6 rad.
pub fn quantity(value: f64, unit: &str, digits: usize) -> String {
    let (scaled, unit) = scale(round(value, digits), unit);
    join(&plain(scaled, digits), &unit)
}

/// Estimate and ends of an interval with digits that suit it.
pub fn interval(values: [f64; 3], unit: &str) -> [Quantity; 3] {
    let digits = super::interval_digits(values);
    [0, 1, 2].map(|i| Quantity { value: finite(values[i]), text: quantity(values[i], unit, digits[i]) })
}

/// A share of one in percent, with the given number of significant digits.
pub fn percent(share: f64, digits: usize) -> String {
    join(&plain(round(100.0 * share, digits), digits), "%")
}

/// A wall time.
pub fn duration(seconds: f64) -> String {
    // What was kept from an earlier run.
    if (0.0..1e-3).contains(&seconds) {
        return "< 1 ms".into();
    }
    if seconds.is_finite() && seconds >= 120.0 {
        let whole = seconds.round() as u64;
        return format!("{} min {:02} s", whole / 60, whole % 60);
    }
    quantity(seconds, "s", 3)
}

/// A count with thin spaces between groups of three digits from 10 000 on.
pub fn count(number: usize) -> String {
    let digits = number.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let lead = digits.len() % 3;
    let mut text = String::with_capacity(digits.len() + digits.len());
    for (index, digit) in digits.chars().enumerate() {
        if index != 0 && index % 3 == lead {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A unit of the scenario files in print: `kg m^2` becomes `kg m²`; a pure number has none.
pub fn unit(unit: &str) -> String {
    if unit == "1" { String::new() } else { super::printed(unit) }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Rounds to significant digits, so that the choice of the prefix sees what will be printed.
fn round(value: f64, digits: usize) -> f64 {
    format!("{:.*e}", digits.saturating_sub(1), value).parse().unwrap_or(value)
}

/// The value in the best multiple of its unit, and that unit in print.
fn scale(value: f64, si: &str) -> (f64, String) {
    let magnitude = value.abs();
    let prefixes: &[(f64, &str)] = match si {
        "m/s" if (1e-7..1.0).contains(&magnitude) => return (value * 1e3, "mm/s".into()),
        "rad" | "m" | "N" | "W" | "N m" | "V" | "m/s" | "m/s^2" | "rad/s" | "rad/s^2" => {
            &[(1e-12, "p"), (1e-9, "n"), (1e-6, "µ"), (1e-3, "m"), (1.0, "")]
        }
        "s" => &[(1e-9, "n"), (1e-6, "µ"), (1e-3, "m"), (1.0, "")],
        "N/m" => &[(1.0, ""), (1e3, "k"), (1e6, "M"), (1e9, "G")],
        "Hz" => &[(1.0, ""), (1e4, "k"), (1e7, "M")],
        _ => &[],
    };
    let best = prefixes.iter().rev().find(|(factor, _)| magnitude >= factor * (1.0 - 1e-12));
    match best {
        Some((factor, prefix)) if magnitude > 0.0 => {
            let divisor = match *prefix {
                "k" => 1e3,
                "M" => 1e6,
                _ => *factor,
            };
            (value / divisor, format!("{prefix}{}", unit(si)))
        }
        _ => (value, unit(si)),
    }
}

/// Fixed notation where it is readable, otherwise a power of ten.
fn plain(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NONE.into();
    }
    let magnitude = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if (1e-3..1e5).contains(&magnitude) {
        return minus(format!("{:.*}", decimals(value, digits), value));
    }
    let scientific = format!("{:.*e}", digits.saturating_sub(1), value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    format!("{}×10{}", minus(mantissa.into()), superscript(exponent))
}

fn decimals(value: f64, digits: usize) -> usize {
    let order = value.abs().log10().floor() as i64;
    usize::try_from(digits as i64 - 1 - order).unwrap_or(0)
}

fn superscript(exponent: &str) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).and_then(|d| digits.get(d as usize)).copied().unwrap_or('⁻');
    exponent.chars().map(raised).collect()
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

/// Removes zeros after the decimal point that say nothing.
fn trim(text: &str) -> String {
    let (number, rest) = text.split_at(text.find('×').unwrap_or(text.len()));
    let number = if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number };
    format!("{number}{rest}")
}

fn join(number: &str, unit: &str) -> String {
    if unit.is_empty() || number == NONE { number.into() } else { format!("{number} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_values_have_prefix_and_digits() {
        assert_eq!(quantity(6.2401e-6, "rad", 4), "6.240 µrad");
        assert_eq!(quantity(71.194, "Hz", 4), "71.19 Hz");
        assert_eq!(quantity(0.16833e-3, "m/s", 4), "0.1683 mm/s");
        assert_eq!(quantity(999.96e-6, "rad", 4), "1.000 mrad");
        assert_eq!(quantity(-1.234, "rad", 3), "−1.23 rad");
        assert_eq!(quantity(0.0, "rad", 3), "0 rad");
        assert_eq!(quantity(f64::NAN, "rad", 3), NONE);
        assert_eq!(quantity(3.2e-11, "1", 2), "3.2×10⁻¹¹");
        assert_eq!(quantity(20_000.0, "Hz", 3), "20.0 kHz");
    }

    #[test]
    fn settings_keep_what_was_written() {
        assert_eq!(setting(2.5e-6, "m").text, "2.5 µm");
        assert_eq!(setting(0.05e-3, "m/s").text, "0.05 mm/s");
        assert_eq!(setting(0.02, "m/s").text, "20 mm/s");
        assert_eq!(setting(8.9e4, "N/m").text, "89 kN/m");
        assert_eq!(setting(990.0, "N m/rad").text, "990 N m/rad");
        assert_eq!(setting(5.0e-3, "kg m^2").text, "0.005 kg m²");
        assert_eq!(setting(0.5, "1").text, "0.5");
        assert_eq!(setting(0.03, "m").text, "30 mm");
        assert_eq!(setting(1.0e-4, "kg m^2").text, "1×10⁻⁴ kg m²");
        assert_eq!(setting(f64::INFINITY, "m").value, None);
    }

    #[test]
    fn shares_counts_and_times() {
        assert_eq!(percent(0.0321, 2), "3.2 %");
        assert_eq!(count(1234), "1234");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(duration(0.0123), "12.3 ms");
        assert_eq!(duration(125.4), "2 min 05 s");
    }
}
