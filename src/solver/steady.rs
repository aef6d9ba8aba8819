//! From a model and an operating point to the observables of its steady state.

use super::balance::{self, Balance};
use super::cycle::{Integrator, Tolerance};
use super::observables::{Motion, Solution, by_parameter, closed_form, failed, polar_derivative, response, stability};
use super::orbit::solve_paper;
use super::shooting::{Periodic, Start, Unsolved};
use super::{Method, Status, SteadyState, oscillator, parallel, shooting, stopping, time};
use crate::dual::MAX_PARAMETERS;
use crate::model::alone::Alone;
use crate::model::contact::{LimitingState, Problem, Sliders};
use crate::model::system::{HybridSystem, Mode, SingleMode, SliderSystem};
use crate::model::{Model, Operation};
use crate::scenario::Formulation;
use crate::statistics::wrap;
use std::cell::Cell;

/// Distance of the starts of neighbouring motions, in units of the scales, from which on they may be on other branches.
const NEIGHBOUR: f64 = 0.3;
/// Multiplications on a mode alone ([`SingleMode::spend`]) that take as long as a step of an integration.
const WORK: usize = 2900;
/// Steps of sliders, in closed form each, that take as long as a step of an integration: one by itself counts as
/// `SHARED` and one, every further as one, and what its bristles remember as `REMEMBERED`.
const CLOSED: usize = 37;
/// As there.
const SHARED: usize = 2;
/// As there.
const REMEMBERED: usize = 8;
/// Steps of an integration, or the work of as many, after which a fit gives up a motion without a contact: a thousand
/// times what others take. What needs that much has none, or costs more than all others together.
const PATIENCE: usize = 7_000;
/// Factor between the speeds of one step on the way down from full slip.
const SLOWER: f64 = 0.8;
/// A motion this many times larger than without contact has no bound.
const RUNAWAY: f64 = 1e6;

/// Start for a neighbouring problem: the next point of a sweep, or the same point with other parameters.
#[derive(Debug, Clone, Default)]
pub struct Warm {
    orbit: Option<Start>,
    /// Whether the orbit passed from mode to mode.
    broken: bool,
    sliders: Option<parallel::Memory>,
    /// Complex amplitude of the last motion without a contact.
    alone: Option<(f64, f64)>,
    /// What was measured, amplitude and phase: of several steady states the nearest to it is taken.
    measured: Option<(f64, Option<f64>)>,
}

impl Warm {
    /// Forgets the orbit, so that the next solution does not depend on it; the states of a continuum of sliders are
    /// kept.
    pub fn forget_orbit(&mut self) {
        self.orbit = None;
        self.alone = None;
    }

    /// Of several steady states the one nearest to this reading is to be taken, amplitude and phase where there is one.
    pub fn expect(&mut self, amplitude: f64, phase: Option<f64>) {
        self.measured = Some((amplitude, phase));
    }

    /// The start for `system`. Kept relative to the deflection under the mean force, which a small change of stiffness,
    /// load or friction moves by more than the arm swings.
    fn start(&self, system: &dyn HybridSystem) -> Option<Start> {
        let reference = system.reference();
        self.orbit.map(|(z, entry)| (std::array::from_fn(|i| z[i] + reference[i]), entry))
    }

    fn keep(&mut self, system: &dyn HybridSystem, (z, entry): &Start, broken: bool) {
        let reference = system.reference();
        self.orbit = Some((std::array::from_fn(|i| z[i] - reference[i]), *entry));
        self.broken = broken;
    }

    /// Whether a motion in one mode, found without regard to the start, is what follows from it.
    fn leads_to(&self, system: &dyn HybridSystem, found: &Balance) -> bool {
        let Some((z, _)) = self.start(system) else { return true };
        let scales = system.scales();
        (0..system.states()).all(|i| (z[i] - found.start.0[i]).abs() < NEIGHBOUR * scales[i])
    }
}

/// Solves one operating point; `euler_steps` matters for [`Formulation::Paper`] only. `warm` is the start and is
/// updated.
pub fn solve(
    model: &Model,
    at: &Operation,
    euler_steps: usize,
    tolerance: &Tolerance,
    derivatives: bool,
    warm: &mut Warm,
) -> Solution {
    let with = Search { tolerance, derivatives, integrate: true, steps: Cell::new(0) };
    search(model, at, euler_steps, &with, warm)
}

