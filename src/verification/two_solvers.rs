//! The periodic solver against plain time integration, over the points of a report.

use super::{Check, largest};
use crate::model::alone::Alone;
use crate::model::contact::Problem;
use crate::model::system::SingleMode;
use crate::model::{Model, Operation};
use crate::scenario::{Formulation, Scenario};
use crate::solver::time::Plan;
use crate::solver::{Method, Status, SteadyState, integrated, plan_for};
use crate::statistics::wrap;
use crate::sweep::{Curve, Outcome, at_condition};
use crate::units;
use rayon::prelude::*;

/// Most points compared of one scenario.
const POINTS: usize = 6;
/// Error of the time integration at these steps is of the order of 1e-6.
const PLAN: Plan = Plan { steps: 4000, cycles: 400, settled: 1e-8, window: 1, solved: Plan::SOLVED };

/// A point solved both ways.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Compared {
    /// Which point.
    place: String,
    /// Whether it is one of the paper's kind of rig.
    of_arm: bool,
    /// Whether its contact, or a joint, is a continuum of sliders.
    continuum: bool,
    /// Relative difference in amplitude or difference in phase \[rad\], whichever is larger; `None` where the time
    /// integration did not settle.
    difference: Option<f64>,
}

/// A sample of the points of a scenario, each solved both ways.
pub fn solved_twice(outcome: &Outcome) -> Vec<Compared> {
    sample(outcome).par_iter().map(|&(c, f)| compare(outcome, c, f)).collect()
}

/// The numerical part of the error budget: the largest difference of the two solvers over a sample of the points of all
/// scenarios, a check for contacts of one slider and one for those of a continuum, each where there are such points.
/// The time integration shares only the statement of the laws with the periodic solver.
pub fn numerical_error(compared: Vec<Compared>) -> Vec<Check> {
    let (continua, single): (Vec<_>, Vec<_>) = compared.into_iter().partition(|point| point.continuum);
    // The fixed steps of the time integration do not stop at the events of the many sliders of a continuum.
    let checks = [("Two solvers", single, 1e-5), ("Two solvers, continua of sliders", continua, 1e-4)];
    checks.into_iter().filter_map(|(name, points, tolerance)| check(name, &points, tolerance)).collect()
}

fn check(name: &str, points: &[Compared], tolerance: f64) -> Option<Check> {
    let settled = points.iter().filter_map(|point| Some((point.difference?, &point.place)));
    // NaN, which never holds, is the largest of all.
    let (_, place) = settled.clone().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    let count = settled.clone().count();
    let of_arm = points.iter().all(|point| point.of_arm);
    let (what, steps) = match of_arm {
        true => ("alpha and phi", PLAN.steps.to_string()),
        false => ("amplitude and phase", "many".into()),
    };
    let unsettled = match points.len() - count {
        0 => String::new(),
        n if of_arm => format!("; {n} more did not settle in {} cycles of it", PLAN.cycles),
        n => format!("; {n} more ring too long for it"),
    };
    let compares = format!(
        "periodic solver against time integration in {steps} steps a cycle, {what} at {count} points, up to {POINTS} \
         of each scenario{unsettled}; the largest difference is at {place}"
    );
    Some(largest(name, &compares, settled.map(|(difference, _)| difference), tolerance))
}

/// Indices (curve, frequency) of points spread over the steady states of the periodic solver, those left out that have
/// another branch on which the time integration may end.
fn sample(outcome: &Outcome) -> Vec<(usize, usize)> {
    let alone = outcome.scenario.contact.is_none();
    let branches = |curve: &Curve, f: usize| matches!(curve.down.get(f), Some(Some(_)));
    let of_solver = |state: &SteadyState| state.status == Status::Steady && state.method != Method::TimeIntegration;
    let curves = outcome.curves.iter().enumerate().filter(|(_, curve)| {
        curve.condition.formulation == Formulation::Series && (curve.condition.load > 0.0 || alone)
    });
    let points: Vec<(usize, usize)> = curves
        .flat_map(|(c, curve)| {
            (0..curve.states.len()).filter(|&f| of_solver(&curve.states[f]) && !branches(curve, f)).map(move |f| (c, f))
        })
        .collect();
    // One in each of as many equal parts, at shares of the part that do not repeat, so that curves of one length are
    // not always met at the same frequencies.
    let count = points.len().min(POINTS);
    let share = |i: usize| (i as f64 + (0.5 + 0.618 * i as f64).fract()) / count as f64;
    let mut sample: Vec<_> = (0..count).map(|i| points[(share(i) * points.len() as f64) as usize]).collect();
    sample.dedup();
    sample
}

fn compare(outcome: &Outcome, c: usize, f: usize) -> Compared {
    let curve = &outcome.curves[c];
    let (condition, frequency, state) = (&curve.condition, curve.frequency[f], &curve.states[f]);
    let at = Operation { speed: condition.speed, load: condition.load, drive: condition.drive, frequency, series: 0 };
    let model = at_condition(&Model::new(&outcome.scenario), condition);
    let found = integrated(&model, &at, &plan_for(&model, &at, &PLAN));
    let amplitude = found.amplitude / state.amplitude - 1.0;
    let phase = wrap(found.phase - state.phase);
    let difference = if amplitude.is_nan() { amplitude } else { amplitude.abs().max(phase.abs()) };
    Compared {
        place: place(outcome, &at, condition.friction),
        of_arm: outcome.scenario.rig.is_arm(),
        continuum: match model.has_contact {
            true => Problem::new(&model, &at).continuum().is_some(),
            false => Alone::new(&model, &at).joint().is_some(),
        },
        difference: found.periodic.then_some(difference),
    }
}

/// Where a point is, in words.
fn place(outcome: &Outcome, at: &Operation, friction: f64) -> String {
    let Scenario { id, signals, contact, .. } = &outcome.scenario;
    let f = at.frequency;
    if signals.of_arm() {
        return format!(
            "{id}, V = {:.4} mm/s, W = {} N, u0 = {:.3} µm, mu = {friction}, f = {f:.2} Hz",
            at.speed * 1e3,
            at.load,
            at.drive * 1e6,
        );
    }
    let rubbed = match contact {
        Some(_) => format!("V = {}, W = {} N, mu = {friction}, ", units::format(at.speed, "m/s"), at.load),
        None => String::new(),
    };
    let drive = units::format(at.drive, signals.drive.unit);
    format!("{id}, {rubbed}{} = {drive}, f = {}", signals.drive.symbol, units::format(f, "Hz"))
}
