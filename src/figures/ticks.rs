//! Ticks of the axes and their labels.

use super::axes::Axis;
use super::style::{power_of_ten, significant};
use plotters::coord::ranged1d::{BoldPoints, Ranged};
use plotters::coord::types::RangedCoordf64;

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
        let nice = RangedCoordf64::from(self.low..self.high).key_points(BoldPoints(room as usize + 1));
        let spacing = |points: &[f64]| points.get(1).map(|second| second - points[0]);
        let step = self.step.or(spacing(&nice)).unwrap_or(self.high - self.low);
        let whole = |d: &usize| {
            let scaled = step / self.per * 10f64.powi(*d as i32);
            (scaled - scaled.round()).abs() < 1e-6
        };
        let decimals = (0..12).find(whole).unwrap_or(12);
        let (first, last) = ((self.low / step - 1e-6).ceil() as i64, (self.high / step + 1e-6).floor() as i64);
        let label = |k: i64| format!("{:.decimals$}", k as f64 * step / self.per).replace('-', "−");
        (first..=last.min(first + 200)).map(|k| (k as f64 * step, label(k))).collect()
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
                if !(self.low * (1.0 - 1e-9)..=self.high * (1.0 + 1e-9)).contains(&value) {
                    continue;
                }
                let named = labelled.contains(&digit) && (exponent - first) % every == 0;
                ticks.push((value, if named { log_label(digit, exponent) } else { String::new() }));
            }
        }
        ticks
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
    }
}
