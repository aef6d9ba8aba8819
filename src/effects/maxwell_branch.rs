//! A spring and a dashpot in series beside the bristles.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

use crate::parameter::{POSITIVE, ZERO_OR_MORE};

/// Viscoelastic branch (Maxwell), by its name.
pub struct MaxwellBranch(&'static str);

/// The one that is searched for.
pub static FIRST: MaxwellBranch = MaxwellBranch("maxwell-branch");
/// Those beside it: with it they make a Prony series.
static FURTHER: [&dyn Effect; 7] = [
    &MaxwellBranch("maxwell-branch-2"),
    &MaxwellBranch("maxwell-branch-3"),
    &MaxwellBranch("maxwell-branch-4"),
    &MaxwellBranch("maxwell-branch-5"),
    &MaxwellBranch("maxwell-branch-6"),
    &MaxwellBranch("maxwell-branch-7"),
    &MaxwellBranch("maxwell-branch-8"),
];

impl MaxwellBranch {
    fn is_first(&self) -> bool {
        self.0 == FIRST.0
    }
}

impl Effect for MaxwellBranch {
    fn name(&self) -> &'static str {
        self.0
    }
    fn title(&self) -> &'static str {
        "Viscoelastic branch (Maxwell)"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "F = kc x + cc d + q, q′ = k₁d − q/τ"
    }
    fn meaning(&self) -> &'static str {
        "Rubber relaxes: part of its stiffness acts only against motion faster than a relaxation time. With this \
         branch the bristles are a standard linear solid, whose stiffness grows from kc to kc + k₁ around ω = \
         1/τ. Up to seven others beside it, maxwell-branch-2 to maxwell-branch-8, make a Prony series."
    }
    fn source(&self) -> &'static str {
        "J. C. Maxwell, On the dynamical theory of gases, Phil. Trans. 157 (1867) 49; standard linear solid: C. \
         Zener, Elasticity and Anelasticity of Metals (1948)."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: the peak moves up by the in-phase part k₁(ωτ)²/(1 + (ωτ)²) and is lowered by the quadrature part \
         k₁ωτ/(1 + (ωτ)²), exactly. Partial stick: it is lowered, too; where it lies depends on how the \
         share of stick changes, and it may move down. Full slip: nothing, since the bristles do not move."
    }
    fn impersonator(&self) -> &'static str {
        "a contact with a fractional element (spring-pot) looks the same over \
         less than an octave of frequency at 1 % noise, as blind trials show; readings of the sticking contact a decade below the \
         resonance tell the two apart"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("k_1", "k₁", "N/m"), ZERO_OR_MORE, (1e3, 1e6), "stiffness of the branch")
                .in_units_of(Measure::ContactStiffness),
            ParameterInfo::searched(("tau", "τ", "s"), POSITIVE, (1e-5, 1e-1), "relaxation time of the branch")
                .in_units_of(Measure::Time),
        ];
        LIST
    }

    fn branch(&self, p: &[Dual]) -> Option<(Dual, Dual)> {
        self.is_first().then(|| (p[0], p[1]))
    }
    fn further_branch(&self, p: &[Dual]) -> Option<(Dual, Dual)> {
        (!self.is_first()).then(|| (p[0], p[1]))
    }
    fn further(&self) -> &'static [&'static dyn Effect] {
        if self.is_first() { &FURTHER } else { &[] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stiffness_and_the_time_are_handed_on() {
        let p = [Dual::constant(3e4), Dual::constant(2e-3)];
        for effect in [&FIRST as &dyn Effect].iter().chain(&FURTHER) {
            let (one, other) = (effect.branch(&p), effect.further_branch(&p));
            assert!(one.is_some() != other.is_some(), "{}", effect.name());
            let (stiffness, tau) = one.or(other).expect("a branch");
            assert_eq!((stiffness.value, tau.value), (3e4, 2e-3));
        }
    }
}