/// The periodic state, marked where it is unstable; where none is found the point fails at once, without the time
/// integration by which [`solve`] averages either: a fit gains nothing from an average over a motion that is not
/// steady.
pub fn solve_steady(
    model: &Model,
    at: &Operation,
    tolerance: &Tolerance,
    derivatives: bool,
    warm: &mut Warm,
) -> Solution {
    search(model, at, 0, &Search { tolerance, derivatives, integrate: false, steps: Cell::new(0) }, warm)
}

/// How to look for a steady state.
struct Search<'a> {
    tolerance: &'a Tolerance,
    derivatives: bool,
    /// Whether to integrate in time where no periodic state was found.
    integrate: bool,
    /// Steps of integrations so far.
    steps: Cell<usize>,
}

impl Search<'_> {
    /// Whether an unstable state is replaced by what a time integration gives; it has derivatives only as it is.
    fn averages(&self) -> bool {
        self.integrate && !self.derivatives
    }
}

fn search(model: &Model, at: &Operation, euler_steps: usize, with: &Search<'_>, warm: &mut Warm) -> Solution {
    let found = unguarded(model, at, euler_steps, with, warm);
    let found = Solution { steps: with.steps.get(), ..found };
    let SteadyState { amplitude, phase, mean, speed_amplitude, stick_fraction, .. } = &found.state;
    let SteadyState { force_minimum, force_maximum, periodicity_error, status, .. } = &found.state;
    let numbers =
        [amplitude, phase, mean, speed_amplitude, stick_fraction, force_minimum, force_maximum, periodicity_error];
    match status {
        Status::Failed(_) => found,
        _ if numbers.iter().all(|number| number.is_finite()) => found,
        _ if amplitude.is_finite() && phase.is_finite() => failed("the motion is not one of finite numbers".into()),
        _ => failed("the motion has no bound: nothing damps it at this frequency".into()),
    }
}

fn unguarded(model: &Model, at: &Operation, euler_steps: usize, with: &Search<'_>, warm: &mut Warm) -> Solution {
    let &Search { tolerance, derivatives, .. } = with;
    if at.load == 0.0 {
        return alone(model, at, with, warm);
    }
    if model.contact.formulation == Formulation::Paper {
        let mut states = solve_paper(model, std::slice::from_ref(at), euler_steps);
        return Solution { state: states.remove(0), derivatives: None, others: Vec::new(), beyond: false, steps: 0 };
    }
    let problem = Problem::new(model, at);
    if let Some(limit) = problem.limiting_state() {
        return closed_form(&problem.lumps, limit, derivatives);
    }
    if let Some(continuum) = problem.continuum() {
        return parallel_state(model, at, &problem, &continuum, with, warm);
    }
    if problem.remembers() {
        return parallel_state(model, at, &problem, &problem.sliders(), with, warm);
    }
    if !(warm.orbit.is_some() && warm.broken)
        && let Some(balance) = balance::solve(&problem, tolerance, derivatives)
        && warm.leads_to(&problem, &balance)
    {
        return balanced(&problem, &balance, warm);
    }
    let mut integrator = Integrator::new(&problem, tolerance);
    integrator.keep = derivatives;
    let mut found = shooting::search(&mut integrator, warm.start(&problem).as_ref());
    with.steps.set(with.steps.get() + integrator.spent());
    // Of the points that a search over many models gives up, one in two hundred would be found in this way.
    if !tolerance.gives_up() {
        found = found.or_else(|why| from_full_slip(model, at, &problem, tolerance).ok_or(why));
    }
    match found {
        Ok(periodic) => shot(&problem, &mut integrator, periodic, with, warm),
        Err(why) => {
            warm.orbit = None;
            match (why, problem.locked_state()) {
                (Unsolved::Rests, Some(limit)) => closed_form(&problem.lumps, limit, derivatives),
                // Only a contact with a locked state is found to rest.
                (Unsolved::Rests, None) => without_periodic_state(&problem, "the contact comes to rest", with),
                (Unsolved::Failed(why), _) => without_periodic_state(&problem, &why, with),
            }
        }
    }
}

