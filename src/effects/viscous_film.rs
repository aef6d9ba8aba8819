//! A viscous film at the interface: friction grows in proportion to the slip rate.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};

/// A viscous film.
pub struct ViscousFilm;

impl Effect for ViscousFilm {
    fn name(&self) -> &'static str {
        "viscous-film"
    }
    fn title(&self) -> &'static str {
        "Viscous film"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "μ(s) = μ + bs"
    }
    fn meaning(&self) -> &'static str {
        "A thin film of a liquid or of softened rubber is sheared at the slip rate, its stress growing in proportion to it, \
         beside the dry friction."
    }
    fn source(&self) -> &'static str {
        "R. Stribeck, Die wesentlichen Eigenschaften der Gleit- und Rollenlager (1902): the viscous branch of his curve."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: nothing while the contact sticks. Partial stick: more damping. Full slip: a dashpot of bW in series \
         with the bristles, the same at every speed: a lower peak, and where bW is comparable with kc/ω, further right."
    }
    fn impersonator(&self) -> &'static str {
        "at one speed, rate-strengthening; at two, its dashpot falls with the speed and that of a film does not"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("b", "b", "s/m"),
            (0.0, 1e9),
            (0.1, 100.0),
            "rise of the friction coefficient per slip rate",
        )
        .in_units_of(Measure::Slowness)];
        LIST
    }

    fn friction(&self, p: &[f64], s: f64, _psi: f64) -> Option<Law> {
        Some(Law { value: p[0] * s, d_first: p[0], d_second: 0.0, d_parameters: [s, 0.0, 0.0, 0.0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_is_unchanged() {
        let law = ViscousFilm.friction(&[5.0], 0.0, 0.0).unwrap_or_default();
        assert_eq!((law.value, law.d_first), (0.0, 5.0));
    }
}
