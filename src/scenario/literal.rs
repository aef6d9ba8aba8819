//! Numbers as a scenario file writes them: rounded to what is known, in the style and the unit that stood there.

use crate::units;

/// Digits of half a 95 % interval that are written.
const OF_INTERVAL: i32 = 2;
/// Digits where the data give no interval.
const OTHERWISE: i32 = 4;
/// A number is never written with fewer digits, nor with more.
const FEWEST: i32 = 2;
const MOST: i32 = 12;

/// A fitted number and how well it is known; SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Key as in `[fit] free`.
    pub key: String,
    /// The value.
    pub value: f64,
    /// SI unit.
    pub unit: &'static str,
    /// Lower end of the 95 % interval, where the data give one; that and the upper end are the value where it was held.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval, where the data give one.
    pub high: Option<f64>,
    /// A unit of the last digit that shows in the predictions, given the values of the other parameters: where
    /// estimates are tied together, it is smaller than their intervals. Infinite where nothing shows.
    pub detectable_change: f64,
    /// Whether the data contradict the model that it was fitted with.
    pub contradicted: bool,
}

/// A number on paper: what goes into the file, and what the comment beside it says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Written {
    /// The literal, quotes and unit included.
    pub literal: String,
    /// `0.1493 to 0.1519`.
    pub interval: String,
}

impl Estimate {
    /// The estimate in the style of the literal `old`, of a new one where there is none.
    pub(crate) fn written(&self, old: Option<&str>) -> Written {
        let fresh = || {
            let text = units::format(self.value, self.unit);
            if self.unit == "1" { text } else { format!("\"{text}\"") }
        };
        if self.low.is_some() && self.low == self.high {
            return Written { literal: fresh(), interval: "held".into() };
        }
        let style = Style::of(&old.map_or_else(fresh, String::from), self.unit);
        let place = self.place(style.factor);
        // An end far below the estimate has digits of its own.
        let number = |value: f64| style.number(value / style.factor, place.min(shown(value / style.factor)));
        let fine =
            (self.detectable_change / style.factor).log10().floor().min(f64::from(place)).max(f64::from(place - MOST))
                as i32;
        let value = style.number(self.value / style.factor, fine);
        let unit = if style.unit.is_empty() { String::new() } else { format!(" {}", style.unit) };
        let interval = match (self.low, self.high) {
            (Some(low), Some(high)) => format!("{} to {}{unit}", number(low), number(high)),
            (Some(low), None) => format!("at least {}{unit}", number(low)),
            (None, Some(high)) => format!("at most {}{unit}", number(high)),
            (None, None) => "not determined by these data".into(),
        };
        let doubt = if self.contradicted { ", were the model right" } else { "" };
        Written { literal: format!("{}{value}{}", style.before, style.after), interval: interval + doubt }
    }

    /// Power of ten of the last digit that is written, in units of `factor`.
    fn place(&self, factor: f64) -> i32 {
        let half = match (self.low, self.high) {
            (Some(low), Some(high)) => Some(0.5 * (high - low)),
            (Some(end), None) | (None, Some(end)) => Some((self.value - end).abs()),
            (None, None) => None,
        };
        // An interval of just a power of ten may be a rounding error below it.
        let leading = |x: f64| (x / factor * (1.0 + 1e-9)).abs().log10().floor() as i32;
        let own = if self.value == 0.0 { half.map_or(0, leading) } else { leading(self.value) };
        let place = match half.filter(|half| *half > 0.0) {
            Some(half) => leading(half) + 1 - OF_INTERVAL,
            None => own + 1 - OTHERWISE,
        };
        place.clamp(own + 1 - MOST, own + 1 - FEWEST)
    }
}

/// Power of ten of the last digit of a number that is written with the fewest.
fn shown(x: f64) -> i32 {
    if x == 0.0 { i32::MAX } else { (x * (1.0 + 1e-9)).abs().log10().floor() as i32 + 1 - FEWEST }
}

/// How a number is written.
struct Style {
    /// What stands before the number, e.g. a quotation mark.
    before: String,
    /// What stands after it: unit and quotation mark.
    after: String,
    /// Its unit; empty for a bare number.
    unit: String,
    /// The unit in SI.
    factor: f64,
    /// The power of ten of a number with exponent.
    exponent: Option<i32>,
}

impl Style {
    fn of(raw: &str, si_unit: &str) -> Self {
        let quotes = |c: char| c == '"' || c == '\'';
        let inner = raw.trim_matches(quotes);
        let (number, unit) = if inner.len() == raw.len() { (raw, "") } else { units::split_number(inner.trim()) };
        let exponent = (!number.starts_with("0x"))
            .then(|| number.split_once(['e', 'E']))
            .flatten()
            .and_then(|(_, exponent)| exponent.replace('_', "").parse().ok());
        let factor = if unit.is_empty() { Ok(1.0) } else { units::parse(&format!("1 {unit}"), si_unit) };
        match (raw.find(number).filter(|_| !number.is_empty()), factor) {
            (Some(at), Ok(factor)) => Self {
                before: raw[..at].into(),
                after: raw[at + number.len()..].into(),
                unit: unit.into(),
                factor,
                exponent,
            },
            // Written with escapes, perhaps.
            _ => Self { before: String::new(), after: String::new(), unit: String::new(), factor: 1.0, exponent: None },
        }
    }

