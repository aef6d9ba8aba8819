//! What the drive puts into the reading without any motion.

use super::{Beside, Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::ANY;

/// Crosstalk.
pub struct Crosstalk;

impl Effect for Crosstalk {
    fn name(&self) -> &'static str {
        "crosstalk"
    }
    fn title(&self) -> &'static str {
        "Crosstalk of the drive into the reading"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "reading += (b_r + i b_i) ω₀ⁿ/K times the drive, n the derivative that is read"
    }
    fn meaning(&self) -> &'static str {
        "The wires of the drive couple into those of the pick-up, or the drive moves what holds it: a share of the drive, constant \
         over the band, stands in the reading beside the motion. b is that share over the static deflection of the rig \
         (of a velocity or an acceleration times ω₀ or ω₀²), so that b over the quality factor is its share of the peak; ω₀ is that of \
         the rig without contact. b_r is in phase with the drive, b_i 90° ahead. The motion itself is unchanged."
    }
    fn source(&self) -> &'static str {
        "P. J. Petersan and S. M. Anlage, J. Appl. Phys. 84, 3392 (1998): crosstalk, which moves the circle of a measured resonance off \
         the origin."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact, V = 0, partial stick and full slip: the resonance circle in the complex plane is moved off the origin by the same at every drive, in \
         proportion to it: a skewed peak, an antiresonance on one side, a phase that does not turn by 180°."
    }
    fn impersonator(&self) -> &'static str {
        "over a narrow band residual-modes with a phase of the instrument, and a delay where only the flanks are read"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }, Zero { parameter: 1, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("b_r", "b_r", "1"), ANY, (1e-2, 1e2), "crosstalk in phase with the drive")
                .in_units_of(Measure::Quality)
                .either_sign(),
            ParameterInfo::searched(("b_i", "b_i", "1"), ANY, (1e-2, 1e2), "crosstalk 90° ahead of the drive")
                .in_units_of(Measure::Quality)
                .either_sign(),
        ];
        LIST
    }

    fn beside(&self, p: &[Dual], of: &Beside) -> Option<(Dual, Dual)> {
        let (mut re, mut im) = (p[0] / of.stiffness, p[1] / of.stiffness);
        for _ in 0..of.order {
            // What is read is this times i omega.
            let ratio = (of.stiffness / of.inertia).sqrt() * (1.0 / of.omega);
            (re, im) = (im * ratio, re * ratio * -1.0);
        }
        Some((re, im))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    /// Whatever derivative is read, the share is the same at every frequency.
    #[test]
    fn the_share_of_the_drive_is_constant_in_what_is_read() {
        let p = [3.0, -2.0].map(Dual::constant);
        let (k, m) = (50.0, 2.0);
        for order in 0..3 {
            for omega in [0.3, 5.0, 70.0] {
                let of = Beside { omega, stiffness: Dual::constant(k), inertia: Dual::constant(m), order };
                let (re, im) = Crosstalk.beside(&p, &of).expect("something");
                let iw = Complex::new(0.0, omega);
                let read = Complex::new(re.value, im.value) * iw.powu(order.into());
                let expected = Complex::new(3.0, -2.0) / k * 5f64.powi(order.into());
                assert!((read - expected).norm() < 1e-12 * expected.norm(), "{order} {omega}: {read} {expected}");
            }
        }
    }
}
