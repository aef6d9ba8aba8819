//! The exact flow of affine modes, and the searches that start from it: against the collocation method with fine steps,
//! differences, and themselves from other starts.

mod common;

use common::{at, complex, distance, paper_model, steady};
use stickslip::effects::{find, typical};
use stickslip::model::contact::Problem;
use stickslip::model::system::{HybridSystem, Mode};
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
use stickslip::solver::cycle::{Integrator, Tolerance};
use stickslip::solver::{Solution, Status, Warm, flow, solve};

/// Steps without exact flows: an infinite roughness asks for just these.
const FINE: Tolerance = Tolerance { steps: 600, roughness: f64::INFINITY, cycles: 250, budget: usize::MAX };

fn with(name: &str) -> Model {
    let mut model = paper_model(Series);
    if let Some(effect) = find(name) {
        model.effects.push((effect, typical(effect)));
    }
    model
}

fn cold(model: &Model, at: &Operation, tolerance: &Tolerance, derivatives: bool) -> Solution {
    solve(model, at, 0, tolerance, derivatives, &mut Warm::default())
}

/// Partial stick at two speeds, and a resting roller with slip both ways.
fn conditions(frequency: f64) -> [Operation; 3] {
    [
        at(5e-5, frequency),
        Operation { load: 10.0, ..at(1e-4, frequency) },
        Operation { speed: 0.0, load: 0.1, drive: 7.5e-6, frequency, series: 0 },
    ]
}

/// Under the lightest load the coupling would lift the contact off, which no affine mode describes.
fn stays_loaded(name: &str, operation: &Operation) -> bool {
    name != "normal-coupling" || operation.load > 1.0
}

#[test]
fn exact_flows_are_the_limit_of_fine_steps() {
    for name in ["none", "maxwell-branch", "contact-renewal", "normal-coupling", "roller-compliance", "actuator-lag"] {
        let model = with(name);
        for operation in conditions(74.0).into_iter().filter(|operation| stays_loaded(name, operation)) {
            let (exact, fine) = (steady(&model, &operation), cold(&model, &operation, &FINE, false).state);
            let what = format!("{name} {operation:?}");
            assert_eq!((&exact.status, &fine.status), (&Status::Steady, &Status::Steady), "{what}");
            assert!(distance(&exact, &fine) < 2e-9, "{what}: {:e}", distance(&exact, &fine));
            assert!((exact.mean - fine.mean).abs() < 1e-8 * fine.amplitude + 1e-9 * fine.mean.abs(), "{what}: mean");
            assert!((exact.stick_fraction - fine.stick_fraction).abs() < 1e-8, "{what}: stick");
            let swing = (fine.force_maximum - fine.force_minimum).max(1e-3);
            assert!((exact.force_minimum - fine.force_minimum).abs() < 1e-4 * swing, "{what}: {exact:?} {fine:?}");
        }
    }
}

#[test]
fn a_cycle_on_exact_flows_has_the_tangents_of_fine_steps() {
    let model = with("maxwell-branch");
    for operation in conditions(78.0) {
        let problem = Problem::new(&model, &operation);
        let start = problem.initial_state();
        let cycle = |tolerance: &Tolerance| Integrator::new(&problem, tolerance).cycle(&start, None).unwrap();
        let (exact, fine) = (cycle(&Tolerance::default()), cycle(&FINE));
        assert!(
            exact.segments > 1 && exact.segments == exact.steps && fine.segments == 0 && exact.events == fine.events
        );
        let scales = problem.scales();
        for i in 0..problem.states() {
            assert!((exact.end[i] - fine.end[i]).abs() < 1e-8 * scales[i], "{operation:?} state {i}");
            for j in 0..problem.states() {
                let error = (exact.monodromy[i][j] - fine.monodromy[i][j]) * scales[j] / scales[i];
                assert!(error.abs() < 1e-6, "{operation:?} {i} {j}: {error:e}");
            }
            let (a, b) = (exact.fundamental_by_start[i], fine.fundamental_by_start[i]);
            let error = (a.0 - b.0).hypot(a.1 - b.1) * scales[i] / scales[0];
            assert!(error < 1e-6, "{operation:?} {i}: {error:e}");
        }
    }
}

#[test]
fn derivatives_along_exact_flows_are_those_of_differences() {
    for name in ["none", "maxwell-branch", "contact-renewal", "normal-coupling", "roller-compliance", "actuator-lag"] {
        let model = with(name);
        for operation in conditions(72.0).into_iter().filter(|operation| stays_loaded(name, operation)) {
            let solution = cold(&model, &operation, &Tolerance::default(), true);
            let centre = complex(&solution.state);
            let size = centre.0.hypot(centre.1);
            let derivatives = solution.derivatives.expect("asked for");
            for (index, &(da, dp)) in derivatives.iter().enumerate() {
                let sample = |sign: f64| {
                    let (mut model, mut operation) = (model.clone(), operation);
                    let value = model.parameter(&mut operation, index)?;
                    let step = 1e-5 * value.abs();
                    *value += sign * step;
                    Some((step, complex(&steady(&model, &operation))))
                };
                let (Some((step, plus)), Some((_, minus))) = (sample(1.0), sample(-1.0)) else { continue };
                if step == 0.0 {
                    continue;
                }
                let phi = solution.state.phase;
                let given = (da * phi.cos() - size * dp * phi.sin(), da * phi.sin() + size * dp * phi.cos());
                let expected = ((plus.0 - minus.0) / (2.0 * step), (plus.1 - minus.1) / (2.0 * step));
                // In units of the change by the parameter's own size.
                let error = (given.0 - expected.0).hypot(given.1 - expected.1) * step / 1e-5 / size;
                let scale = expected.0.hypot(expected.1) * step / 1e-5 / size;
                assert!(
                    error < 1e-5 * scale.max(1.0),
                    "{name} {operation:?} parameter {index}: {given:?} {expected:?}"
                );
            }
        }
    }
}

