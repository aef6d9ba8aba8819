//! Slip elements between the moving body and the ground: bolted joints, clamps, seals.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::{POSITIVE, ZERO_OR_MORE};

/// A joint that slips little by little.
pub struct FrictionJoint;

impl Effect for FrictionJoint {
    fn name(&self) -> &'static str {
        "friction-joint"
    }
    fn title(&self) -> &'static str {
        "Joint with microslip (Iwan)"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "force −F(x), on first loading F = Fₛ[1 − (1 − x/xₘ)ⁿ] up to xₘ = nFₛ/kₜ, then Masing's rules"
    }
    fn meaning(&self) -> &'static str {
        "Many elements in parallel, each a spring in series with a slider, hold the body to the ground: a bolted joint, a \
         clamp, a seal, a bearing. They stick at small motion and slip one after the other as it grows, all of them beyond \
         xₘ. With n = 1 there is one element (Jenkins), which sticks or slips as a whole."
    }
    fn source(&self) -> &'static str {
        "W. D. Iwan, A distributed-element model for hysteresis (1966); G. Masing (1926); T. K. Caughey (1960)."
    }
    fn fingerprint(&self) -> &'static str {
        "Without contact: at small motion a spring of stiffness kₜ; as the motion grows the resonance falls, by kₜ/2K at most, \
         and the damping passes through a maximum where the motion is about twice the one at which slip begins. Curves of \
         different drive differ in frequency and in relative height; at large motion they tend to those of the body alone."
    }
    fn contains(&self) -> &'static [&'static str] {
        &["pivot-friction"]
    }
    fn impersonator(&self) -> &'static str {
        "over a small range of amplitudes a softening spring with an amplitude-dependent damping looks the same; a wider range of \
         drives tells, since the joint's softening ends where it slips as a whole"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("k_t", "kₜ", "N m/rad"),
                ZERO_OR_MORE,
                (1.0, 1e4),
                "stiffness of the joint while it sticks",
            )
            .in_units_of(Measure::Stiffness)
            .alone(0.1, 1e4),
            ParameterInfo::searched(("F_s", "Fₛ", "N m"), POSITIVE, (1e-6, 1e-1), "force at which it slips as a whole")
                .in_units_of(Measure::Force)
                .alone(1e-3, 1e2),
            ParameterInfo::searched(("n", "n", "1"), (1.0, 20.0), (1.0, 8.0), "exponent of the force on first loading"),
        ];
        LIST
    }

    fn beside_contact(&self) -> bool {
        false
    }
    fn joint(&self, p: &[Dual]) -> Option<[Dual; 3]> {
        Some([p[0], p[1], p[2]])
    }
}
