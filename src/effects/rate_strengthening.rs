//! Velocity strengthening: friction grows with the logarithm of the slip rate.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::POSITIVE;

/// Velocity strengthening (logarithmic).
pub struct RateStrengthening;

impl Effect for RateStrengthening {
    fn name(&self) -> &'static str {
        "rate-strengthening"
    }
    fn title(&self) -> &'static str {
        "Velocity strengthening (logarithmic)"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "μ(s) = μ + β ln(1 + s/v₀)"
    }
    fn meaning(&self) -> &'static str {
        "Friction grows with the logarithm of the slip rate, as where junctions break by thermal activation or \
         rubber chains are pulled off the counterface. Around a steady sliding speed the interface then acts as a \
         dashpot of strength N dμ/ds in series with the bristles."
    }
    fn source(&self) -> &'static str {
        "Thermal activation: H. Eyring, J. Chem. Phys. 4 (1936) 283; for rubber: A. Schallamach, A theory of \
         dynamic rubber friction, Wear 6 (1963) 375."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: invisible until slip sets in. Partial stick: the slipping interface resists like a dashpot, and \
         where that is strong the curve moves towards the one of static contact. Full slip: the dashpot in series \
         with the bristles lowers the peak and moves it up towards that of static contact; less so the faster the \
         roller, in proportion to β W/V."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("beta", "β", "1"),
                (0.0, 10.0),
                (0.002, 0.5),
                "rise of the friction coefficient per factor e of slip rate",
            ),
            ParameterInfo::searched(
                ("v_0", "v₀", "m/s"),
                POSITIVE,
                (1e-6, 1e-1),
                "slip rate at which the rise sets in",
            )
            .in_units_of(Measure::Speed),
        ];
        LIST
    }

    fn friction(&self, p: &[f64], s: f64, _psi: f64) -> Option<Law> {
        let value = (s / p[1]).ln_1p();
        let slope = 1.0 / (p[1] + s);
        Some(Law {
            value: p[0] * value,
            d_first: p[0] * slope,
            d_second: 0.0,
            d_parameters: [value, -p[0] * slope * (s / p[1]), 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_is_unchanged_and_fast_sliding_gains_beta_per_factor_e() {
        let at = |s: f64| RateStrengthening.friction(&[0.1, 1e-3], s, 0.0).unwrap_or_default();
        assert_eq!(at(0.0).value, 0.0);
        assert_eq!(at(0.0).d_first, 100.0);
        assert!((at(std::f64::consts::E * 1e5).value - at(1e5).value - 0.1).abs() < 1e-8);
    }
}
