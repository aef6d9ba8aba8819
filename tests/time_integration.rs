//! The periodic solvers against plain time integration: two numerical methods, one statement of the laws.

mod common;

use common::{paper_model, steady};
use rayon::prelude::*;
use stickslip::effects;
use stickslip::model::contact::Problem;
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
use stickslip::solver::cycle::Tolerance;
use stickslip::solver::time::{Plan, integrate};
use stickslip::solver::{Status, Warm, analytic::wrap, solve_steady};

/// Model of a row of the reference table.
fn model_of(name: &str, parameters: &str) -> Model {
    let mut model = paper_model(Series);
    if name != "none" {
        model.effects.push(setting(name, parameters));
    }
    model
}

fn setting(name: &str, parameters: &str) -> (&'static dyn effects::Effect, Vec<f64>) {
    let effect = effects::find(name).unwrap();
    let value = |(index, p): (usize, &effects::ParameterInfo)| {
        let word = parameters.split(' ').find_map(|word| word.strip_prefix(p.key).and_then(|w| w.strip_prefix('=')));
        word.map(|word| word.parse().unwrap()).or_else(|| effect.unstated(index)).unwrap()
    };
    (effect, effect.parameters().iter().enumerate().map(value).collect())
}

/// Relative difference in amplitude or difference in phase, whichever is larger; the time integration must settle.
fn difference(model: &Model, at: &Operation, plan: &Plan) -> f64 {
    let problem = Problem::new(model, at);
    let found = integrate(&problem.sliders(), plan);
    let names: Vec<_> = model.effects.iter().map(|(e, _)| e.name()).collect();
    assert!(found.periodic, "{names:?} {at:?} not periodic after {} cycles, change {:e}", found.cycles, found.change);
    let (re, im) = problem.free();
    let (re, im) = (re + found.fundamental.0, im + found.fundamental.1);
    let state = steady(model, at);
    assert_eq!(state.status, Status::Steady, "{at:?}");
    let (amplitude, phase) = problem.lumps.reading((re, im));
    (amplitude / state.amplitude - 1.0).abs().max(wrap(phase - state.phase).abs())
}

#[test]
fn every_effect_agrees_to_1e_5_where_it_matters() {
    let lines: Vec<&str> = include_str!("data/effects.csv").lines().skip(1).collect();
    assert!(lines.last().unwrap().starts_with("drift"), "the table ends elsewhere");
    lines.par_iter().for_each(|line| {
        let c: Vec<&str> = line.split(',').collect();
        let v: Vec<f64> = c[2..].iter().map(|v| v.parse().unwrap()).collect();
        // Two points per effect and condition near the resonances; the age of a contact that never slips is not
        // periodic.
        let locked = c[0] == "rate-and-state" && v[0] == 0.0;
        if ![70.0, 82.0].contains(&v[3]) || locked {
            return;
        }
        // Rows of a drift are of the second series.
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3], series: 1 };
        // The fixed steps of sliders do not stop at their events, and 25 of them take their time.
        let (steps, allowed) = match c[0] {
            "partial-slip" => (1000, 1e-4),
            "spring-pot" | "berg-friction" => (4000, 1e-4),
            _ => (4000, 1e-5),
        };
        let plan = Plan { steps, cycles: 4000, ..Plan::default() };
        let found = difference(&model_of(c[0], c[1]), &at, &plan);
        assert!(found < allowed, "{line}: {found:e}");
    });
}

