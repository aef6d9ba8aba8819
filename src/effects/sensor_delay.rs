//! The reading comes later than the motion.

use super::{Effect, Group, Measure, ParameterInfo, Scales, Zero};
use crate::dual::Dual;
use crate::parameter::ANY;
use std::f64::consts::PI;

/// Delay of the sensor.
pub struct SensorDelay;

impl Effect for SensorDelay {
    fn name(&self) -> &'static str {
        "sensor-delay"
    }
    fn title(&self) -> &'static str {
        "Delay of the sensor"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "measured phase = φ − ωτ"
    }
    fn meaning(&self) -> &'static str {
        "Filters, sampling and cables delay the signal of the reading (τ > 0) or that of the drive (τ < 0). The \
         motion itself is unchanged."
    }
    fn source(&self) -> &'static str {
        "Specification: a constant delay between two channels."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact, V = 0, partial stick and full slip: the amplitude is unchanged; the phase falls by ωτ, a straight line \
         over frequency, the same at every load, speed and drive."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] =
            &[ParameterInfo::searched(("tau", "τ", "s"), ANY, (1e-6, 1e-2), "delay of the reading behind the drive")
                .in_units_of(Measure::Time)
                .either_sign()];
        LIST
    }
    /// Up to a radian over the width of the resonance, which behind a long cable is many turns; but less than half a turn
    /// from one frequency to the next, since readings cannot tell delays that differ by a whole one. A fit may leave the
    /// range by a factor of three.
    fn search_range(&self, index: usize, scales: &Scales) -> (f64, f64) {
        let (low, high) = self.parameters()[index].search_range(scales);
        let told = if scales.spacing > 0.0 { PI / scales.spacing } else { f64::INFINITY };
        let high = high.max(scales.quality / scales.omega).min(told / 3.0);
        (low.min(0.1 * high), high)
    }

    fn reading(&self, p: &[Dual], omega: f64) -> Option<Dual> {
        Some(-(p[0] * omega))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_tell_less_than_half_a_turn_between_neighbours() {
        let scales = Scales { quality: 1e5, spacing: 0.0, ..Scales::PAPER };
        let (low, high) = SensorDelay.search_range(0, &scales);
        assert_eq!(high, scales.quality / scales.omega);
        for spacing in [0.1, 1.0, 1e5] {
            let range = SensorDelay.search_range(0, &Scales { spacing, ..scales });
            assert!(3.0 * range.1 * spacing <= PI * (1.0 + 1e-12), "{spacing}: {range:?}");
            assert!(range.0 <= low && range.0 < range.1 && range.1 <= high, "{spacing}: {range:?}");
        }
    }

    #[test]
    fn the_phase_falls_in_proportion_to_the_frequency() {
        let angle = SensorDelay.reading(&[Dual::parameter(3e-4, 16)], 500.0).expect("an angle");
        assert_eq!((angle.value, angle.gradient[16]), (-0.15, -500.0));
        assert_eq!(SensorDelay.reading(&[Dual::constant(0.0)], 500.0).map(|angle| angle.value), Some(0.0));
    }
}
