//! What is read of a motion: the observables of a steady state, and their derivatives by the parameters of the model.

use super::{Method, Status, SteadyState};
use crate::dual::{Dual, MAX_PARAMETERS};
use crate::model::contact::{LimitingState, Problem};
use crate::model::lumps::Lumps;

/// Floquet multipliers above this count as unstable.
const UNSTABLE: f64 = 1.0 + 1e-6;

/// A steady state with what else the solver can tell of it.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The observables.
    pub state: SteadyState,
    /// Derivatives of (amplitude, phase) by the parameters of the model, in the order of
    /// [`crate::model::Model::parameter`]; where asked for.
    pub derivatives: Option<Vec<(f64, f64)>>,
    /// Readings (amplitude, phase) of the other stable states at the same point.
    pub others: Vec<(f64, f64)>,
    /// Whether it is no state but the end of a branch that is not reached ([`super::oscillator::fold::End`]).
    pub beyond: bool,
    /// Steps of integrations that it took; none where harmonics were balanced or a closed form holds.
    pub steps: usize,
}

/// Complex amplitude of the arm from that of its motion relative to the one without contact.
pub fn response(problem: &Problem, relative: (f64, f64)) -> (f64, f64) {
    let (re, im) = problem.free();
    (re + relative.0, im + relative.1)
}

/// Derivatives of (amplitude, phase) by the parameters of the model from those of the relative motion by the columns.
pub fn by_parameter(problem: &Problem, response: (f64, f64), columns: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let lumps = &problem.lumps;
    let (free_re, free_im): (Dual, Dual) = lumps.free_response();
    let gradients = problem.column_gradients();
    let mut by_parameter = vec![(0.0, 0.0); MAX_PARAMETERS];
    for (p, out) in by_parameter.iter_mut().enumerate() {
        let (mut dre, mut dim) = (free_re.gradient[p], free_im.gradient[p]);
        for ((cre, cim), lump) in columns.iter().zip(&gradients) {
            dre += cre * lump.gradient[p];
            dim += cim * lump.gradient[p];
        }
        *out = polar_derivative(lumps, response, (dre, dim), p);
    }
    by_parameter
}

/// What a solver found, before it is read.
pub struct Motion {
    /// Complex amplitude of the arm.
    pub response: (f64, f64),
    pub mean: f64,
    pub stick_fraction: f64,
    pub force: (f64, f64),
    pub cycles: usize,
    /// Relative change over the last cycle.
    pub change: f64,
}

impl Motion {
    /// The observables as the instrument shows them.
    pub fn observe(&self, lumps: &Lumps, status: Status, method: Method) -> SteadyState {
        let (re, im) = self.response;
        let (amplitude, phase) = lumps.reading((re, im));
        SteadyState {
            amplitude,
            phase,
            mean: self.mean,
            speed_amplitude: lumps.arm.value * lumps.omega * re.hypot(im),
            stick_fraction: self.stick_fraction,
            force_minimum: self.force.0,
            force_maximum: self.force.1,
            cycles: self.cycles,
            periodicity_error: self.change,
            status,
            method,
        }
    }
}

/// Whether a motion is steady, by its largest Floquet multiplier.
pub fn stability(multiplier: f64) -> Status {
    if multiplier <= UNSTABLE {
        return Status::Steady;
    }
    // No number: beyond all of them.
    let growth = if multiplier.is_nan() { "beyond all numbers in".into() } else { format!("{multiplier:.3} times") };
    Status::SelfExcited(format!("the periodic state is unstable: a disturbance grows {growth} a cycle"))
}

/// Derivatives of (amplitude, phase) of the reading from those of the complex amplitude.
pub fn polar_derivative(lumps: &Lumps, a: (f64, f64), da: (f64, f64), p: usize) -> (f64, f64) {
    let (mut a, mut da) = (a, da);
    if let Some((re, im)) = lumps.read_beside.as_deref() {
        a = (a.0 + re.value, a.1 + im.value);
        da = (da.0 + re.gradient[p], da.1 + im.gradient[p]);
    }
    let square = a.0 * a.0 + a.1 * a.1;
    if square == 0.0 {
        // A body that sticks does so at neighbouring parameters too.
        return (0.0, 0.0);
    }
    let amplitude = square.sqrt();
    let gain = lumps.amplitude_gain;
    (
        gain.value * (a.0 * da.0 + a.1 * da.1) / amplitude + gain.gradient[p] * amplitude,
        (a.0 * da.1 - a.1 * da.0) / square + lumps.phase_offset.gradient[p],
    )
}

/// The observables of a state that is known in closed form.
pub fn closed_form(lumps: &Lumps, limit: LimitingState, derivatives: bool) -> Solution {
    let LimitingState { response: a, stuck, mean, stick_fraction, force } = limit;
    let motion = Motion { response: a, mean, stick_fraction, force, cycles: 0, change: 0.0 };
    let state = motion.observe(lumps, Status::Steady, Method::Analytic);
    let derivatives = derivatives.then(|| {
        let (re, im): (Dual, Dual) = if stuck { lumps.stuck_response() } else { lumps.free_response() };
        (0..MAX_PARAMETERS).map(|p| polar_derivative(lumps, a, (re.gradient[p], im.gradient[p]), p)).collect()
    });
    Solution { state, derivatives, others: Vec::new(), beyond: false, steps: 0 }
}

/// No steady state, and why.
pub fn failed(why: String) -> Solution {
    let nan = f64::NAN;
    let state = SteadyState {
        amplitude: nan,
        phase: nan,
        mean: nan,
        speed_amplitude: nan,
        stick_fraction: nan,
        force_minimum: nan,
        force_maximum: nan,
        cycles: 0,
        periodicity_error: nan,
        status: Status::Failed(why),
        method: Method::Shooting,
    };
    Solution { state, derivatives: None, others: Vec::new(), beyond: false, steps: 0 }
}
