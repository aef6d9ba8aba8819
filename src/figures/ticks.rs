//! Ticks of the axes and their labels.

use super::axes::Axis;
use super::style::{power_of_ten, significant};

impl Axis {
    /// Ticks with their labels (empty for minor ones) for an axis of that length.
    pub fn ticks(&self, length: f64, spacing: f64) -> Vec<(f64, String)> {
        if !self.named.is_empty() {
            return self.named.iter().map(|&value| (value, significant(value, 3))).collect();
        }
        let room = (length / spacing).max(2.0);
        if self.log { self.log_ticks(room) } else { self.linear_ticks(room) }
    }

    fn linear_ticks(&self, room: f64) -> Vec<(f64, String)> {
        let step = self.step.unwrap_or_else(|| self.round_step(room.floor() + 1.0));
        let whole = |d: &usize| {
            let scaled = step / self.per * 10f64.powi(*d as i32);
            (scaled - scaled.round()).abs() < 1e-6 && scaled.round() != 0.0
        };
        let decimals = (0..12).find(whole);
        let label = |k: i64| match (k as f64 * step / self.per, decimals) {
            (value, Some(decimals)) => format!("{value:.decimals$}").replace('-', "−"),
            (value, None) => significant(value, 3),
        };
        let (first, last) = self.multiples(step);
        (first..=last.min(first.saturating_add(200))).map(|k| (k as f64 * step, label(k))).collect()
    }

    /// The first and the last multiple of `step` on the axis.
    fn multiples(&self, step: f64) -> (i64, i64) {
        ((self.low / step - 1e-6).ceil() as i64, (self.high / step + 1e-6).floor() as i64)
    }

    /// The smallest of 1, 2 and 5 times a power of ten of which at most so many multiples lie on the axis.
    fn round_step(&self, most: f64) -> f64 {
        let range = self.high - self.low;
        let power = range.log10().floor() as i32;
        // At a thousandth of the range there is room for no more.
        let steps = (0..4).flat_map(|down| [5.0, 2.0, 1.0].map(|digit| digit * 10f64.powi(power - down)));
        let fits = |step: &f64| {
            let (first, last) = self.multiples(*step);
            (last as f64 - first as f64) + 1.0 <= most
        };
        steps.take_while(fits).last().unwrap_or(range)
    }

    // Not by plotters' `LogCoord`, which leaves out values below 2e-16 and the digits before the first decade.
    fn log_ticks(&self, room: f64) -> Vec<(f64, String)> {
        let decades = self.high.log10() - self.low.log10();
        let every = (decades / room).ceil().max(1.0) as i32;
        // One power of ten alone does not show the scale: then the labels may stand closer.
        let powers = self.high.log10().floor() - self.low.log10().ceil() + 1.0;
        let closest = if powers < 2.0 { 0.6 } else { 0.3 };
        let labelled: &[i32] = if decades < closest * room && decades < 2.5 { &[1, 2, 5] } else { &[1] };
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let mut ticks = Vec::new();
        for exponent in first..=last {
            for digit in 1..if every > 1 { 2 } else { 10 } {
                let value = f64::from(digit) * 10f64.powi(exponent);
                let inside = (self.low * (1.0 - 1e-9)..=self.high * (1.0 + 1e-9)).contains(&value);
                if !(inside && value.is_finite()) {
                    continue;
                }
                let named = labelled.contains(&digit) && (exponent - first) % every == 0;
                ticks.push((value, if named { log_label(digit, exponent) } else { String::new() }));
            }
        }
        // Between two of those values round ones on a linear scale name the axis.
        if ticks.iter().all(|(_, label)| label.is_empty()) { self.linear_ticks(room) } else { ticks }
    }
}

fn log_label(digit: i32, exponent: i32) -> String {
    if (-4..5).contains(&exponent) {
        return format!("{:.*}", (-exponent).max(0) as usize, f64::from(digit) * 10f64.powi(exponent));
    }
    if digit == 1 { power_of_ten(exponent) } else { format!("{digit}×{}", power_of_ten(exponent)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks(400.0, 88.0).into_iter().map(|(_, label)| label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn steps_are_round_and_the_ends_are_kept() {
        assert_eq!(labels(&Axis::linear("", 50.0, 100.0)), ["60", "80", "100"]);
        assert_eq!(labels(&Axis::linear("", -0.3, 0.3)), ["−0.2", "0.0", "0.2"]);
        assert_eq!(labels(&Axis::linear("", 0.0, 1.0).step(0.25)), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
        let axis = Axis::frequency("f", 999_700.0, 1_000_300.0);
        assert_eq!((axis.label.as_str(), labels(&axis)[0].as_str()), ("f [kHz]", "999.8"));
    }

    #[test]
    fn decades_are_labelled_and_few_of_them_finer() {
        let axis = |low, high| Axis { log: true, ..Axis::linear("", low, high) };
        assert_eq!(labels(&axis(1e-3, 1.0)), ["0.001", "0.01", "0.1", "1"]);
        assert_eq!(labels(&axis(1600.0, 40_000.0)), ["2000", "5000", "10000", "20000"]);
        assert_eq!(labels(&axis(0.5e-16, 2e-13)), ["10⁻¹⁶", "10⁻¹⁵", "10⁻¹⁴", "10⁻¹³"]);
        assert_eq!(labels(&axis(1.05, 1.83)), ["1.2", "1.4", "1.6", "1.8"]);
    }

    #[test]
    fn values_of_every_size_have_a_few_ticks() {
        for value in [5e-324, 1e-310, f64::MIN_POSITIVE, 3e-293, 1e-200, 2.3e-16, 1.0, 1e200, 1.7e308, f64::MAX] {
            for values in [[value, value], [0.0, value], [-value, value], [0.5 * value, value]] {
                let flat = Axis::linear("", values[0], values[1]);
                let axes = [flat, Axis::around("", values), Axis::logarithmic("", values, 0.1)];
                for axis in axes {
                    let ticks = axis.ticks(400.0, 88.0);
                    let inside = |at: f64| {
                        at.is_finite() && at >= axis.low - 1e-6 * at.abs() && at <= axis.high + 1e-6 * at.abs()
                    };
                    assert!(axis.low < axis.high && (1..400).contains(&ticks.len()), "{axis:?}: {ticks:?}");
                    assert!(ticks.iter().all(|(at, _)| inside(*at)), "{axis:?}: {ticks:?}");
                }
            }
        }
    }
}
