//! The published procedure for a model, and one period of a steady state in time.

use super::collocation::interpolate;
use super::cycle::{Record, Tolerance};
use super::paper_euler::{self, PaperContact};
use super::radau::State;
use super::{Orbit, SteadyState, shooting};
use crate::model::contact::Problem;
use crate::model::lumps::Lumps;
use crate::model::system::{HybridSystem, Mode};
use crate::model::{Model, Operation};
use crate::scenario::Formulation;

/// Several operating points of the published formulation by the published procedure, faster than one by one and the
/// same.
pub fn solve_paper(model: &Model, at: &[Operation], steps: usize) -> Vec<SteadyState> {
    let lumps: Vec<Lumps> = at.iter().map(|at| Lumps::new(model, at)).collect();
    let contacts: Vec<PaperContact> = lumps.iter().map(paper_contact).collect();
    let solved = contacts.chunks(paper_euler::LANES).flat_map(|lanes| paper_euler::solve(lanes, steps, |_, _, _| ()));
    let mut states: Vec<SteadyState> = solved.collect();
    for (state, lumps) in states.iter_mut().zip(&lumps) {
        (state.amplitude, state.phase) = lumps.polar_reading(state.amplitude, state.phase);
    }
    states
}

fn paper_contact(lumps: &Lumps) -> PaperContact {
    PaperContact {
        omega: lumps.omega,
        inertia: lumps.inertia.value,
        damping: lumps.damping.value,
        stiffness: lumps.stiffness.value,
        torque: (lumps.torque_re.value, lumps.torque_im.value),
        arm: lumps.arm.value,
        contact_stiffness: lumps.contact_stiffness.value,
        contact_damping: lumps.contact_damping.value,
        friction_force: lumps.friction.value * lumps.load.value,
        speed: lumps.speed.value,
    }
}

/// One period of the steady state at `samples` instants; empty where there is none, or where its bristles remember.
pub fn orbit(model: &Model, at: &Operation, euler_steps: usize, tolerance: &Tolerance, samples: usize) -> Orbit {
    if model.contact.formulation == Formulation::Paper {
        return paper_euler::orbit(&paper_contact(&Lumps::new(model, at)), euler_steps);
    }
    let problem = Problem::new(model, at);
    if problem.remembers() {
        return Orbit::default();
    }
    let Ok(periodic) = shooting::solve(&problem, None, tolerance) else { return Orbit::default() };
    let period = problem.period();
    let stretch_index = problem.stretch_index();
    let mut orbit = Orbit::default();
    let mut record = |r: &Record| {
        while orbit.time.len() < samples {
            let t = period * orbit.time.len() as f64 / samples as f64;
            if t >= r.time + r.size {
                break;
            }
            let tau = (t - r.time) / r.size;
            let z: State = std::array::from_fn(|j| interpolate(r.start[j], r.stepper.z.map(|z| z[j]), tau));
            let s = if r.mode == Mode::Stick { 0.0 } else { interpolate(r.slip, r.stepper.s, tau) };
            let forcing = problem.forcing(t);
            let (force, _) = problem.force(&forcing, &z, s);
            orbit.time.push(t);
            orbit.angle.push(forcing.angle + z[0]);
            orbit.velocity.push(forcing.velocity + z[1]);
            orbit.stretch.push(z[stretch_index]);
            orbit.slip_rate.push(s);
            orbit.force.push(force);
        }
    };
    match shooting::trace(&problem, &periodic, tolerance, &mut record) {
        Ok(()) => orbit,
        Err(_) => Orbit::default(),
    }
}
