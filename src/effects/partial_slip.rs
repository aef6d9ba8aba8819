//! Parallel elements that start to slip one after the other.

use super::{Effect, Group, ParameterInfo, Zero};

/// Partial slip (Iwan).
pub struct PartialSlip;

impl Effect for PartialSlip {
    fn name(&self) -> &'static str {
        "partial-slip"
    }
    fn title(&self) -> &'static str {
        "Partial slip (Iwan)"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "F = μN[1 − (1 − x/xₘ)ⁿ] on first loading, xₘ = nμN/kc"
    }
    fn meaning(&self) -> &'static str {
        "The edge of a contact slips before its centre does. Seen from the arm it is a continuum of parallel \
         elements, each with its own threshold of slip, whose force on first loading bends gradually into gross \
         slip; n = 3/2 is a sphere on a plane."
    }
    fn source(&self) -> &'static str {
        "W. D. Iwan, A distributed-element model for hysteresis and its steady-state dynamic response, J. Appl. \
         Mech. 33 (1966) 893; sphere: C. Cattaneo (1938) and R. D. Mindlin, Compliance of elastic bodies in \
         contact, J. Appl. Mech. 16 (1949) 259; V. L. Popov and M. Hess, Method of Dimensionality Reduction in \
         Contact Mechanics and Friction (2015)."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: softer, the more the stroke approaches xₘ, and more damped as long as the base still sticks; \
         where the base slips already, a taller peak at a lower frequency. With the published rig that takes \
         loads near 0.1 N. Partial stick: a rounder transition, visible only where the stroke is comparable with \
         xₘ. Full slip: nothing."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 1.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("n", "n", "1"),
            (1.0, 20.0),
            (1.0, 4.0),
            "exponent of the force on first loading",
        )];
        LIST
    }

    fn continuum(&self, p: &[f64]) -> Option<f64> {
        Some(p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponent_of_one_is_the_single_element() {
        assert_eq!(PartialSlip.continuum(&[1.0]), Some(PartialSlip.zero()[0].value));
    }
}