/// The solution where shooting has found a periodic state; an unstable one is averaged where that is wanted.
fn shot(
    problem: &Problem,
    integrator: &mut Integrator,
    periodic: Periodic,
    with: &Search<'_>,
    warm: &mut Warm,
) -> Solution {
    warm.keep(problem, &(periodic.start, periodic.entry), periodic.cycle.events > 0);
    let mut status = stability(periodic.multiplier);
    if let (Status::SelfExcited(why), true) = (&status, with.averages()) {
        return lock_in(problem, why);
    }
    let response = response(problem, periodic.cycle.fundamental);
    let columns = with.derivatives.then(|| shooting::column_derivatives(integrator, &periodic));
    let derivatives = match columns.transpose() {
        Ok(columns) => columns.map(|columns| by_parameter(problem, response, &columns)),
        Err(why) => {
            status = Status::Failed(why);
            None
        }
    };
    let motion = Motion {
        response,
        mean: periodic.cycle.mean,
        stick_fraction: periodic.cycle.stick_fraction,
        force: periodic.cycle.force,
        cycles: periodic.cycles,
        change: periodic.residual,
    };
    Solution {
        state: motion.observe(&problem.lumps, status, Method::Shooting),
        derivatives,
        others: Vec::new(),
        beyond: false,
        steps: 0,
    }
}

/// The solution where the motion stays in one mode.
fn balanced(problem: &Problem, found: &Balance, warm: &mut Warm) -> Solution {
    warm.keep(problem, &found.start, false);
    let response = response(problem, found.fundamental);
    let motion = Motion {
        response,
        mean: found.mean,
        stick_fraction: f64::from(u8::from(found.start.1.0 == Mode::Stick)),
        force: found.force,
        cycles: found.iterations,
        change: found.left,
    };
    let derivatives = found.columns.as_ref().map(|columns| by_parameter(problem, response, columns));
    Solution {
        state: motion.observe(&problem.lumps, Status::Steady, Method::HarmonicBalance),
        derivatives,
        others: Vec::new(),
        beyond: false,
        steps: 0,
    }
}

/// The periodic state reached by slowing the roller down from full slip, in steps that each start from the last.
fn from_full_slip(model: &Model, at: &Operation, problem: &Problem, tolerance: &Tolerance) -> Option<Periodic> {
    let (re, im) = problem.free();
    let arm_speed = problem.lumps.arm.value * problem.lumps.omega * re.hypot(im);
    let mut speed = 1.02 * arm_speed;
    // Slower than rounding of the arm's speed is a roller at rest.
    if at.speed <= f64::EPSILON * arm_speed || speed < at.speed {
        return None;
    }
    let mut last: Option<Periodic> = None;
    while speed > at.speed {
        speed = (SLOWER * speed).max(at.speed);
        let slower = Problem::new(model, &Operation { speed, ..*at });
        last = Some(shooting::solve(&slower, last.as_ref().map(|p| (p.start, p.entry)).as_ref(), tolerance).ok()?);
    }
    last
}

/// What there is where no periodic state was found: what a time integration settles in, or its lock-in average. Without
/// derivatives.
fn without_periodic_state(problem: &Problem, why: &str, with: &Search<'_>) -> Solution {
    if with.integrate { lock_in(problem, why) } else { failed(why.into()) }
}

/// Time integration from the first guess: settled motion is a steady state, any other is averaged as a lock-in
/// amplifier would over the window of the plan.
fn lock_in(problem: &Problem, why: &str) -> Solution {
    if problem.has_own_bristles() {
        return failed(format!("{why}; with a formula for the force of the bristles no other motion is looked for"));
    }
    let plan = if problem.continuum().is_some() { time::Plan::LOCK_IN_OF_SLIDERS } else { time::Plan::LOCK_IN };
    let found = time::integrate(&problem.sliders(), &plan);
    if found.given_up {
        return failed(format!("{why}; integrated in time it is given up after {} cycles", found.cycles));
    }
    let lumps = &problem.lumps;
    let (re, im) = response(problem, found.fundamental);
    let (amplitude, _) = lumps.reading((re, im));
    if !amplitude.is_finite() || amplitude > RUNAWAY * problem.free().0.hypot(problem.free().1) {
        return failed(format!("{why}; integrated in time the motion grows without bound"));
    }
    let status = if found.periodic {
        Status::Steady
    } else {
        let (window, after) = (plan.window, plan.cycles);
        Status::SelfExcited(format!("{why}; lock-in average over {window} cycles after {after} cycles"))
    };
    let motion = Motion {
        response: (re, im),
        mean: found.mean,
        stick_fraction: found.stick_fraction,
        force: found.force,
        cycles: found.cycles,
        change: found.change,
    };
    let state = motion.observe(lumps, status, Method::TimeIntegration);
    Solution { state, derivatives: None, others: Vec::new(), beyond: false, steps: 0 }
}

