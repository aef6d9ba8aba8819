//! A damping that grows with any power of the velocity.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::{POSITIVE, Scales, ZERO_OR_MORE};

/// Damping by a power law.
pub struct PowerDamping;

impl Effect for PowerDamping {
    fn name(&self) -> &'static str {
        "power-damping"
    }
    fn title(&self) -> &'static str {
        "Damping by a power of the velocity"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −D|θ′/v₀|ᵖ sign θ′"
    }
    fn meaning(&self) -> &'static str {
        "Between dry friction (p = 0), a linear dashpot (p = 1) and the drag of a fluid (p = 2) lie seals, shear-thinning \
         oils, material damping and joints that slip little by little. D is the torque or force at the velocity v₀; with \
         v₀ = 1 in SI, which need not be stated, it is the coefficient of |θ′|ᵖ. A search keeps v₀ at the largest velocity without the effect. With \
         p = 0 a body that the drive cannot move sticks."
    }
    fn source(&self) -> &'static str {
        "L. S. Jacobsen, Steady forced vibration as influenced by damping, Trans. ASME 52 (1930)."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: the peak stays where it is, and its width goes with the power p − 1 of the amplitude: for p > 1 it \
         grows less than in proportion to the drive, for p < 1 more, and below a threshold of the drive with p = 0 nothing \
         moves."
    }
    fn contains(&self) -> &'static [&'static str] {
        &["pivot-friction", "quadratic-damping"]
    }
    fn impersonator(&self) -> &'static str {
        "over a small range of amplitudes any other p with its D; quadratic-damping is this with p = 2, pivot-friction with p = 0"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("D", "D", "N m"),
                ZERO_OR_MORE,
                (1e-6, 1e-1),
                "torque or force at the velocity v₀",
            )
            .in_units_of(Measure::Force)
            .alone(1e-3, 1e2),
            ParameterInfo::searched(("p", "p", "1"), (0.0, 4.0), (0.2, 4.0), "power of the velocity"),
            ParameterInfo::searched(("v_0", "v₀", "rad/s"), POSITIVE, (1e-3, 1e-1), "velocity at which D is stated")
                .in_units_of(Measure::Rate)
                .held(),
        ];
        LIST
    }

    fn unstated(&self, index: usize) -> Option<f64> {
        // D is the coefficient of the power itself.
        (index == 2).then_some(1.0)
    }
    fn simpler(&self, p: &[f64], _scales: &Scales) -> Option<(&'static str, Vec<f64>)> {
        let [d, exponent, at] = [p[0], p[1], p[2]];
        Some(if exponent > 1.0 { ("quadratic-damping", vec![d / (at * at)]) } else { ("pivot-friction", vec![d]) })
    }
    fn beside_contact(&self) -> bool {
        false
    }
    fn torque_is_rough(&self, p: &[f64]) -> bool {
        p[1] >= 1.0
    }
    fn torque_is_steep(&self, p: &[f64]) -> bool {
        p[1] < 1.0
    }
    fn torque(&self, p: &[f64], _th: f64, w: f64) -> Option<Law> {
        let [d, exponent, at] = [p[0], p[1], p[2]];
        if w == 0.0 || exponent == 0.0 {
            let linear = if exponent == 1.0 { -d / at } else { 0.0 };
            return Some(Law { d_second: linear, ..Law::default() });
        }
        let log = (w / at).abs().ln();
        let unit = (exponent * log).exp().copysign(w);
        let value = -d * unit;
        Some(Law {
            value,
            d_first: 0.0,
            d_second: exponent * value / w,
            d_parameters: [-unit, value * log, -exponent * value / at, 0.0],
        })
    }
    fn dry_friction(&self, p: &[Dual]) -> Option<Dual> {
        (p[1].value == 0.0).then_some(p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_powers_are_a_dashpot_and_a_drag() {
        let at = |p: f64, w: f64| PowerDamping.torque(&[6.0, p, 2.0], 0.0, w).unwrap_or_default();
        assert_eq!((at(1.0, 3.0).value, at(1.0, 0.0).d_second), (-9.0, -3.0));
        assert_eq!((at(2.0, -4.0).value, at(2.0, -4.0).d_second), (24.0, -12.0));
    }

    #[test]
    fn simpler_effects_are_it_with_a_whole_power() {
        for (exponent, name) in [(2.0, "quadratic-damping"), (0.0, "pivot-friction")] {
            let p = [6.0, exponent, 2.0];
            let (found, values) = PowerDamping.simpler(&p, &Scales::PAPER).expect("one");
            assert_eq!(found, name);
            let effect = crate::effects::find(name).expect("registered");
            let force = |e: &dyn Effect, p: &[f64]| {
                let dry = e.dry_friction(&p.iter().map(|&v| Dual::constant(v)).collect::<Vec<_>>());
                (e.torque(p, 0.3, -5.0).unwrap_or_default().value, dry.map(|f| f.value))
            };
            let ((own, dry), (simple, simple_dry)) = (force(&PowerDamping, &p), force(effect, &values));
            assert!((own - simple).abs() < 1e-14 * own.abs().max(1.0) && dry == simple_dry, "{name}: {own} {simple}");
        }
    }

    #[test]
    fn without_a_power_it_is_dry_friction() {
        let friction = |p: f64| PowerDamping.dry_friction(&[0.3, p, 1.0].map(Dual::constant)).map(|f| f.value);
        assert_eq!((friction(0.0), friction(0.5)), (Some(0.3), None));
    }
}
