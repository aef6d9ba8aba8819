//! Velocity weakening: friction falls as the interface slips faster.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::POSITIVE;

/// Velocity weakening (Stribeck).
pub struct Stribeck;

impl Effect for Stribeck {
    fn name(&self) -> &'static str {
        "stribeck"
    }
    fn title(&self) -> &'static str {
        "Velocity weakening (Stribeck)"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "μ(s) = μ + Δμ exp(−s/vₛ)"
    }
    fn meaning(&self) -> &'static str {
        "The friction at small slip rates exceeds that of fast sliding and decays to it over a characteristic \
         speed. In lubricated contacts the film carries more of the load as speed grows; in dry ones the \
         junctions have less time to strengthen."
    }
    fn source(&self) -> &'static str {
        "R. Stribeck, Die wesentlichen Eigenschaften der Gleit- und Rollenlager, Z. VDI 46 (1902) 1341; \
         exponential form: L. C. Bo and D. Pavelescu, The friction-speed relation and its influence on the \
         critical velocity of stick-slip motion, Wear 82 (1982) 277."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: invisible until the load is low enough for slip, then less slip than without it. Partial stick: \
         the falling law feeds energy into the arm and sharpens the peak; the effect is largest while V is below \
         v_s. Full slip: negative damping, a taller peak at nearly the same frequency, up to self-excitation; \
         gone where V is far above v_s."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("delta_mu", "Δμ", "1"),
                (0.0, 10.0),
                (0.01, 0.6),
                "rise of the friction coefficient at rest over fast sliding",
            ),
            ParameterInfo::searched(
                ("v_s", "vₛ", "m/s"),
                POSITIVE,
                (1e-4, 1.0),
                "slip rate over which the rise decays",
            )
            .in_units_of(Measure::Speed),
        ];
        LIST
    }

    fn friction(&self, p: &[f64], s: f64, _psi: f64) -> Option<Law> {
        let decay = (-s / p[1]).exp();
        let value = p[0] * decay;
        Some(Law {
            value,
            d_first: -value / p[1],
            d_second: 0.0,
            d_parameters: [decay, value * s / (p[1] * p[1]), 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_gives_the_whole_rise_and_fast_sliding_none_of_it() {
        let at = |s: f64| Stribeck.friction(&[0.2, 0.01], s, 0.0).unwrap_or_default();
        assert_eq!(at(0.0).value, 0.2);
        assert_eq!(at(0.0).d_first, -20.0);
        assert!(at(1.0).value < 1e-40 && at(1e300).value == 0.0);
        assert!((at(0.01).value - 0.2 / std::f64::consts::E).abs() < 1e-16);
    }
}
