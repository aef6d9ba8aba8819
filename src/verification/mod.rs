//! Numbers that prove the solvers in every run: closed forms of the literature, exact invariants, one method against
//! the other.

mod bench;
mod convergence;
mod energy;
mod linear;
mod literature;
mod two_solvers;

pub use energy::energy_balance;
pub use two_solvers::{Compared, numerical_error, solved_twice};

use crate::model::contact::Problem;
use crate::model::{Model, Operation};
use crate::scenario::DEFAULT_EULER_STEPS;
use crate::scenario::{self, Formulation};
use crate::solver::cycle::Tolerance;
use crate::solver::{SteadyState, Warm, shooting, solve};
use crate::sweep::{LimitingCase, limiting_oscillator};
use rayon::prelude::*;

/// A comparison with its bound.
#[derive(Debug, Clone)]
pub struct Check {
    /// Name.
    pub name: String,
    /// What is compared with what.
    pub compares: String,
    /// SI unit of the values.
    pub unit: &'static str,
    /// Value known from elsewhere, where the check is of one value.
    pub expected: Option<f64>,
    /// Value computed in this run.
    pub computed: Option<f64>,
    /// Relative difference.
    pub difference: f64,
    /// Largest relative difference allowed.
    pub tolerance: f64,
}

impl Check {
    /// Whether the difference is within the tolerance; NaN never is.
    pub fn holds(&self) -> bool {
        self.difference <= self.tolerance
    }
}

/// Runs all checks, on all threads and in a fixed order.
pub fn run() -> Vec<Check> {
    let groups: [fn() -> Vec<Check>; 14] = [
        limits_and_invariants,
        literature::den_hartog,
        literature::jenkins,
        literature::masing,
        literature::mindlin,
        literature::duffing,
        linear::maxwell_branch,
        linear::rate_strengthening,
        linear::rate_and_state,
        linear::lugre,
        linear::critical_stiffness,
        convergence::slow_methods,
        convergence::shooting,
        energy::every_effect,
    ];
    groups.par_iter().flat_map(|group| group()).collect()
}

/// The paper's rig: limiting cases, exact properties, the two formulations.
fn limits_and_invariants() -> Vec<Check> {
    let model = Model::new(&scenario::paper());
    let mut checks = peaks(&model);
    checks.extend([
        shooting_against_closed_forms(&model),
        independence_of_friction(&model),
        scaling(&model),
        euler_against_shooting(&model),
        step_size(&model),
    ]);
    checks
}

/// A check of one value.
fn value(
    name: impl Into<String>,
    compares: &str,
    unit: &'static str,
    expected: f64,
    computed: f64,
    tolerance: f64,
) -> Check {
    let difference = (computed / expected - 1.0).abs();
    let (name, compares) = (name.into(), compares.into());
    Check { name, compares, unit, expected: Some(expected), computed: Some(computed), difference, tolerance }
}

/// A check of the largest of several differences; no difference at all is NaN, like a difference that is NaN.
fn largest(
    name: impl Into<String>,
    compares: &str,
    differences: impl IntoIterator<Item = f64>,
    tolerance: f64,
) -> Check {
    let worse = |m: f64, d: f64| if m.is_nan() || d.is_nan() { f64::NAN } else { m.max(d) };
    let difference = differences.into_iter().reduce(worse).unwrap_or(f64::NAN);
    let (name, compares) = (name.into(), compares.into());
    Check { name, compares, unit: "1", expected: None, computed: None, difference, tolerance }
}

/// Peaks of the limiting cases against the numbers of an independent program (given to five digits).
fn peaks(model: &Model) -> Vec<Check> {
    let free = limiting_oscillator(model, LimitingCase::FreeOrFullSlip, 2.5e-6);
    let stuck = limiting_oscillator(model, LimitingCase::StaticContact, 2.5e-6);
    let b = model.rig.lever();
    let how = "closed form against an independent program (five digits)";
    vec![
        value("Peak frequency, case I/III", how, "Hz", 71.194, free.peak(50.0, 100.0, 0).0, 2e-5),
        value("Peak amplitude, case I/III", how, "rad", 6.2401e-6, free.peak(50.0, 100.0, 0).1, 2e-5),
        value("Speed at which sticking starts", how, "m/s", 0.16833e-3, b * free.peak(50.0, 100.0, 1).1, 3e-5),
        value("Peak frequency, case II", how, "Hz", 81.569, stuck.peak(50.0, 100.0, 0).0, 2e-5),
        value("Peak amplitude, case II", how, "rad", 4.5814e-6, stuck.peak(50.0, 100.0, 0).1, 2e-5),
    ]
}

