//! Rigs to look at the contact alone: held by a heavy arm, or read off the response of the arm.

use super::{at, steady};
use crate::effects;
use crate::model::{Model, Operation};
use crate::scenario;
use crate::solver::Status;
use crate::solver::cycle::Tolerance;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// The paper's rig with one effect; without, where the registry has none of that name.
pub fn with(name: &str, parameters: &[f64]) -> Model {
    let mut model = Model::new(&scenario::paper());
    model.effects.extend(effects::find(name).map(|effect| (effect, parameters.to_vec())));
    model
}

/// An arm so heavy and stiff that the contact does not change its harmonic motion, nor its natural frequencies.
pub fn hold(model: &mut Model, factor: f64) {
    model.rig.arm_mut().inertia *= factor;
    model.rig.arm_mut().torsional_stiffness *= factor;
    model.rig.arm_mut().torsional_damping *= factor;
    model.rig.arm_mut().spring_stiffness *= factor;
    model.rig.arm_mut().spring_damping *= factor;
}

/// K, stiffness of the arm without contact \[N m/rad\].
pub fn arm_stiffness(model: &Model) -> f64 {
    model.rig.arm().torsional_stiffness + 2.0 * model.rig.arm().spring_arm.powi(2) * model.rig.arm().spring_stiffness
}

/// Amplitude and phase of the contact point of the arm without contact at 60 Hz, roller at rest.
pub fn free_stroke(model: &Model) -> (f64, f64) {
    let state = steady(model, &Operation { load: 0.0, ..at(0.0, 60.0) }, Tolerance::default());
    (model.rig.lever() * state.amplitude, state.phase)
}

/// Complex dynamic stiffness of the contact \[N/m\] that turns the free arm into the arm of amplitude a:
/// b^2 Z = Gamma e^{i phi0}/a - (K - J w^2 + i w C). NaN where there is no steady state.
pub fn dynamic_stiffness(model: &Model, operation: &Operation, tolerance: Tolerance) -> Complex<f64> {
    let state = steady(model, operation, tolerance);
    if state.status != Status::Steady {
        return Complex::new(f64::NAN, f64::NAN);
    }
    let (rig, w) = (model.rig.arm(), TAU * operation.frequency);
    let torque = Complex::new(rig.spring_stiffness, rig.spring_damping * w) * rig.spring_arm * operation.drive;
    let damping = rig.torsional_damping + 2.0 * rig.spring_arm.powi(2) * rig.spring_damping;
    let arm = Complex::new(arm_stiffness(model) - rig.inertia * w * w, w * damping);
    (torque / Complex::from_polar(state.amplitude, state.phase) - arm) / rig.contact_arm.powi(2)
}

/// Relative distance in the complex plane.
pub fn distance(computed: Complex<f64>, expected: Complex<f64>) -> f64 {
    (computed - expected).norm() / expected.norm()
}
