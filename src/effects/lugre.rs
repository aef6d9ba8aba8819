//! A rate element in place of the slip interface.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

use crate::parameter::ZERO_OR_MORE;

/// Bristle rate element (LuGre).
pub struct LuGre;

impl Effect for LuGre {
    fn name(&self) -> &'static str {
        "lugre"
    }
    fn title(&self) -> &'static str {
        "Bristle rate element (LuGre)"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "z′ = v − kc|v|z/(μ(|v|)N), F = kc z + cc z′ + σ₂v"
    }
    fn meaning(&self) -> &'static str {
        "Instead of sticking or slipping, the bristles yield gradually: their mean stretch z approaches that of \
         sliding over a travel μN/kc. There is no threshold, hence creep under any force; σ₂ adds a viscous force \
         in the relative motion. With σ₂ = 0 and cc = 0 it is the model of Dahl."
    }
    fn source(&self) -> &'static str {
        "C. Canudas de Wit, H. Olsson, K. J. Åström and P. Lischinsky, A new model for control of systems with \
         friction, IEEE Trans. Autom. Control 40 (1995) 419; P. R. Dahl, A solid friction model, Aerospace Corp. \
         TOR-0158 (1968)."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: like static contact, with the damping σ₂ added; at low loads more damped, with a phase that lags \
         earlier. Partial stick: the transition happens over a travel instead of at a force, and the arm may \
         slide where the base would stick; with the published rig the peak is taller and nearer to static contact \
         even at σ₂ = 0. Full slip: only σ₂ b² is left of it, a lower peak at the same frequency and a mean angle \
         that grows with V."
    }
    fn zero(&self) -> &'static [Zero] {
        &[]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("sigma_2", "σ₂", "N s/m"),
            ZERO_OR_MORE,
            (0.0, 1e3),
            "viscous coefficient of the relative motion",
        )
        .in_units_of(Measure::ContactDamping)];
        LIST
    }

    fn rate_element(&self, p: &[Dual]) -> Option<Dual> {
        Some(p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_viscous_coefficient_is_handed_on_and_nothing_returns_the_base() {
        assert_eq!(LuGre.rate_element(&[Dual::constant(8.0)]).map(|sigma| sigma.value), Some(8.0));
        assert!(LuGre.zero().is_empty());
    }
}