#[test]
fn pairs_of_effects_agree() {
    let pairs = [
        (("rate-strengthening", "beta=0.1 v_0=0.0005"), ("maxwell-branch", "k_1=30000 tau=0.002")),
        (("frictional-heating", "P_0=10 tau=0.003"), ("rate-strengthening", "beta=0.2 v_0=0.0001")),
        (("normal-coupling", "k_n=40000"), ("roller-compliance", "m_r=0.3 k_r=120000 zeta_r=0.05")),
        (("rate-and-state", "a=0.1 B=0.04 v_0=0.0001 D_c=6e-05"), ("quadratic-damping", "D_2=40")),
        (("cubic-stiffness", "K_3=8e7"), ("grosch", "delta_mu=0.5 v_m=0.1 h=1")),
        (("lugre", "sigma_2=8"), ("rate-strengthening", "beta=0.1 v_0=0.001")),
        (("lugre", "sigma_2=8"), ("roller-compliance", "m_r=0.3 k_r=120000 zeta_r=0.05")),
        (("partial-slip", "n=2"), ("maxwell-branch", "k_1=30000 tau=0.002")),
        (("partial-slip", "n=1.5"), ("rate-strengthening", "beta=0.1 v_0=0.0005")),
        (("actuator-lag", "tau=0.0004"), ("structural-damping", "eta=0.03")),
    ];
    pairs.par_iter().for_each(|&(one, other)| {
        let mut model = paper_model(Series);
        model.effects = vec![setting(one.0, one.1), setting(other.0, other.1)];
        let conditions = [(5e-5, 20.0, 2.5e-6), (0.02, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6)];
        for (speed, load, drive) in conditions {
            if speed == 0.0 && one.0 == "rate-and-state" {
                continue;
            }
            let at = Operation { speed, load, drive, frequency: 74.0, series: 0 };
            let (steps, allowed) = if one.0 == "partial-slip" { (1000, 2e-4) } else { (4000, 2e-5) };
            let found = difference(&model, &at, &Plan { steps, cycles: 4000, ..Plan::default() });
            assert!(found < allowed, "{} + {} at {at:?}: {found:e}", one.0, other.0);
        }
    });
}

/// The lighter the roller, the more a force moves it within a step: plain iteration for the force diverges.
#[test]
fn a_roller_of_less_than_a_gram_agrees() {
    let mut model = paper_model(Series);
    (model.contact.stiffness, model.contact.damping) = (1.5e5, 300.0);
    model.effects.push(setting("rate-strengthening", "beta=0.4 v_0=0.0026"));
    model.effects.push(setting("roller-compliance", "m_r=0.0004 k_r=350000 zeta_r=1.1"));
    let plan = Plan { steps: 4000, cycles: 4000, ..Plan::default() };
    for (speed, load, drive) in [(1e-4, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6)] {
        let found = difference(&model, &Operation { speed, load, drive, frequency: 74.0, series: 0 }, &plan);
        assert!(found < 2e-5, "V = {speed}: {found:e}");
    }
}

/// Friction that rises from rest with the logarithm of the slip rate lets the slip die out gently: a step may end
/// within a rounding of the event, and the mode with it.
#[test]
fn slip_that_dies_out_gently_ends_at_every_accuracy() {
    let mut model = model_of("grosch", "delta_mu=0.28272474387298874 v_m=0.006906902474338505 h=2.375719218006876");
    (model.contact.stiffness, model.contact.damping) = (106925.24173997986, 27.707185352743448);
    let plan = Plan { steps: 8000, ..Plan::default() };
    (36..=46).into_par_iter().for_each(|half| {
        let at = Operation { speed: 0.0, load: 0.1, drive: 7.5e-6, frequency: 2.0 * f64::from(half), series: 0 };
        let fine = steady(&model, &at);
        for tolerance in [Tolerance::COARSE, Tolerance::FIT] {
            let state = solve_steady(&model, &at, &tolerance, true, &mut Warm::default()).state;
            assert_eq!(state.status, Status::Steady, "{at:?} {tolerance:?}");
            let change = (state.amplitude / fine.amplitude - 1.0).abs().max((state.phase - fine.phase).abs());
            assert!(change < 1e-5, "{at:?} {tolerance:?}: {change:e}");
        }
        if half % 4 == 0 {
            let found = difference(&model, &at, &plan);
            assert!(found < 1e-5, "{at:?}: {found:e}");
        }
    });
}

