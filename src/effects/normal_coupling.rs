//! The motion of the arm changes the normal load.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

use crate::parameter::ANY;

/// Normal load coupled to the motion.
pub struct NormalCoupling;

impl Effect for NormalCoupling {
    fn name(&self) -> &'static str {
        "normal-coupling"
    }
    fn title(&self) -> &'static str {
        "Normal load coupled to the motion"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "N = max(0, W + kₙbθ)"
    }
    fn meaning(&self) -> &'static str {
        "A contact that is inclined, off centre or not flat presses harder when the arm turns one way and lighter \
         when it turns the other. The load then follows the displacement bθ of the arm at the contact, static \
         deflection included."
    }
    fn source(&self) -> &'static str {
        "Specification: the linear law of a contact whose geometry ties the load to the displacement."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: shifts the threshold of slip in the two directions, of which little is left over a cycle even at low \
         loads. Partial stick: the peak changes in height rather than in place, lower for kₙ > 0, taller for \
         kₙ < 0. Full slip: the friction force follows the angle like a spring of μ kₙ b², so the peak moves down \
         (kₙ > 0) or up (kₙ < 0) as a whole, without damping, and equally at every speed and load."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("k_n", "kₙ", "N/m"),
            ANY,
            (1e2, 1e6),
            "change of the load per displacement of the arm at the contact",
        )
        .in_units_of(Measure::ContactStiffness)
        .either_sign()];
        LIST
    }

    fn load_stiffness(&self, p: &[Dual]) -> Option<Dual> {
        Some(p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stiffness_is_handed_on_with_its_sign() {
        let stiffness = NormalCoupling.load_stiffness(&[Dual::parameter(-4e4, 16)]).expect("couples");
        assert_eq!((stiffness.value, stiffness.gradient[16]), (-4e4, 1.0));
    }
}
