//! A rig without a contact, or at a load of zero: one mode with the torques of the effects and slip elements to ground.

use super::lumps::Lumps;
use super::system::{A_FORCE, A_POWER, SingleMode};
use super::{Model, Operation};
use crate::dual::Dual;
use crate::effects::Effect;
use crate::effects::formula::Formula;
use crate::parameter::FIRST_EFFECT_PARAMETER;
use std::cell::Cell;

/// An effect with a torque, its parameters and the column of their first.
type Law = (&'static dyn Effect, Vec<f64>, usize);

/// The mode at one operating point.
pub struct Alone {
    /// The coefficients with their gradients.
    pub lumps: Lumps,
    laws: Vec<Law>,
    columns: usize,
    /// Multiplications that a force takes.
    force_cost: usize,
    /// Multiplications that were done on it.
    pub spent: Cell<usize>,
    /// Multiplications after which its motion is given up.
    pub patience: usize,
}

impl Alone {
    /// The mode of `model` at an operating point, whatever its contact would do.
    pub fn new(model: &Model, at: &Operation) -> Self {
        let mut laws: Vec<Law> = Vec::new();
        let mut first = 0;
        for (effect, p) in &model.effects {
            if effect.torque(p, 0.0, 0.0).is_some() {
                laws.push((*effect, p.clone(), first));
            }
            first += p.len();
        }
        let powers = laws.iter().filter(|(effect, p, _)| effect.torque_is_rough(p) || effect.torque_is_steep(p));
        let force_cost = A_FORCE + A_POWER * powers.count();
        let (lumps, spent) = (Lumps::new(model, at), Cell::new(0));
        Self { lumps, laws, columns: first, force_cost, spent, patience: usize::MAX }
    }

    /// Whether the mode is linear, so that its motion is known in closed form.
    pub fn is_linear(&self) -> bool {
        self.laws.is_empty() && self.lumps.joint.is_none() && self.lumps.dry_friction.is_none()
    }

    /// Gradients of what the derivatives of a solution are known by: M, C, K, the drive (real, imaginary), the three
    /// numbers of the joint and dry friction.
    pub fn gradients(&self) -> [Dual; 9] {
        let Lumps { inertia, damping, stiffness, torque_re, torque_im, ref joint, ref dry_friction, .. } = self.lumps;
        let none = Dual::constant(0.0);
        let [k, force, exponent] = joint.as_deref().copied().unwrap_or([none; 3]);
        let dry = dry_friction.as_deref().copied().unwrap_or(none);
        [inertia, damping, stiffness, torque_re, torque_im, k, force, exponent, dry]
    }

    /// Index among the parameters of the model of column number `column`.
    pub fn parameter(column: usize) -> usize {
        FIRST_EFFECT_PARAMETER + column
    }
}

impl SingleMode for Alone {
    fn spend(&self, multiplications: usize) {
        self.spent.set(self.spent.get() + multiplications);
    }

    fn is_given_up(&self) -> bool {
        self.spent.get() > self.patience
    }
    fn force_cost(&self) -> usize {
        self.force_cost
    }
    fn linear(&self) -> [f64; 3] {
        [self.lumps.inertia.value, self.lumps.damping.value, self.lumps.stiffness.value]
    }
    fn drive(&self) -> (f64, f64) {
        (self.lumps.torque_re.value, self.lumps.torque_im.value)
    }
    fn omega(&self) -> f64 {
        self.lumps.omega
    }
    fn force(&self, x: f64, v: f64) -> [f64; 3] {
        let laws = self.laws.iter().filter_map(|(effect, p, _)| effect.torque(p, x, v));
        laws.fold([0.0; 3], |sum, law| [sum[0] + law.value, sum[1] + law.d_first, sum[2] + law.d_second])
    }
    fn is_odd(&self, amplitude: f64) -> bool {
        let odd = |(effect, p, _): &Law| {
            // What a formula seemed to be where it was looked at it need not be elsewhere.
            let force = |x, v| effect.torque(p, x, v).map_or(0.0, |law| law.value);
            let v = 0.7 * amplitude * self.lumps.omega;
            let opposite = |share: f64| force(share * amplitude, v) == -force(-share * amplitude, -v);
            effect.torque_is_odd() && (effect.formula().is_none() || [0.3, 0.9].into_iter().all(opposite))
        };
        self.laws.iter().all(odd)
    }
    fn has_corners(&self) -> bool {
        // The kinks of the catalogue at rest have continuous slopes.
        let corner = |effect: &dyn Effect| effect.formula().is_some_and(Formula::has_corner_at_rest);
        self.laws.iter().any(|(effect, p, _)| !effect.is_smooth() || effect.torque_is_rough(p) || corner(*effect))
    }
    fn joint(&self) -> Option<[f64; 3]> {
        self.lumps.joint.as_deref().map(|joint| joint.each_ref().map(|dual| dual.value))
    }
    fn dry_friction(&self) -> f64 {
        self.lumps.dry_friction.as_deref().map_or(0.0, |friction| friction.value)
    }
    fn is_steep(&self) -> bool {
        self.laws.iter().any(|(effect, p, _)| effect.torque_is_steep(p))
    }
    fn add_columns(&self, x: f64, v: f64, weight: f64, sums: &mut [f64]) {
        for (effect, p, first) in &self.laws {
            let Some(law) = effect.torque(p, x, v) else { continue };
            for (sum, by) in sums[*first..first + p.len()].iter_mut().zip(law.d_parameters) {
                *sum += weight * by;
            }
        }
    }
    fn columns(&self) -> usize {
        self.columns
    }
}
