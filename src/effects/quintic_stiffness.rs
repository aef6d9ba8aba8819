//! A restoring torque or force that grows with the fifth power of the deflection.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::ANY;

/// Quintic stiffness.
pub struct QuinticStiffness;

impl Effect for QuinticStiffness {
    fn name(&self) -> &'static str {
        "quintic-stiffness"
    }
    fn title(&self) -> &'static str {
        "Quintic stiffness"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −K₅θ⁵"
    }
    fn meaning(&self) -> &'static str {
        "A spring that is linear at small deflections and stiffens (K₅ > 0) or softens (K₅ < 0) late and then steeply: the \
         next term of a symmetric restoring force, as of a clamp that closes or of a membrane near its limit."
    }
    fn source(&self) -> &'static str {
        "A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations (1979), restoring forces in odd powers."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: the peak bends with the amplitude along f = f₀(1 + 5K₅X⁴/(16K)), with the damping unchanged: four \
         times as far at √2 times the amplitude, where a cubic stiffness bends it twice as far. V = 0: the same. Partial \
         stick and full slip: the resonance moves by about 5K₅θ₀⁴/K of the stiffness, with the fourth power of load and \
         friction."
    }
    fn impersonator(&self) -> &'static str {
        "over a small range of amplitudes a cubic stiffness: it takes drives that differ by two and more"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("K_5", "K₅", "N m/rad^5"),
            ANY,
            (1e11, 1e18),
            "quintic coefficient of torque or force",
        )
        .in_units_of(Measure::Quintic)
        .alone(0.01, 1000.0)
        .either_sign()];
        LIST
    }

    fn torque(&self, p: &[f64], th: f64, _w: f64) -> Option<Law> {
        let fourth = th.powi(4);
        Some(Law {
            value: -p[0] * fourth * th,
            d_first: -5.0 * p[0] * fourth,
            d_second: 0.0,
            d_parameters: [-fourth * th, 0.0, 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_is_odd_and_its_slope_that_of_a_fifth_power() {
        let at = |th: f64| QuinticStiffness.torque(&[8e12], th, 0.0).unwrap_or_default();
        assert_eq!(at(0.0), Law::default());
        assert!((at(1e-3).value + 0.008).abs() < 1e-15 && at(-1e-3).value == -at(1e-3).value);
        assert!((at(1e-3).d_first + 40.0).abs() < 1e-12);
    }
}
