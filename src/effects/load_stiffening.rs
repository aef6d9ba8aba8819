//! Bristles that stiffen with the load that presses them.

use super::{Effect, Group, Measure, ParameterInfo, Zero};
use crate::dual::Dual;
use crate::parameter::POSITIVE;

/// A contact whose stiffness grows with a power of the load.
pub struct LoadStiffening;

impl Effect for LoadStiffening {
    fn name(&self) -> &'static str {
        "load-stiffening"
    }
    fn title(&self) -> &'static str {
        "Stiffness that grows with the load"
    }
    fn group(&self) -> Group {
        Group::Contact
    }
    fn equation(&self) -> &'static str {
        "kc → kc(W/Nᵣ)ᵐ, cc → cc(W/Nᵣ)ᵐ"
    }
    fn meaning(&self) -> &'static str {
        "A larger load spreads the contact, and more of it is sheared: m = 1/3 between a sphere and a plane, up to 1 between \
         rough surfaces. kc and cc are those at the load Nᵣ. A search keeps Nᵣ at the median load of the data."
    }
    fn source(&self) -> &'static str {
        "H. Hertz, Über die Berührung fester elastischer Körper (1881); R. D. Mindlin, Compliance of elastic bodies in \
         contact, J. Appl. Mech. 16 (1949) 259."
    }
    fn fingerprint(&self) -> &'static str {
        "V = 0 and partial stick: curves of a load above Nᵣ lie further right, those of a load below further left, \
         each as with a stiffness of its own. Full slip: nothing."
    }
    fn impersonator(&self) -> &'static str {
        "at one load, another stiffness of the contact: it takes two loads, at least one speed slow enough to stick"
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("m", "m", "1"), (0.0, 3.0), (0.03, 1.0), "exponent of the load"),
            ParameterInfo::searched(("N_ref", "Nᵣ", "N"), POSITIVE, (1.0, 100.0), "load at which kc and cc are stated")
                .in_units_of(Measure::Load)
                .held(),
        ];
        LIST
    }

    fn contact_factor(&self, p: &[Dual], load: Dual) -> Option<Dual> {
        Some((load / p[1]).powd(p[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_times_the_load_makes_a_sphere_twice_as_stiff() {
        let p = [1.0 / 3.0, 5.0].map(Dual::constant);
        let factor = |load: f64| LoadStiffening.contact_factor(&p, Dual::constant(load)).map_or(f64::NAN, |f| f.value);
        assert!((factor(40.0) - 2.0).abs() < 1e-15 && (factor(5.0) - 1.0).abs() < 1e-15);
    }
}
