//! What the modes outside the measured band add to the reading.

use super::{Beside, Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::ANY;

/// Residual modes.
pub struct ResidualModes;

impl Effect for ResidualModes {
    fn name(&self) -> &'static str {
        "residual-modes"
    }
    fn title(&self) -> &'static str {
        "Residual of the modes outside the band"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "reading += (R_c + R_m/ω²) times the drive"
    }
    fn meaning(&self) -> &'static str {
        "Modes above the band follow the drive as springs (R_c), those below as masses (R_m): their share of the motion that is \
         read grows with the drive and hardly changes over the band. The drive is the torque or force on the body, that of \
         a moved base or spring included. The motion of the mode itself is unchanged."
    }
    fn source(&self) -> &'static str {
        "D. J. Ewins, Modal Testing (2000): residual terms of a receptance."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact, V = 0, partial stick and full slip: a constant complex share beside the resonance, the same at every \
         drive: an antiresonance appears on one side of the peak and the far wings do not fall to zero; at the peak hardly \
         anything changes."
    }
    fn impersonator(&self) -> &'static str {
        "in a narrow band either term for the other; a second mode near the band is not constant over it"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }, Zero { parameter: 1, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("R_c", "R_c", "rad/(N m)"),
                ANY,
                (1e-5, 1e-2),
                "compliance of the modes above the band",
            )
            .in_units_of(Measure::Compliance)
            .either_sign(),
            ParameterInfo::searched(
                ("R_m", "R_m", "rad/(N m s^2)"),
                ANY,
                (2.0, 2e3),
                "one over the inertia of the modes below the band",
            )
            .in_units_of(Measure::InverseMass)
            .either_sign(),
        ];
        LIST
    }

    fn beside(&self, p: &[Dual], of: &Beside) -> Option<(Dual, Dual)> {
        Some((p[0] + p[1] * (1.0 / (of.omega * of.omega)), Dual::constant(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_the_masses_falls_with_the_square_of_the_frequency() {
        let p = [2e-4, 50.0].map(Dual::constant);
        let one = Dual::constant(1.0);
        let of = |omega| Beside { omega, stiffness: one, inertia: one, order: 0 };
        let share = |omega: f64| ResidualModes.beside(&p, &of(omega)).map_or(f64::NAN, |share| share.0.value);
        assert!((share(100.0) - 5.2e-3).abs() < 1e-15 && (share(1000.0) - 2.5e-4).abs() < 1e-15);
    }
}
