//! A restoring torque or force that is not the same to both sides.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::{ANY, Scales};

/// Quadratic stiffness.
pub struct AsymmetricStiffness;

impl Effect for AsymmetricStiffness {
    fn name(&self) -> &'static str {
        "asymmetric-stiffness"
    }
    fn title(&self) -> &'static str {
        "Asymmetric stiffness"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −K₂θ²"
    }
    fn meaning(&self) -> &'static str {
        "A spring, clamp or arch that is stiffer to one side: a preload on a curved characteristic, gravity, a bent beam. The \
         oscillation shifts its own mean and has a second harmonic."
    }
    fn source(&self) -> &'static str {
        "H. Helmholtz, Die Lehre von den Tonempfindungen (1863); A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations (1979)."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: the peak bends down with the amplitude, along f = f₀(1 − 5K₂²X²/(12K²)) for either sign, with a mean \
         of −K₂X²/(2K) and a second harmonic. V = 0: the same. Partial stick and full slip: the resonance moves by \
         2K₂θ₀/K of the stiffness, up for K₂ > 0, in proportion to load and friction."
    }
    fn impersonator(&self) -> &'static str {
        "without a contact, in the first harmonic, a cubic stiffness of −10K₂²/(9K); the mean and the second harmonic tell"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("K_2", "K₂", "N m/rad^2"),
            ANY,
            (1e2, 1e7),
            "quadratic coefficient of torque or force",
        )
        .in_units_of(Measure::Even)
        .alone(0.1, 30.0)
        .either_sign()];
        LIST
    }

    fn simpler(&self, p: &[f64], scales: &Scales) -> Option<(&'static str, Vec<f64>)> {
        (!scales.has_contact).then(|| ("cubic-stiffness", vec![-10.0 * p[0] * p[0] / (9.0 * scales.stiffness)]))
    }
    fn torque_is_odd(&self) -> bool {
        false
    }
    fn torque(&self, p: &[f64], th: f64, _w: f64) -> Option<Law> {
        let square = th * th;
        Some(Law {
            value: -p[0] * square,
            d_first: -2.0 * p[0] * th,
            d_second: 0.0,
            d_parameters: [-square, 0.0, 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_is_the_same_to_both_sides() {
        let at = |th: f64| AsymmetricStiffness.torque(&[4e5], th, 0.0).unwrap_or_default();
        assert_eq!(at(0.0).value, 0.0);
        assert!((at(1e-3).value + 0.4).abs() < 1e-15 && at(-1e-3).value == at(1e-3).value);
        assert!((at(1e-3).d_first + 800.0).abs() < 1e-12);
    }

    #[test]
    fn the_cubic_that_acts_like_it_bends_the_resonance_as_much() {
        let scales = Scales { stiffness: 1000.0, has_contact: false, ..Scales::PAPER };
        let (name, values) = AsymmetricStiffness.simpler(&[4e5], &scales).expect("without a contact");
        assert_eq!(name, "cubic-stiffness");
        // Nayfeh and Mook, sections 2.3 and 4.1: -5 K_2^2 X^2/(12 K^2) and 3 K_3 X^2/(8 K) of the frequency.
        let (own, cubic) = (-5.0 / 12.0 * (4e5f64 / 1000.0).powi(2), 3.0 / 8.0 * values[0] / 1000.0);
        assert!((own / cubic - 1.0).abs() < 1e-12, "{own} {cubic}");
        assert!(AsymmetricStiffness.simpler(&[4e5], &Scales { has_contact: true, ..scales }).is_none());
    }
}
