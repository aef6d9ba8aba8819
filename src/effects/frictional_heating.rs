//! The interface heats up by its own friction and weakens.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;

use crate::parameter::POSITIVE;

/// Frictional heating.
pub struct FrictionalHeating;

impl Effect for FrictionalHeating {
    fn name(&self) -> &'static str {
        "frictional-heating"
    }
    fn title(&self) -> &'static str {
        "Frictional heating"
    }
    fn group(&self) -> Group {
        Group::Interface
    }
    fn equation(&self) -> &'static str {
        "μ → μ/(1 + T), τT′ = Fs/P₀ − T"
    }
    fn meaning(&self) -> &'static str {
        "The power spent at the interface raises its temperature, which relaxes by conduction over a time τ and \
         lowers friction. T is the rise in units of that which halves the coefficient; P₀ is the power that \
         sustains T = 1."
    }
    fn source(&self) -> &'static str {
        "Flash temperature: H. Blok (1937) and J. C. Jaeger, Moving sources of heat and the temperature at \
         sliding contacts, Proc. R. Soc. N.S.W. 76 (1942) 203; for rubber: B. N. J. Persson, Rubber friction: \
         role of the flash temperature, J. Phys.: Condens. Matter 18 (2006) 7789. First-order form: \
         specification."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0: invisible unless the load is low enough for slip, and even then weak, since little power is \
         spent. Partial stick: weak at small V for the same reason. Full slip: grows with W V/P₀: weakening that \
         lags by τ, a taller and slightly shifted peak or self-excitation, and a mean angle that falls with \
         speed."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: f64::INFINITY }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(
                ("P_0", "P₀", "W"),
                POSITIVE,
                (0.1, 1e3),
                "power that halves the friction coefficient",
            )
            .in_units_of(Measure::Power),
            ParameterInfo::searched(("tau", "τ", "s"), POSITIVE, (1e-4, 1.0), "time over which the heat leaves")
                .in_units_of(Measure::Time),
        ];
        LIST
    }

    fn heating(&self, p: &[Dual]) -> Option<(Dual, Dual)> {
        Some((p[0], p[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_scale_and_the_time_are_handed_on() {
        let p = [Dual::constant(10.0), Dual::constant(3e-3)];
        let (power, tau) = FrictionalHeating.heating(&p).expect("heats");
        assert_eq!((power.value, tau.value), (10.0, 3e-3));
        assert_eq!(FrictionalHeating.zero(), [Zero { parameter: 0, value: f64::INFINITY }]);
    }
}