/// Over a roller at rest the slip rate falls to zero with a kink: no polynomial through a step leads to where it ends.
#[test]
fn slip_that_ends_with_a_kink_ends_at_every_accuracy() {
    let grosch = ("grosch", "delta_mu=0.09177494663840596 v_m=0.0013982918826646188 h=2.685519453471437");
    let cases = [
        (grosch, 88_989.322_291_124_55, 33.609_016_934_657_68, 78.0),
        (("quadratic-damping", "D_2=4006.799864942097"), 109_411.111_686_135_55, 18.622_508_784_963_625, 72.0),
        (("quadratic-damping", "D_2=3995.1653078877443"), 109_386.386_788_604_22, 24.722_062_536_713_437, 74.0),
    ];
    cases.into_par_iter().for_each(|((effect, values), stiffness, damping, frequency)| {
        let mut model = model_of(effect, values);
        (model.contact.stiffness, model.contact.damping) = (stiffness, damping);
        let at = Operation { speed: 0.0, load: 0.1, drive: 7.5e-6, frequency, series: 0 };
        let found = difference(&model, &at, &Plan { steps: 8000, ..Plan::default() });
        assert!(found < 5e-5, "{at:?}: {found:e}");
        let fine = steady(&model, &at);
        for (tolerance, most) in [(Tolerance::COARSE, 5e-4), (Tolerance::FIT, 2e-4)] {
            let state = solve_steady(&model, &at, &tolerance, true, &mut Warm::default()).state;
            assert_eq!(state.status, Status::Steady, "{at:?} {tolerance:?}");
            let change = (state.amplitude / fine.amplitude - 1.0).abs().max((state.phase - fine.phase).abs());
            assert!(change < most, "{at:?} {tolerance:?}: {change:e}");
        }
    });
}

#[test]
fn time_integration_converges_with_order_two() {
    let model = paper_model(Series);
    let at = Operation { speed: 5e-5, load: 20.0, drive: 2.5e-6, frequency: 74.0, series: 0 };
    let error = |steps| difference(&model, &at, &Plan { steps, settled: 1e-11, ..Plan::default() });
    let (coarse, fine) = (error(250), error(1000));
    let order = (coarse / fine).log2() / 2.0;
    assert!(order > 1.6 && order < 2.6, "order {order}: {coarse:e} {fine:e}");
}

#[test]
fn a_healing_contact_at_rest_slips_on_or_rests_as_it_does_in_time() {
    // Ageing friction over a roller at rest: a slip cycle that keeps the age in balance, and healing until nothing
    // slips.
    let plan = Plan { steps: 2000, cycles: 400, settled: 1e-7, window: 10, solved: Plan::SOLVED };
    let cases = [
        ("a=0.0983 B=0.0501 v_0=1.053e-6 D_c=4.361e-5", 0.0231, 1.855e-5, 74.68, false),
        ("a=0.0355 B=0.363 v_0=2.157e-6 D_c=9.866e-5", 0.0792, 1.39e-5, 73.55, false),
        ("a=0.1 B=0.08 v_0=1e-4 D_c=6e-5", 0.1, 7.5e-6, 72.09, true),
        ("a=0.1 B=0.08 v_0=1e-4 D_c=6e-5", 0.1, 7.5e-6, 87.74, true),
    ];
    cases.par_iter().for_each(|&(parameters, load, drive, frequency, rests)| {
        let at = Operation { speed: 0.0, load, drive, frequency, series: 0 };
        let model = model_of("rate-and-state", parameters);
        assert_eq!(steady(&model, &at).stick_fraction == 1.0, rests, "{parameters} {at:?}");
        let difference = difference(&model, &at, &plan);
        assert!(difference < 3e-4, "{parameters} {at:?}: {difference:e}");
        // The same with the patience of a search, and from the orbit of a neighbour.
        let cold = steady(&model, &at).amplitude;
        let mut warm = Warm::default();
        solve_steady(&model, &Operation { frequency: frequency - 0.5, ..at }, &Tolerance::default(), false, &mut warm);
        for (tolerance, mut start, most) in [
            (Tolerance::COARSE, Warm::default(), 5e-3),
            (Tolerance::FIT, Warm::default(), 1e-4),
            (Tolerance::default(), warm, 1e-6),
        ] {
            let state = solve_steady(&model, &at, &tolerance, false, &mut start).state;
            assert_eq!(state.status, Status::Steady, "{parameters} {at:?} {tolerance:?}");
            assert!((state.amplitude / cold - 1.0).abs() < most, "{parameters} {at:?} {tolerance:?}");
        }
    });
}