/// A contact of many parallel sliders, or of one whose bristles remember; its derivatives are differences of converged
/// solutions.
fn parallel_state(
    model: &Model,
    at: &Operation,
    problem: &Problem,
    sliders: &Sliders,
    with: &Search<'_>,
    warm: &mut Warm,
) -> Solution {
    let coarse = with.tolerance.steps < Tolerance::default().steps;
    let demand = match (coarse, sliders.elements().len()) {
        (true, 1) => &parallel::Demand::COARSE_SINGLE,
        (false, 1) => &parallel::Demand::SINGLE,
        (true, _) => &parallel::Demand::COARSE,
        (false, _) => &parallel::Demand::FINE,
    };
    // Searches over many models start from the last one; what is reported is looked for from the beginning.
    let mut none = None;
    let memory = if with.integrate { &mut none } else { &mut warm.sliders };
    let mut cycles = 0;
    let found = parallel::solve(sliders, demand, memory, &mut cycles);
    let remembered = if model.has_hysteresis() { REMEMBERED } else { 0 };
    let work = cycles * demand.steps * (SHARED + sliders.elements().len() + remembered);
    with.steps.set(with.steps.get() + work / CLOSED);
    let found = match found {
        Ok(found) => found,
        Err(why) => return without_periodic_state(problem, &why, with),
    };
    let status = stability(found.multiplier);
    if let (Status::SelfExcited(why), true) = (&status, with.averages()) {
        return lock_in(problem, why);
    }
    let lumps = &problem.lumps;
    let (re, im) = response(problem, found.fundamental);
    let motion = Motion {
        response: (re, im),
        mean: found.mean,
        stick_fraction: found.stick_fraction,
        force: found.force,
        cycles: found.cycles,
        change: found.residual,
    };
    let state = motion.observe(lumps, status, Method::Shooting);
    let derivatives = with.derivatives.then(|| differences(model, at));
    Solution { state, derivatives, others: Vec::new(), beyond: false, steps: 0 }
}

/// Central differences of (amplitude, phase) by every parameter of the model.
fn differences(model: &Model, at: &Operation) -> Vec<(f64, f64)> {
    let mut out = vec![(0.0, 0.0); MAX_PARAMETERS];
    for (index, out) in out.iter_mut().enumerate() {
        let solved = |sign: f64| {
            let (mut model, mut at) = (model.clone(), *at);
            let value = model.parameter(&mut at, index)?;
            let step = 1e-4 * if *value == 0.0 { 1.0 } else { value.abs() };
            *value += sign * step;
            let state = solve(&model, &at, 0, &Tolerance::default(), false, &mut Warm::default()).state;
            Some((step, state.amplitude, state.phase))
        };
        if let (Some(plus), Some(minus)) = (solved(1.0), solved(-1.0)) {
            let width = 2.0 * plus.0;
            *out = ((plus.1 - minus.1) / width, wrap(plus.2 - minus.2) / width);
        }
    }
    out
}

/// No contact: the closed form of case I, or the stable states of a mode that is not linear. Of several, the one
/// nearest to what was measured, else to the motion before, else the smallest. Where the end of a branch that is not
/// reached is nearer to what was measured, that is taken, as far off as it is.
fn alone(model: &Model, at: &Operation, with: &Search<'_>, warm: &mut Warm) -> Solution {
    let mut mode = Alone::new(model, at);
    if with.tolerance.gives_up() {
        mode.patience = WORK * PATIENCE;
    }
    let lumps = &mode.lumps;
    if mode.is_linear() {
        let response = lumps.free_response();
        let limit = LimitingState { response, stuck: false, mean: 0.0, stick_fraction: 0.0, force: (0.0, 0.0) };
        return closed_form(lumps, limit, with.derivatives);
    }
    // A force whose slope has no bound at rest is a jump to the integrator of what is reported, which knows no joint; a
    // fit balances harmonics.
    let steep = mode.is_steep() && mode.joint().is_none();
    let stops = mode.dry_friction() > 0.0 || (steep && !with.tolerance.gives_up());
    let (states, ends): (Vec<oscillator::Found>, Vec<f64>) = if stops {
        (stopping::states(&mode, with.tolerance, with.derivatives), Vec::new())
    } else {
        let (states, ends) = oscillator::states(&mode, with.tolerance);
        (states.iter().map(|state| state.found(lumps.omega)).collect(), ends)
    };
    let distance = |response: (f64, f64)| {
        let (re, im) = response;
        if let Some((amplitude, phase)) = warm.measured {
            let (read, turned) = lumps.reading((re, im));
            let apart = phase.map_or(0.0, |phase| wrap(turned - phase));
            return (read / amplitude).ln().hypot(apart);
        }
        warm.alone.map_or(0.0, |(x, y)| (re - x).hypot(im - y))
    };
    with.steps.set(with.steps.get() + mode.spent.get() / WORK);
    let distances: Vec<f64> = states.iter().map(|state| distance(state.response)).collect();
    let nearest = (0..states.len()).min_by(|&i, &j| distances[i].total_cmp(&distances[j]));
    let mut others: Vec<(f64, f64)> = states.iter().map(|state| lumps.reading(state.response)).collect();
    if let Some((amplitude, _)) = warm.measured {
        let bar = nearest.map_or(f64::INFINITY, |i| distances[i]);
        let near = |end: &&f64| (lumps.amplitude_gain.value * **end / amplitude).ln().abs() < bar;
        let ends = ends.iter().filter(near).filter_map(|end| oscillator::fold::end(&mode, *end, with.tolerance));
        let ends = ends.map(|end| (distance(end.found.response).hypot(end.lacks.max(0.0)), end));
        if let Some((_, end)) = ends.filter(|(d, _)| *d < bar).min_by(|a, b| a.0.total_cmp(&b.0)) {
            warm.alone = Some(end.found.response);
            return end_of_branch(&mode, &end, amplitude, others, with);
        }
    }
    let Some(chosen) = nearest else {
        warm.alone = None;
        return failed("no periodic motion was found".into());
    };
    others.remove(chosen);
    let found = &states[chosen];
    warm.alone = Some(found.response);
    let status = if found.rest == 1.0 { Status::Stuck } else { stability(found.multiplier) };
    let method = if stops { Method::Shooting } else { Method::HarmonicBalance };
    let state = motion_of(found).observe(lumps, status, method);
    let derivatives = with.derivatives.then(|| of_mode(&mode, found));
    Solution { state, derivatives, others, beyond: false, steps: 0 }
}

