//! What is wrong with a model in a few words: which way its resonances are off, and over which conditions.

use super::regions::{SHIFTED, drive};
use super::{Comparison, ConditionMetrics};
use crate::units::{self, Frequencies};

/// Relative error of a peak's height up to which nothing is said of it, in standard deviations of a reading.
const HIGHER: f64 = 3.0;

/// Sentences such as `resonance 9.9 to 10.5 Hz too low at 0.05 to 2 mm/s (6 of 13 conditions)`, none where the peaks
/// are right within their noise.
pub fn shifts(c: &Comparison) -> Vec<String> {
    let digits = Frequencies::of(c.points.iter().map(|p| p.point.frequency));
    let frequency = |m: &ConditionMetrics| {
        let shift = m.model_peak?.frequency_hz - m.measured_peak?.frequency_hz;
        (shift.abs() > (SHIFTED * m.measured_width).max(3.0 * m.measured_peak_sd)).then_some(shift)
    };
    let height = |m: &ConditionMetrics| {
        let error = 100.0 * (m.model_peak?.amplitude / m.measured_peak?.amplitude - 1.0);
        (error.abs() > HIGHER * m.metrics.noise_percent).then_some(error)
    };
    let hertz = |least: f64, most: f64| {
        let [low, high] = [least, most].map(|f| digits.difference(f));
        let number = low.split(' ').next().unwrap_or(&low);
        if low == high { low } else { format!("{number} to {high}") }
    };
    let percent = |least: f64, most: f64| {
        let [low, high] = [least, most].map(|p| if p < 10.0 { format!("{p:.1}") } else { format!("{p:.0}") });
        if low == high { format!("{low} %") } else { format!("{low} to {high} %") }
    };
    let mut said = Vec::new();
    for sign in [-1.0, 1.0] {
        said.extend(sentence(c, "resonance", sign, &frequency, &hertz));
    }
    for sign in [-1.0, 1.0] {
        said.extend(sentence(c, "peak", sign, &height, &percent));
    }
    said
}

/// Of the conditions in which something is off to one side.
fn sentence(
    c: &Comparison,
    what: &str,
    sign: f64,
    off: &dyn Fn(&ConditionMetrics) -> Option<f64>,
    show: &dyn Fn(f64, f64) -> String,
) -> Option<String> {
    let of = |m| off(m).filter(|value| value * sign > 0.0).map(f64::abs);
    let some: Vec<(&ConditionMetrics, f64)> = c.conditions.iter().filter_map(|m| Some((m, of(m)?))).collect();
    let ends = |value: &dyn Fn(&(&ConditionMetrics, f64)) -> f64| {
        some.iter().map(value).fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)))
    };
    let contact = some.first()?.0.setting.contact;
    let (least, most) = ends(&|(_, value)| *value);
    let (low, high) = ends(&|(m, _)| if contact { m.setting.speed } else { m.setting.drive });
    let signal = some[0].0.setting.signal;
    let name = |value: f64| match (contact, value == 0.0) {
        (true, true) => "0 mm/s".into(),
        (true, false) => units::format(value, "m/s"),
        (false, _) => drive(value, &signal),
    };
    let place = match (low == high, low == 0.0 && contact) {
        (true, true) => "at rest".into(),
        (true, false) => format!("at {}", name(low)),
        (false, _) => between(&name(low), &name(high)),
    };
    let side = if sign > 0.0 { "high" } else { "low" };
    let of = format!("{} of {} conditions", some.len(), c.conditions.len());
    Some(format!("{what} {} too {side} {place} ({of})", show(least, most)))
}

/// Two quantities with their unit once, where it is the same.
fn between(low: &str, high: &str) -> String {
    match (low.split_once(' '), high.split_once(' ')) {
        (Some((number, unit)), Some((_, other))) if unit == other => format!("at {number} to {high}"),
        _ => format!("at {low} to {high}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_its_unit_once_where_that_is_the_same() {
        assert_eq!(between("0.05 mm/s", "2 mm/s"), "at 0.05 to 2 mm/s");
        assert_eq!(between("500 mV", "2 V"), "at 500 mV to 2 V");
    }
}
