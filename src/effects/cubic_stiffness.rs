//! A restoring torque or force that grows with the cube of the deflection.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::ANY;

/// Cubic stiffness (Duffing).
pub struct CubicStiffness;

impl Effect for CubicStiffness {
    fn name(&self) -> &'static str {
        "cubic-stiffness"
    }
    fn title(&self) -> &'static str {
        "Cubic stiffness (Duffing)"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −K₃θ³"
    }
    fn meaning(&self) -> &'static str {
        "A spring or clamp that stiffens (K₃ > 0) or softens (K₃ < 0) with the deflection: a large oscillation \
         feels it, and a static deflection, such as bμW/K under the friction force, moves the point around which \
         even a small one goes on."
    }
    fn source(&self) -> &'static str {
        "G. Duffing, Erzwungene Schwingungen bei veränderlicher Eigenfrequenz (1918)."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: the peak bends with the amplitude along f = f₀(1 + 3K₃X²/(8K)), up for K₃ > 0 and down \
         for K₃ < 0, with the damping unchanged; where it bends by more than about its width the curve folds, and \
         sweeps up and down jump at different frequencies. V = 0: the same, which for small amplitudes is nothing, \
         since there is no mean deflection. Partial stick and full slip: the resonance moves by about 3K₃θ₀²/K of \
         the stiffness, up for K₃ > 0, in proportion to the square of load and friction and equally at every V; the \
         height falls a little as the peak moves up."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("K_3", "K₃", "N m/rad^3"),
            ANY,
            (1e5, 1e12),
            "cubic coefficient of torque or force",
        )
        .in_units_of(Measure::Cubic)
        .alone(0.01, 1000.0)
        .either_sign()];
        LIST
    }

    fn torque(&self, p: &[f64], th: f64, _w: f64) -> Option<Law> {
        let square = th * th;
        Some(Law {
            value: -p[0] * square * th,
            d_first: -3.0 * p[0] * square,
            d_second: 0.0,
            d_parameters: [-square * th, 0.0, 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_is_odd_and_its_slope_that_of_a_cube() {
        let at = |th: f64| CubicStiffness.torque(&[8e7], th, 0.0).unwrap_or_default();
        assert_eq!(at(0.0), Law::default());
        assert!((at(1e-3).value + 0.08).abs() < 1e-15 && at(-1e-3).value == -at(1e-3).value);
        assert!((at(1e-3).d_first + 240.0).abs() < 1e-12);
    }
}
