//! A stop on either side, or a gap that closes.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::ZERO_OR_MORE;

/// Stops beyond a gap.
pub struct Clearance;

impl Effect for Clearance {
    fn name(&self) -> &'static str {
        "clearance"
    }
    fn title(&self) -> &'static str {
        "Clearance (stops beyond a gap)"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −k_g sign θ max(0, |θ| − g)"
    }
    fn meaning(&self) -> &'static str {
        "Within the gap the body swings freely; beyond it a spring is touched on either side: a stop, a bearing with play, a \
         crack, a clamp that lifts off and closes."
    }
    fn source(&self) -> &'static str {
        "S. Maezawa, Steady forced vibration of unsymmetrical piecewise-linear system, Bull. JSME 4 (1961); S. W. Shaw and P. \
         J. Holmes, A periodically forced piecewise linear oscillator, J. Sound Vib. 90 (1983) 129."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: linear, whatever the drive, as long as the motion stays below g; beyond it the peak bends up, with a \
         corner at the amplitude g, and towards the frequency of the stiffness K + k_g."
    }
    fn impersonator(&self) -> &'static str {
        "with few drive levels a cubic or a quintic stiffness: its amplitudes below g, which do not bend at all, tell; a stop \
         on one side alone, about twice as stiff, does nearly the same to the fundamental"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("k_g", "k_g", "N m/rad"), ZERO_OR_MORE, (1.0, 1e4), "stiffness of the stops")
                .in_units_of(Measure::Stiffness)
                .alone(0.1, 1e4),
            ParameterInfo::searched(("g", "g", "rad"), ZERO_OR_MORE, (1e-6, 1e-4), "gap to either side")
                .in_units_of(Measure::Motion)
                .alone(0.03, 1.0),
        ];
        LIST
    }

    fn beside_contact(&self) -> bool {
        false
    }
    fn torque_is_rough(&self, _p: &[f64]) -> bool {
        true
    }
    fn torque(&self, p: &[f64], th: f64, _w: f64) -> Option<Law> {
        let [stiffness, gap] = [p[0], p[1]];
        let beyond = th.abs() - gap;
        if beyond <= 0.0 {
            return Some(Law::default());
        }
        let sign = 1f64.copysign(th);
        Some(Law {
            value: -stiffness * sign * beyond,
            d_first: -stiffness,
            d_second: 0.0,
            d_parameters: [-sign * beyond, stiffness * sign, 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_the_gap_it_is_a_spring() {
        let at = |th: f64| Clearance.torque(&[20.0, 0.5], th, 0.0).unwrap_or_default();
        assert_eq!((at(0.4).value, at(1.5).value, at(-1.5).value), (0.0, -20.0, 20.0));
        assert_eq!((at(-0.4).d_first, at(-1.5).d_first), (0.0, -20.0));
    }
}