#[test]
fn modes_that_cannot_be_followed_exactly_are_stepped_through() {
    let has = |model: &Model, mode: Mode| flow::flow(&Problem::new(model, &at(5e-5, 74.0)), mode, 32).is_some();
    assert!(has(&with("none"), Mode::Stick) && has(&with("none"), Mode::SlipForward));
    // A law of friction leaves stick exact, a nonlinear arm nothing, an element without modes nothing.
    let strengthening = with("rate-strengthening");
    assert!(has(&strengthening, Mode::Stick) && !has(&strengthening, Mode::SlipForward));
    assert!(!has(&with("cubic-stiffness"), Mode::Stick) && !has(&with("lugre"), Mode::RateForward));
    // Bristles without damping slip at once; with hardly any they are too stiff for the squarings.
    for (damping, exact) in [(0.0, false), (1e-2, false), (1.0, true)] {
        let mut model = with("none");
        model.contact.damping = damping;
        assert_eq!(has(&model, Mode::SlipForward), exact, "{damping}");
        let operation = at(1e-4, 72.0);
        let state = steady(&model, &operation);
        let tolerance = Tolerance { steps: 400, roughness: 1e-5, ..Tolerance::default() };
        let fine = cold(&model, &operation, &tolerance, false).state;
        assert!(distance(&state, &fine) < 1e-6, "{damping}: {:e}", distance(&state, &fine));
    }
}

const CONTACTS: [&str; 12] = [
    "none",
    "maxwell-branch",
    "contact-renewal",
    "normal-coupling",
    "roller-compliance",
    "rate-strengthening",
    "grosch",
    "rate-and-state",
    "frictional-heating",
    "lugre",
    "cubic-stiffness",
    "quadratic-damping",
];

#[test]
fn a_warm_start_gives_the_answer_of_a_cold_one_sooner() {
    let (mut warm_cycles, mut cold_cycles) = (0, 0);
    for name in CONTACTS {
        let model = with(name);
        for operation in conditions(76.0) {
            let mut warm = Warm::default();
            let tolerance = Tolerance { steps: 32, ..Tolerance::default() };
            solve(&model, &operation, 0, &tolerance, false, &mut warm);
            for factor in [1.002, 0.98, 1.05] {
                let mut changed = model.clone();
                changed.contact.stiffness *= factor;
                changed.contact.friction *= factor.sqrt();
                changed.rig.arm_mut().torsional_damping /= factor;
                let other = solve(&changed, &operation, 0, &tolerance, false, &mut warm).state;
                let fresh = cold(&changed, &operation, &tolerance, false).state;
                let what = format!("{name} {operation:?} {factor}");
                assert_eq!(other.status.word(), fresh.status.word(), "{what}");
                // Both are within the tolerance of the solver; the kink of the quadratic law at rest, in a contact that
                // came to rest with another stretch, is the least accurate of all.
                let allowed = if name == "quadratic-damping" { 2e-5 } else { 2e-7 };
                assert!(distance(&other, &fresh) < allowed, "{what}: {:e}", distance(&other, &fresh));
                warm_cycles += other.cycles;
                cold_cycles += fresh.cycles;
            }
        }
    }
    assert!(10 * warm_cycles < 9 * cold_cycles, "{warm_cycles} {cold_cycles}");
}

#[test]
fn few_steps_are_good_to_1e_4() {
    let cheap = Tolerance { steps: 12, ..Tolerance::default() };
    for name in CONTACTS {
        let model = with(name);
        for frequency in [62.0, 71.0, 80.0] {
            for operation in conditions(frequency) {
                let (coarse, usual) = (cold(&model, &operation, &cheap, false).state, steady(&model, &operation));
                let what = format!("{name} {operation:?}");
                assert_eq!(coarse.status.word(), usual.status.word(), "{what}");
                assert!(distance(&coarse, &usual) < 1e-4, "{what}: {:e}", distance(&coarse, &usual));
            }
        }
    }
}

/// Work beside the answer: a prediction that quietly fails would cost full cycles again. Among the frequencies are
/// those at which an event passes the start of the cycle.
#[test]
fn a_sweep_of_the_base_law_is_predicted_from_event_to_event() {
    let (model, tolerance, mut warm) = (paper_model(Series), Tolerance::default(), Warm::default());
    let (mut fresh, mut continued) = (0, 0);
    for index in 0..73 {
        let operation = at(5e-5, 58.0 + 0.5 * f64::from(index));
        let cold = steady(&model, &operation);
        let next = solve(&model, &operation, 0, &tolerance, false, &mut warm).state;
        assert!(distance(&cold, &next) < 1e-9 && cold.status == next.status, "{operation:?}");
        (fresh, continued) = (fresh + cold.cycles, continued + next.cycles);
    }
    assert!(fresh < 73 * 8 && continued < 73 * 6, "{fresh} {continued}");
}
