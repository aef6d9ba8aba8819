//! Rate-and-state friction with the ageing law.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::POSITIVE;

/// Rate-and-state friction (ageing law).
pub struct RateAndState;

impl Effect for RateAndState {
    fn name(&self) -> &'static str {
        "rate-and-state"
    }
    fn title(&self) -> &'static str {
        "Rate-and-state friction (ageing law)"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "μ(s, ψ) = μ + a ln(1 + s/v₀) + B ln(1 + v₀ψ/Dc), ψ′ = 1 − sψ/Dc"
    }
    fn meaning(&self) -> &'static str {
        "Junctions strengthen with their age ψ and are replaced after a slip D_c, while friction at once grows \
         with the slip rate. A change of speed thus first strengthens and, after the slip D_c, strengthens (a > \
         B) or weakens (a < B)."
    }
    fn source(&self) -> &'static str {
        "J. H. Dieterich, Modeling of rock friction, J. Geophys. Res. 84 (1979) 2161; A. Ruina, Slip instability \
         and state variable friction laws, J. Geophys. Res. 88 (1983) 10359."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: invisible until slip sets in. Partial stick: the age grows while stuck, so that each slip starts \
         from a higher threshold. Full slip: a dashpot that depends on frequency, N/V [a − B/(1 + iωDc/V)]: of \
         strength a where V is far below ωDc and a − B where it is far above. Curves at several speeds on both \
         sides of that corner tell it from plain strengthening."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }, Zero { parameter: 1, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("a", "a", "1"),
                (0.0, 10.0),
                (0.002, 0.5),
                "direct rise of the friction coefficient per factor e of slip rate",
            ),
            ParameterInfo::searched(
                ("B", "B", "1"),
                (0.0, 10.0),
                (0.002, 0.5),
                "rise of the friction coefficient per factor e of age",
            ),
            ParameterInfo::searched(("v_0", "v₀", "m/s"), POSITIVE, (1e-6, 1e-1), "slip rate of reference")
                .in_units_of(Measure::Speed),
            ParameterInfo::searched(("D_c", "Dc", "m"), POSITIVE, (1e-6, 1e-3), "slip that replaces the junctions")
                .in_units_of(Measure::Travel),
        ];
        LIST
    }

    fn friction(&self, p: &[f64], s: f64, psi: f64) -> Option<Law> {
        let (a, b, v, d) = (p[0], p[1], p[2], p[3]);
        // An iterate of the solver may leave the age a little below zero, where the law is continued evenly.
        let (slip, per_age, age) = (s / v, v / d, psi.max(0.0));
        let healed = per_age * age;
        let (direct, aged) = (slip.ln_1p(), healed.ln_1p());
        let (by_rate, by_age) = (a / (v + s), if psi >= 0.0 { b * per_age / (1.0 + healed) } else { 0.0 });
        Some(Law {
            value: a * direct + b * aged,
            d_first: by_rate,
            d_second: by_age,
            d_parameters: [direct, aged, by_age * (age / v) - by_rate * slip, -by_age * (age / d)],
        })
    }
    fn interface_rate(&self, p: &[f64], s: f64, psi: f64) -> Option<Law> {
        let rate = s / p[3];
        Some(Law {
            value: 1.0 - rate * psi,
            d_first: -psi / p[3],
            d_second: -rate,
            d_parameters: [0.0, 0.0, 0.0, rate * psi / p[3]],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_sliding_changes_friction_by_a_minus_b_per_factor_e() {
        let p = [0.1, 0.08, 1e-8, 6e-5];
        let steady = |s: f64| {
            let psi = p[3] / s;
            assert!(RateAndState.interface_rate(&p, s, psi).unwrap_or_default().value.abs() < 1e-15);
            RateAndState.friction(&p, s, psi).unwrap_or_default().value
        };
        // Between v_0 << s, where 1 + s/v_0 is s/v_0, the aged term is spent: only the direct one is left.
        let fast = steady(std::f64::consts::E * 0.1) - steady(0.1);
        assert!((fast - 0.1).abs() < 1e-6, "{fast}");
        // Far below v_0 the reverse: only the ageing term changes.
        let slow = steady(std::f64::consts::E * 1e-13) - steady(1e-13);
        assert!((slow + 0.08).abs() < 1e-4, "{slow}");
    }

    #[test]
    fn at_rest_the_age_is_the_time() {
        let law = RateAndState.interface_rate(&[0.1, 0.1, 1e-3, 1e-5], 0.0, 7.0).unwrap_or_default();
        assert_eq!((law.value, law.d_second), (1.0, 0.0));
    }
}
