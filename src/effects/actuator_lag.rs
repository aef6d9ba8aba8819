//! The actuator follows its command like a low pass.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

use crate::parameter::ZERO_OR_MORE;

/// Lag of the actuator.
pub struct ActuatorLag;

impl Effect for ActuatorLag {
    fn name(&self) -> &'static str {
        "actuator-lag"
    }
    fn title(&self) -> &'static str {
        "Lag of the actuator"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "u → u/(1 + iωτ)"
    }
    fn meaning(&self) -> &'static str {
        "A piezo behind a source of finite resistance, a shaker or a servo loop follows its command like a low pass \
         of first order: less drive and a lag, both growing with frequency. It is no matter where the drive itself is \
         measured."
    }
    fn source(&self) -> &'static str {
        "Specification: low pass of first order."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact, V = 0, partial stick and full slip: the phase lags by atan ωτ and the height falls by 1/√(1 + ω²τ²); for \
         small ωτ only the phase shows, which then looks like a delay of the sensor. In partial stick the smaller \
         stroke also acts like a larger V; on a nonlinear rig the smaller drive bends less."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] =
            &[ParameterInfo::searched(("tau", "τ", "s"), ZERO_OR_MORE, (1e-6, 1e-2), "time constant of the actuator")
                .in_units_of(Measure::Time)];
        LIST
    }

    fn drive(&self, p: &[Dual], omega: f64) -> Option<(Dual, Dual)> {
        let angle = p[0] * omega;
        let re = (angle * angle + Dual::constant(1.0)).recip();
        Some((re, -(angle * re)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_power_and_45_degrees_where_omega_tau_is_one() {
        let (re, im) = ActuatorLag.drive(&[Dual::parameter(1e-3, 16)], 1e3).expect("a factor");
        assert!((re.value - 0.5).abs() < 1e-15 && (im.value + 0.5).abs() < 1e-15);
        // d/dτ of 1/(1 + iωτ) is -iω/(1 + iωτ)^2, here -iω/(2i).
        assert!((re.gradient[16] + 500.0).abs() < 1e-9 && im.gradient[16].abs() < 1e-9);
        let (re, im) = ActuatorLag.drive(&[Dual::constant(0.0)], 1e3).expect("a factor");
        assert_eq!((re.value, im.value), (1.0, 0.0));
    }
}
