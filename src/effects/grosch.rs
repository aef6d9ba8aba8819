//! The bell-shaped master curve of rubber friction over the logarithm of the slip rate.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use std::f64::consts::LN_10;

use crate::parameter::POSITIVE;

/// Slip rate \[m/s\] that keeps the logarithm finite at rest.
const SMALLEST: f64 = 1e-9;

/// Master curve of rubber (Grosch).
pub struct Grosch;

impl Effect for Grosch {
    fn name(&self) -> &'static str {
        "grosch"
    }
    fn title(&self) -> &'static str {
        "Master curve of rubber (Grosch)"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "μ(s) = μ + Δμ exp(−[log₁₀((s + 1 nm/s)/vₘ)]² / (2h²))"
    }
    fn meaning(&self) -> &'static str {
        "Rubber friction has a maximum where the asperities excite it at the frequency of its largest \
         viscoelastic loss; over the logarithm of the slip rate the curve is a bell some decades wide. Below the \
         maximum friction strengthens with speed, above it weakens."
    }
    fn source(&self) -> &'static str {
        "K. A. Grosch, The relation between the friction and visco-elastic properties of rubber, Proc. R. Soc. A \
         274 (1963) 21."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: invisible until slip sets in. Partial stick: slip rates below v_m see a strengthening law, and \
         the curve moves towards the one of static contact. Full slip: below v_m like strengthening (a lower \
         peak, moved up), above v_m like weakening (a taller peak, possibly self-excitation); no effect where V \
         is near v_m."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("delta_mu", "Δμ", "1"),
                (0.0, 20.0),
                (0.02, 2.0),
                "height of the bell above the constant coefficient",
            ),
            ParameterInfo::searched(("v_m", "vₘ", "m/s"), POSITIVE, (1e-4, 10.0), "slip rate of the maximum")
                .in_units_of(Measure::Speed),
            ParameterInfo::searched(("h", "h", "decades"), (0.05, 30.0), (0.3, 3.0), "standard width of the bell"),
        ];
        LIST
    }

    fn friction(&self, p: &[f64], s: f64, _psi: f64) -> Option<Law> {
        let (delta, v, h) = (p[0], p[1], p[2]);
        let inside = s + SMALLEST;
        let decades = (inside / v).log10();
        let width = h * h;
        let bell = (-0.5 * decades * decades / width).exp();
        let value = delta * bell;
        let by_decades = -value * decades / width;
        Some(Law {
            value,
            d_first: by_decades / (inside * LN_10),
            d_second: 0.0,
            d_parameters: [bell, -by_decades / (v * LN_10), value * decades * decades / (width * h), 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_maximum_is_delta_mu_at_v_m_and_the_curve_is_even_in_decades() {
        let at = |s: f64| Grosch.friction(&[0.5, 0.1, 1.0], s, 0.0).unwrap_or_default();
        assert!((at(0.1).value - 0.5).abs() < 1e-15 && at(0.1).d_first.abs() < 1e-7);
        assert!((at(1.0).value - 0.5 * (-0.5f64).exp()).abs() < 1e-8);
        assert!((at(1.0).value - at(0.01).value).abs() < 1e-7);
        assert!(at(0.0).value < 1e-13, "next to nothing at rest");
    }
}