fn at(speed: f64, frequency: f64) -> Operation {
    Operation { speed, load: 20.0, drive: 2.5e-6, frequency, series: 0 }
}

fn steady(model: &Model, at: &Operation, tolerance: Tolerance) -> SteadyState {
    solve(model, at, DEFAULT_EULER_STEPS, &tolerance, false, &mut Warm::default()).state
}

fn distance(a: &SteadyState, b: &SteadyState) -> f64 {
    let z = |s: &SteadyState| (s.amplitude * s.phase.cos(), s.amplitude * s.phase.sin());
    let (x, y) = (z(a), z(b));
    (x.0 - y.0).hypot(x.1 - y.1) / b.amplitude
}

const POINTS: [(f64, f64); 6] = [(5e-5, 66.0), (5e-5, 74.0), (5e-5, 80.0), (1e-4, 70.0), (1e-4, 74.0), (2e-5, 78.0)];

fn shooting_against_closed_forms(model: &Model) -> Check {
    let cases = [(0.02, LimitingCase::FreeOrFullSlip), (0.0, LimitingCase::StaticContact)];
    let points = cases.iter().flat_map(|&c| [60.0, 71.0, 82.0].map(|f| (c, f)));
    let differences = points.map(|((speed, case), f)| {
        let problem = Problem::new(model, &at(speed, f));
        let Ok(found) = shooting::solve(&problem, None, &Tolerance::default()) else { return f64::NAN };
        let (re, im) = problem.free();
        let (re, im) = (re + found.cycle.fundamental.0, im + found.cycle.fundamental.1);
        let (alpha, phi) = limiting_oscillator(model, case, 2.5e-6).response(f);
        (re - alpha * phi.cos()).hypot(im - alpha * phi.sin()) / alpha
    });
    largest("Limiting cases by shooting", "cases II and III: shooting solver against closed form", differences, 1e-6)
}

fn independence_of_friction(model: &Model) -> Check {
    let differences = POINTS.iter().map(|&(v, f)| {
        let mut other = model.clone();
        other.contact.friction *= 1.7;
        distance(&steady(&other, &at(v, f), Tolerance::default()), &steady(model, &at(v, f), Tolerance::default()))
    });
    let how = "exact property while F > -mu W: mu times 1.7 changes nothing";
    largest("Independence of friction", how, differences, 1e-9)
}

fn scaling(model: &Model) -> Check {
    let differences = POINTS.iter().map(|&(v, f)| {
        let mut scaled = steady(model, &Operation { drive: 7.5e-6, ..at(3.0 * v, f) }, Tolerance::default());
        scaled.amplitude /= 3.0;
        distance(&scaled, &steady(model, &at(v, f), Tolerance::default()))
    });
    largest(
        "Collapse on V/u0",
        "exact property: V and u0 times 3 give 3 times alpha, the same phase",
        differences,
        1e-9,
    )
}

fn euler_against_shooting(model: &Model) -> Check {
    let mut paper = model.clone();
    paper.contact.formulation = Formulation::Paper;
    let differences = POINTS.iter().map(|&(v, f)| {
        let paper = steady(&paper, &at(v, f), Tolerance::default());
        (paper.amplitude / steady(model, &at(v, f), Tolerance::default()).amplitude - 1.0).abs()
    });
    let how = "paper formulation (Euler procedure) against series formulation (shooting): a difference of the models";
    largest("Paper against series formulation", how, differences, 6e-3)
}

fn step_size(model: &Model) -> Check {
    let fine = Tolerance { steps: 400, roughness: 1e-5, ..Tolerance::default() };
    let differences = POINTS
        .iter()
        .map(|&(v, f)| distance(&steady(model, &at(v, f), Tolerance::default()), &steady(model, &at(v, f), fine)));
    let how = "shooting at the default tolerance against 12 times finer steps";
    largest("Discretisation error of shooting", how, differences, 1e-6)
}