    /// A number rounded to the power of ten `place`.
    fn number(&self, x: f64, place: i32) -> String {
        let leading = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
        let near = |e: &i32| (-1..=1).contains(&(leading - e));
        let own = if (-4..7).contains(&leading) && self.exponent.is_none() { None } else { Some(leading) };
        match self.exponent.filter(near).or(own) {
            Some(e) => format!("{:.*}e{e}", (e - place).max(0) as usize, positive_zero(x / 10f64.powi(e))),
            None if place > 0 => format!("{:.0}", positive_zero((x / 10f64.powi(place)).round() * 10f64.powi(place))),
            None => format!("{:.*}", (-place) as usize, positive_zero(x)),
        }
    }
}

fn positive_zero(x: f64) -> f64 {
    x + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: f64, half: f64, unit: &'static str, old: Option<&str>) -> (String, String) {
        let (low, high) = (Some(value - half), Some(value + half));
        let one =
            Estimate { key: "k".into(), value, unit, low, high, detectable_change: f64::INFINITY, contradicted: false };
        let written = one.written(old);
        (written.literal, written.interval)
    }

    fn is(got: (String, String), literal: &str, interval: &str) {
        assert_eq!((got.0.as_str(), got.1.as_str()), (literal, interval));
    }

    #[test]
    fn two_digits_of_the_interval_in_the_style_that_stood_there() {
        is(written(0.150_58, 0.001_32, "1", Some("0.12")), "0.1506", "0.1493 to 0.1519");
        is(written(88_843.0, 123.0, "N/m", Some("\"8.9e4 N/m\"")), "\"8.884e4 N/m\"", "8.872e4 to 8.897e4 N/m");
        is(written(88_843.0, 123.0, "N/m", Some("89000")), "88840", "88720 to 88970");
        is(written(88_843.0, 123.0, "N/m", Some("'89 kN/m'")), "'88.84 kN/m'", "88.72 to 88.97 kN/m");
        is(written(0.060_42, 0.000_15, "m", Some("\"60 mm\"")), "\"60.42 mm\"", "60.27 to 60.57 mm");
        is(written(0.0512, 0.0011, "1", Some("\"5 %\"")), "\"5.12 %\"", "5.01 to 5.23 %");
        is(written(1.234e-3, 2e-5, "m/s", None), "\"1.234 mm/s\"", "1.214 to 1.254 mm/s");
        is(written(-2.5e9, 1e7, "N m/rad^3", None), "\"-2.500e9 N m/rad^3\"", "-2.510e9 to -2.490e9 N m/rad^3");
        is(
            written(5.02e-3, 1e-5, "kg m^2", Some("\"5.0e-3 kg m^2\"")),
            "\"5.020e-3 kg m^2\"",
            "5.010e-3 to 5.030e-3 kg m^2",
        );
    }

    #[test]
    fn open_ends_are_said_in_words() {
        let one = |low, high| Estimate {
            key: "k".into(),
            value: 0.123_456,
            unit: "1",
            low,
            high,
            detectable_change: f64::INFINITY,
            contradicted: false,
        };
        assert_eq!(one(Some(0.1), None).written(None).interval, "at least 0.100");
        assert_eq!(one(None, Some(0.2)).written(None).interval, "at most 0.200");
        let written = one(None, None).written(None);
        assert_eq!((written.literal.as_str(), written.interval.as_str()), ("0.1235", "not determined by these data"));
    }

    #[test]
    fn estimates_that_are_tied_together_keep_the_digits_that_show() {
        let (low, high) = (Some(0.1), Some(0.2));
        let one = Estimate {
            key: "k".into(),
            value: 0.151_234,
            unit: "1",
            low,
            high,
            detectable_change: 3e-5,
            contradicted: false,
        }
        .written(None);
        assert_eq!((one.literal.as_str(), one.interval.as_str()), ("0.15123", "0.100 to 0.200"));
        let one = Estimate {
            key: "k".into(),
            value: 0.15,
            unit: "1",
            low: Some(0.1),
            high: None,
            detectable_change: 1.0,
            contradicted: true,
        };
        assert!(one.written(None).interval.ends_with(", were the model right"));
    }

    #[test]
    fn what_is_written_is_read_again() {
        for unit in ["m", "m/s", "N/m", "s", "1", "W"] {
            for exponent in -10..10 {
                for old in [None, Some("1"), Some("1e3")] {
                    let value = 1.234_567 * 10f64.powi(exponent);
                    let one = Estimate {
                        key: "k".into(),
                        value,
                        unit,
                        low: None,
                        high: None,
                        detectable_change: f64::INFINITY,
                        contradicted: false,
                    };
                    let text = one.written(old).literal;
                    let bare = text.parse().ok();
                    let again = bare.or_else(|| units::parse(text.trim_matches('"'), unit).ok()).expect(&text);
                    assert!((again / value - 1.0).abs() < 1e-3, "{text} for {value} {unit}");
                }
            }
        }
    }
}
