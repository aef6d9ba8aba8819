//! The roller gives way on its support.

use super::{Effect, Group, Measure, ParameterInfo, Support, Zero};
use crate::dual::Dual;

use crate::parameter::POSITIVE;

/// Compliance of the roller.
pub struct RollerCompliance;

impl Effect for RollerCompliance {
    fn name(&self) -> &'static str {
        "roller-compliance"
    }
    fn title(&self) -> &'static str {
        "Compliance of the roller"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "mᵣy″ + cᵣy′ + kᵣy = −F, v = V + y′ − bθ′, cᵣ = 2ζᵣ√(mᵣkᵣ)"
    }
    fn meaning(&self) -> &'static str {
        "The roller, its shaft and bearings give way tangentially under the friction force, and have a resonance \
         of their own at √(kᵣ/mᵣ). The arm then feels the bristles in series with this oscillator."
    }
    fn source(&self) -> &'static str {
        "Specification; two coupled oscillators as in J. Ormondroyd and J. P. Den Hartog, The theory of the \
         dynamic vibration absorber, Trans. ASME 50 (1928)."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: softer than static contact, so a lower frequency and, near the resonance of the roller, a split \
         or a second peak. Partial stick: the same in proportion to the share of stick. Full slip under a \
         constant coefficient: nothing, since the force is constant."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 1, value: f64::INFINITY }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("m_r", "mᵣ", "kg"),
                POSITIVE,
                (1e-3, 10.0),
                "mass of the roller that moves tangentially",
            )
            .in_units_of(Measure::ContactMass),
            ParameterInfo::searched(("k_r", "kᵣ", "N/m"), POSITIVE, (1e3, 1e8), "tangential stiffness of its support")
                .in_units_of(Measure::ContactStiffness),
            ParameterInfo::searched(
                ("zeta_r", "ζᵣ", "1"),
                (0.0, 100.0),
                (0.005, 1.0),
                "damping ratio of the roller on its support",
            ),
        ];
        LIST
    }

    fn support(&self, p: &[Dual]) -> Option<Support> {
        Some(Support { mass: p[0], damping: p[2] * (p[0] * p[1]).sqrt() * 2.0, stiffness: p[1] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_damping_ratio_is_that_of_the_free_roller() {
        let p = [0.3, 1.2e5, 0.05].map(Dual::constant);
        let support = RollerCompliance.support(&p).expect("a support");
        let critical = 2.0 * (support.mass.value * support.stiffness.value).sqrt();
        assert!((support.damping.value / critical - 0.05).abs() < 1e-16);
    }
}
