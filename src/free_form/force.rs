//! The free force itself: a stiffness and a damping that a fit gives every reading, evaluated by the same solvers as
//! any effect.

use crate::dual::Dual;
use crate::effects::{Effect, Group, ParameterInfo, Zero};
use crate::model::Model;
use crate::parameter::FIRST_EFFECT_PARAMETER;

/// Force -(k + i w c) x on the coordinate. It is no effect of the catalogue: no scenario can name it.
pub struct FreeForce;

impl FreeForce {
    /// A model with the free force, at zero, and the index of its stiffness among the parameters; its damping follows.
    pub fn beside(model: &Model) -> (Model, usize) {
        let index = FIRST_EFFECT_PARAMETER + model.effects.iter().map(|(_, p)| p.len()).sum::<usize>();
        let mut model = model.clone();
        model.effects.push((&Self, vec![0.0, 0.0]));
        (model, index)
    }
}

impl Effect for FreeForce {
    fn name(&self) -> &'static str {
        "free-force"
    }
    fn title(&self) -> &'static str {
        "Free force"
    }
    fn group(&self) -> Group {
        Group::RigAndInstrument
    }
    fn equation(&self) -> &'static str {
        "torque −kθ − cθ′"
    }
    fn meaning(&self) -> &'static str {
        "What is missing, whatever law it follows: its first harmonic."
    }
    fn source(&self) -> &'static str {
        "Describing function of an unknown force."
    }
    fn fingerprint(&self) -> &'static str {
        "Any."
    }
    fn zero(&self) -> &'static [Zero] {
        &[Zero { parameter: 0, value: 0.0 }, Zero { parameter: 1, value: 0.0 }]
    }
    fn parameters(&self) -> &'static [ParameterInfo] {
        const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
        const LIST: &[ParameterInfo] = &[
            ParameterInfo::searched(("k", "k", "N m/rad"), ANY, ANY, "stiffness"),
            ParameterInfo::searched(("c", "c", "N m s/rad"), ANY, ANY, "damping"),
        ];
        LIST
    }

    fn stiffness(&self, p: &[Dual]) -> Option<Dual> {
        Some(p[0])
    }
    fn damping(&self, p: &[Dual], _k: Dual, _omega: f64) -> Option<Dual> {
        Some(p[1])
    }
}
