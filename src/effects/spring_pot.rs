//! Bristles whose stiffness and damping grow with a power of the frequency.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::{POSITIVE, ZERO_OR_MORE};
use std::f64::consts::FRAC_PI_2;

/// A fractional element beside the bristles.
pub struct SpringPot;

impl Effect for SpringPot {
    fn name(&self) -> &'static str {
        "spring-pot"
    }
    fn title(&self) -> &'static str {
        "Fractional element (spring-pot)"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "F = kc x + cc d + cₐ(t₀D)ᵃx, at one frequency cₐ(iωt₀)ᵃ"
    }
    fn meaning(&self) -> &'static str {
        "Rubber relaxes over decades of time, without one relaxation time: over a wide band its stiffness and its loss grow with \
         the same power a of the frequency, between a spring (a = 0) and a dashpot (a = 1). cₐ is the modulus at the frequency \
         1/t₀; with t₀ = 1 s, which need not be stated, it is the coefficient of the derivative in SI. A search keeps t₀ at one over \
         the resonance."
    }
    fn source(&self) -> &'static str {
        "G. W. Scott Blair, The role of psychophysics in rheology, J. Colloid Sci. 2 (1947) 21; R. L. Bagley and P. J. Torvik, A \
         theoretical basis for the application of fractional calculus to viscoelasticity, J. Rheol. 27 (1983) 201."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: the peak moves up by the in-phase part cₐ(ωt₀)ᵃcos(πa/2) and is lowered by the quadrature part \
         cₐ(ωt₀)ᵃsin(πa/2), exactly. Partial stick: lowered, too, the more the larger a. Full slip: nothing, since the bristles do \
         not move."
    }
    fn impersonator(&self) -> &'static str {
        "over less than an octave a maxwell-branch; with a near 0 or 1 another stiffness or damping of the contact: a decade of \
         frequencies of the sticking contact tells them apart"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("c_a", "cₐ", "N/m"), ZERO_OR_MORE, (1e3, 1e6), "modulus at the frequency 1/t₀")
                .in_units_of(Measure::ContactStiffness),
            ParameterInfo::searched(("a", "a", "1"), (0.01, 0.99), (0.05, 0.95), "order of the derivative"),
            ParameterInfo::searched(("t_0", "t₀", "s"), POSITIVE, (1e-4, 1e-1), "time at which cₐ is stated")
                .in_units_of(Measure::Time)
                .held(),
        ];
        LIST
    }

    fn unstated(&self, index: usize) -> Option<f64> {
        // c_a is the coefficient of the derivative itself.
        (index == 2).then_some(1.0)
    }
    fn fractional(&self, p: &[Dual], omega: f64) -> Option<(Dual, Dual)> {
        let size = p[0] * (p[2] * omega).powd(p[1]);
        let (sine, cosine) = (p[1] * FRAC_PI_2).sin_cos();
        Some((size * cosine, size * sine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_derivative_loses_as_much_as_it_keeps_and_a_whole_one_is_a_dashpot() {
        let at = |a: f64, omega: f64| {
            let found = SpringPot.fractional(&[3.0, a, 0.5].map(Dual::constant), omega);
            found.map_or((f64::NAN, f64::NAN), |(re, im)| (re.value, im.value))
        };
        let (re, im) = at(0.5, 8.0);
        assert!((re - 6.0 * 0.5f64.sqrt()).abs() < 1e-14 && (im - re).abs() < 1e-14);
        let (re, im) = at(1.0, 8.0);
        assert!(re.abs() < 1e-14 && (im - 12.0).abs() < 1e-14);
        assert_eq!(at(0.0, 8.0), (3.0, 0.0));
    }
}
