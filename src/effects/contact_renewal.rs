//! Bristles leave the contact after a travel and are replaced unstretched.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

use crate::parameter::POSITIVE;

/// Renewal of the contact (brush).
pub struct ContactRenewal;

impl Effect for ContactRenewal {
    fn name(&self) -> &'static str {
        "contact-renewal"
    }
    fn title(&self) -> &'static str {
        "Renewal of the contact (brush)"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "x′ = d − (V/ℓ)x, F = kc x + cc d"
    }
    fn meaning(&self) -> &'static str {
        "The rolling surface carries bristles through the contact: after a travel ℓ they leave it and fresh, \
         unstretched ones enter. The mean stretch then relaxes at the rate V/ℓ, as in the brush model of tyres \
         lumped into one state."
    }
    fn source(&self) -> &'static str {
        "Brush model of tyres: H. B. Pacejka, Tyre and Vehicle Dynamics; lumped form: specification."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: nothing. Partial stick: stuck bristles relax like a Maxwell element of time ℓ/V. Where kcℓ < μW \
         slip may never start: slow rolling then shows the curve of static contact, faster rolling a lower peak \
         that moves down. Full slip under a constant coefficient, possible only where kcℓ > μW: nothing."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: f64::INFINITY }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("len", "ℓ", "m"),
            POSITIVE,
            (1e-6, 1e-1),
            "travel over which a bristle stays in the contact",
        )
        .in_units_of(Measure::Travel)];
        LIST
    }

    fn renewal(&self, p: &[Dual], speed: Dual) -> Option<Dual> {
        Some(speed / p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_speed_over_travel_and_vanishes_at_rest() {
        let rate =
            |v: f64, len: f64| ContactRenewal.renewal(&[Dual::constant(len)], Dual::constant(v)).map(|rate| rate.value);
        assert_eq!(rate(0.02, 1e-4), Some(0.02 / 1e-4));
        assert_eq!(rate(0.0, 1e-4), Some(0.0));
        assert_eq!(rate(0.02, f64::INFINITY), Some(0.0));
    }
}