fn motion_of(found: &oscillator::Found) -> Motion {
    Motion {
        response: found.response,
        mean: found.mean,
        stick_fraction: found.rest,
        force: (0.0, 0.0),
        cycles: found.cycles,
        change: found.left,
    }
}

/// The end of a branch that is not reached, held against what was measured. A share by which the drive is off weighs as
/// much as the same share of the amplitude, which is what one makes of the other in a linear mode: the amplitude is
/// given as far from the measured one as both together are.
fn end_of_branch(
    mode: &Alone,
    end: &oscillator::fold::End,
    measured: f64,
    others: Vec<(f64, f64)>,
    with: &Search<'_>,
) -> Solution {
    let lumps = &mode.lumps;
    let mut state = motion_of(&end.found).observe(lumps, Status::Steady, Method::HarmonicBalance);
    let (off, lacks) = (state.amplitude - measured, measured * end.lacks.max(0.0));
    let apart = off.hypot(lacks).copysign(off);
    state.amplitude = measured + apart;
    let derivatives = with.derivatives.then(|| {
        let by_lacks =
            by_parameters(mode, |i| (end.by[i], 0.0), &end.by_law.iter().map(|by| (*by, 0.0)).collect::<Vec<_>>());
        let joined = |((amplitude, phase), (by_lacks, _)): ((f64, f64), (f64, f64))| {
            let both = (off * amplitude + lacks * measured * by_lacks) / apart;
            (if apart == 0.0 { amplitude } else { both }, phase)
        };
        of_mode(mode, &end.found).into_iter().zip(by_lacks).map(joined).collect()
    });
    Solution { state, derivatives, others, beyond: true, steps: 0 }
}

/// Derivatives of (amplitude, phase) of a motion without contact by the parameters of the model.
fn of_mode(mode: &Alone, found: &oscillator::Found) -> Vec<(f64, f64)> {
    let by = by_parameters(mode, |i| found.by[i], &found.by_law);
    by.into_iter().enumerate().map(|(p, by)| polar_derivative(&mode.lumps, found.response, by, p)).collect()
}

/// Derivatives of two numbers by the parameters of the model, from those by the numbers of the mode and of its laws.
fn by_parameters(mode: &Alone, by: impl Fn(usize) -> (f64, f64), by_law: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut all = vec![(0.0, 0.0); MAX_PARAMETERS];
    let gradients = mode.gradients();
    for (p, (first, second)) in all.iter_mut().enumerate() {
        for (number, dual) in gradients.iter().enumerate() {
            *first += by(number).0 * dual.gradient[p];
            *second += by(number).1 * dual.gradient[p];
        }
    }
    for (column, &(first, second)) in by_law.iter().enumerate() {
        let slot = &mut all[Alone::parameter(column)];
        *slot = (slot.0 + first, slot.1 + second);
    }
    all
}
