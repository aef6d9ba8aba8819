//! A torque or force that grows with the square of the velocity.

use super::{Effect, Group, Law, Measure, ParameterInfo, Zero};
use crate::parameter::ZERO_OR_MORE;

/// Quadratic damping.
pub struct QuadraticDamping;

impl Effect for QuadraticDamping {
    fn name(&self) -> &'static str {
        "quadratic-damping"
    }
    fn title(&self) -> &'static str {
        "Quadratic damping"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −D₂|θ′|θ′"
    }
    fn meaning(&self) -> &'static str {
        "Drag whose loss grows with the cube of the amplitude, as that of a fluid pushed aside, of a turbulent \
         gap or of joints under larger motion. A linear damping cannot stand for it at two amplitudes of the \
         drive."
    }
    fn source(&self) -> &'static str {
        "L. S. Jacobsen, Steady forced vibration as influenced by damping, Trans. ASME 52 (1930)."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: the peak grows less than in proportion to the drive, at the same frequency, by an \
         equivalent damping (8/3π) D₂ω times the amplitude: 1/Q is a straight line over the amplitude. V = 0, partial stick and full \
         slip: a lower and broader peak, at nearly the same frequency unless strong (in partial stick it moves down \
         with the amplitude), the more the larger the drive. Curves at two drives tell it from linear damping."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[ParameterInfo::searched(
            ("D_2", "D₂", "N m s^2/rad^2"),
            ZERO_OR_MORE,
            (0.1, 1e4),
            "quadratic coefficient of torque or force",
        )
        .in_units_of(Measure::Quadratic)
        .alone(0.01, 1000.0)];
        LIST
    }

    fn torque_is_kinked(&self) -> bool {
        true
    }
    fn torque(&self, p: &[f64], _th: f64, w: f64) -> Option<Law> {
        let square = w.abs() * w;
        Some(Law {
            value: -p[0] * square,
            d_first: 0.0,
            d_second: -2.0 * p[0] * w.abs(),
            d_parameters: [-square, 0.0, 0.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_opposes_the_motion_with_its_square() {
        let at = |w: f64| QuadraticDamping.torque(&[40.0], 0.0, w).unwrap_or_default();
        assert_eq!((at(3.0).value, at(-3.0).value), (-360.0, 360.0));
        assert_eq!((at(-3.0).d_second, at(0.0).d_second), (-240.0, 0.0));
    }
}
