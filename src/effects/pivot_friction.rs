//! Dry friction between the moving body and the ground.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::ZERO_OR_MORE;

/// Dry friction in a pivot or a guide.
pub struct PivotFriction;

impl Effect for PivotFriction {
    fn name(&self) -> &'static str {
        "pivot-friction"
    }
    fn title(&self) -> &'static str {
        "Dry friction in the pivot (Coulomb)"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −F_c sign θ′; at rest whatever holds the body, up to F_c"
    }
    fn meaning(&self) -> &'static str {
        "A bearing, a guide or a seal that resists every motion with the same force. Where the drive is weaker than F_c the body \
         sticks: its amplitude is zero. Somewhat above it stops twice in every cycle."
    }
    fn source(&self) -> &'static str {
        "J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, Trans. ASME 53 (1931) 107."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: the peak stays where it is and falls more than in proportion as the drive is reduced, by an equivalent \
         damping of 4F_c/(πω) over the amplitude, until the body sticks; 1/Q is a straight line over one over the amplitude."
    }
    fn impersonator(&self) -> &'static str {
        "a joint that is stiff (friction-joint with large kₜ and n = 1); it tells itself apart by the shift of the peak at small motion"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("F_c", "F_c", "N m"),
            ZERO_OR_MORE,
            (1e-6, 1e-1),
            "torque or force of the friction",
        )
        .in_units_of(Measure::Force)
        .alone(1e-3, 1.0)];
        LIST
    }

    fn beside_contact(&self) -> bool {
        false
    }
    fn dry_friction(&self, p: &[Dual]) -> Option<Dual> {
        Some(p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_friction_is_the_parameter() {
        assert_eq!(PivotFriction.dry_friction(&[Dual::constant(0.2)]).map(|f| f.value), Some(0.2));
    }
}
