//! Damping in proportion to the stiffness, whatever the frequency.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

/// Structural damping.
pub struct StructuralDamping;

impl Effect for StructuralDamping {
    fn name(&self) -> &'static str {
        "structural-damping"
    }
    fn title(&self) -> &'static str {
        "Structural damping"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "C → C + ηK/ω"
    }
    fn meaning(&self) -> &'static str {
        "Springs and joints lose a fixed share of their elastic energy per cycle, whatever the frequency. At the \
         frequency of the drive the rig behaves as with the additional damping ηK/ω."
    }
    fn source(&self) -> &'static str {
        "R. E. D. Bishop, The treatment of damping forces in vibration theory, J. R. Aeronaut. Soc. 59 (1955) \
         738."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact, V = 0, partial stick and full slip: a lower and broader peak, at nearly the same frequency \
         unless strong (in partial stick it moves down with the amplitude), the same at every drive, load and speed; \
         far below the resonance the phase lags by η already. In a narrow band, or at a high quality factor, it is \
         hard to tell from a larger linear damping."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] =
            &[ParameterInfo::searched(("eta", "η", "1"), (0.0, 10.0), (1e-3, 0.3), "loss factor of the rig")
                .in_units_of(Measure::Loss)];
        LIST
    }

    fn damping(&self, p: &[Dual], k: Dual, omega: f64) -> Option<Dual> {
        Some(p[0] * k * (1.0 / omega))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loss_per_radian_does_not_depend_on_the_frequency() {
        let quadrature = |omega: f64| {
            let c = StructuralDamping.damping(&[Dual::constant(0.03)], Dual::constant(1e3), omega);
            c.map_or(f64::NAN, |c| c.value * omega)
        };
        assert!((quadrature(100.0) - 30.0).abs() < 1e-12 && (quadrature(700.0) - 30.0).abs() < 1e-12);
    }
}
