//! Orders of convergence of the three methods.

use super::{Check, at, distance, steady, value};
use crate::model::Model;
use crate::model::contact::Problem;
use crate::scenario::{self, Formulation};
use crate::solver::cycle::Tolerance;
use crate::solver::time::{Plan, integrate};
use crate::solver::{SteadyState, Warm, solve};

/// Euler procedure, order one, and time integration by the trapezoidal rule, order two.
pub fn slow_methods() -> Vec<Check> {
    vec![euler(), time_integration()]
}

/// Order from errors at steps that halve.
fn order(errors: &[f64]) -> f64 {
    match errors {
        [first, .., last] => (first / last).log2() / (errors.len() - 1) as f64,
        _ => f64::NAN,
    }
}

fn euler() -> Check {
    let mut model = Model::new(&scenario::paper());
    model.contact.formulation = Formulation::Paper;
    let solved =
        |steps| solve(&model, &at(1e-4, 74.0), steps, &Tolerance::default(), false, &mut Warm::default()).state;
    let states = [4000, 8000, 16000].map(solved);
    let changes = [distance(&states[0], &states[1]), distance(&states[1], &states[2])];
    let how = "change of alpha e^{i phi} in partial stick from 4000 to 8000 and to 16000 steps a cycle; the rule is of order 1";
    value("Order of the Euler procedure", how, "1", 1.0, order(&changes), 0.05)
}

fn time_integration() -> Check {
    let model = Model::new(&scenario::paper());
    let at = at(5e-5, 74.0);
    let fine = steady(&model, &at, Tolerance::default());
    let problem = Problem::new(&model, &at);
    let (re, im) = problem.free();
    let errors = [250, 500, 1000].map(|steps| {
        let found = integrate(&problem.sliders(), &Plan { steps, settled: 1e-11, ..Plan::default() });
        let (re, im) = (re + found.fundamental.0, im + found.fundamental.1);
        distance(&SteadyState { amplitude: re.hypot(im), phase: im.atan2(re), ..fine.clone() }, &fine)
    });
    let how =
        "error of alpha e^{i phi} in partial stick at 250 to 1000 steps a cycle; the trapezoidal rule is of order 2";
    value("Order of the time integration", how, "1", 2.0, order(&errors), 0.05)
}

/// Shooting on Radau IIA with three stages, order five (Hairer and Wanner, Solving Ordinary Differential Equations II),
/// where no event is stepped over.
pub fn shooting() -> Vec<Check> {
    let model = Model::new(&scenario::paper());
    let solved =
        |steps| steady(&model, &at(5e-5, 74.0), Tolerance { steps, roughness: f64::INFINITY, ..Tolerance::default() });
    let fine = solved(400);
    let errors = [10, 20, 40].map(|n| distance(&solved(n), &fine));
    let how = "error of alpha e^{i phi} through the events at 10 to 40 steps a cycle; Radau IIA of three stages is of order 5";
    vec![value("Order of shooting", how, "1", 5.0, order(&errors), 0.1)]
}
