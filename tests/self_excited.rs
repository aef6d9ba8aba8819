//! States that are not steady are reported as such, and none is silently wrong.

mod common;

use common::{at, paper_model, steady};
use stickslip::effects;
use stickslip::model::contact::Problem;
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
use stickslip::scenario::Rig;
use stickslip::solver::time::{Plan, integrate};
use stickslip::solver::{Method, Status};

fn with(name: &str, parameters: &[f64]) -> Model {
    let mut model = paper_model(Series);
    model.effects.push((effects::find(name).unwrap(), parameters.to_vec()));
    model
}

#[test]
fn weakening_beyond_the_damping_of_the_arm_excites_it() {
    // In full slip the weakening law acts on the arm as the negative damping b^2 N dmu/ds; C of the arm is 0.4516.
    // With delta_mu = 0.4 and v_s = 20 mm/s at V = 20 mm/s: N dmu/ds = -20 * 0.4/0.02 * exp(-1) = -147 N s/m, in series
    // with bristles of cc = 26 N s/m: the bristles themselves are unstable.
    let state = steady(&with("stribeck", &[0.4, 0.02]), &at(0.02, 72.0));
    assert!(matches!(&state.status, Status::SelfExcited(why) if why.contains("lock-in average over")), "{state:?}");
    assert_eq!(state.method, Method::TimeIntegration);
    assert!(state.amplitude.is_finite());
}

#[test]
fn weak_weakening_is_steady_up_to_the_damping_of_the_arm() {
    // N |dmu/ds| = 20 * dmu/v_s exp(-V/v_s): below cc and with b^2 N |dmu/ds| below C the sliding is stable. The
    // motion is small against V, so that linear theory holds: eta in series with kc + i w cc.
    for (delta, stable) in [(0.05, true), (0.12, true), (0.9, false)] {
        let state = steady(&with("stribeck", &[delta, 0.1]), &Operation { drive: 1e-9, ..at(0.02, 72.0) });
        assert_eq!(state.status == Status::Steady, stable, "{delta}: {:?}", state.status);
    }
}

#[test]
fn every_point_over_the_catalogue_ends_in_a_number_or_in_words() {
    // Deterministic points over the whole search ranges.
    let mut seed = 7u64;
    let mut uniform = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut steady_points, mut integrated, mut excited, mut failed) = (0, 0, 0, 0);
    for effect in effects::REGISTRY.iter().filter(|effect| effects::fits_rig(**effect, true).is_ok()) {
        for _ in 0..20 {
            let value = |p: &effects::ParameterInfo, u: f64| {
                let (low, high) = p.range.unwrap_or((p.minimum, p.maximum));
                let low = low.max(1e-3 * high);
                low * (high / low).powf(u)
            };
            let parameters: Vec<f64> = effect.parameters().iter().map(|p| value(p, uniform())).collect();
            let speed = [0.0, 5e-5, 2e-3, 0.02][(uniform() * 4.0) as usize];
            let load = [0.1, 20.0][(uniform() * 2.0) as usize];
            let operation = Operation { speed, load, drive: 2.5e-6, frequency: 60.0 + 30.0 * uniform(), series: 0 };
            let state = steady(&with(effect.name(), &parameters), &operation);
            match &state.status {
                Status::Steady => {
                    steady_points += 1;
                    integrated += usize::from(state.method == Method::TimeIntegration);
                    assert!(state.amplitude > 0.0 && state.phase.abs() <= std::f64::consts::PI, "{state:?}");
                }
                Status::SelfExcited(why) => {
                    excited += 1;
                    assert!(state.amplitude.is_finite() && why.contains("average"), "{state:?}");
                }
                Status::Stuck => panic!("a contact has no such state: {state:?}"),
                Status::Failed(why) => {
                    failed += 1;
                    assert!(state.amplitude.is_nan() && why.len() > 20, "{state:?}");
                    println!("{} {parameters:?} {operation:?}: {why}", effect.name());
                }
            }
        }
    }
    println!(
        "{steady_points} steady, {integrated} of them by time integration, {excited} self-excited, {failed} failed"
    );
    assert!(integrated * 50 < steady_points, "{integrated} of {steady_points} needed the time integration");
    assert!(failed <= 2, "{failed} points have no answer");
}

#[test]
fn a_hardening_arm_has_two_states_between_its_folds_and_both_are_found() {
    use stickslip::scenario::{EffectSetting, Sweep};
    let mut scenario = stickslip::scenario::paper();
    // A lightly damped arm in full slip under hardly any load.
    scenario.rig.arm_mut().torsional_damping = 0.02;
    scenario.rig.arm_mut().spring_damping = 0.0;
    scenario.effects =
        vec![EffectSetting { effect: effects::find("cubic-stiffness").unwrap(), parameters: vec![2e10] }];
    scenario.sweep = Some(Sweep {
        frequency: (0..=60).map(|i| 70.0 + 0.1 * i as f64).collect(),
        speed: vec![0.5],
        load: vec![1e-9],
        drive: vec![2.5e-6],
        friction: vec![0.5],
        formulation: vec![Series],
        euler_steps: vec![1000],
    });
    let outcome = stickslip::sweep::run(&scenario, &stickslip::sweep::Options::default());
    let curve = &outcome.curves[0];
    let two: Vec<usize> = (0..curve.frequency.len()).filter(|&i| curve.down[i].is_some()).collect();
    assert!(two.len() > 3, "{two:?}");
    // One stretch without gaps, in which the upward sweep rides on the higher branch and both are stable.
    assert_eq!(two.last().unwrap() - two[0] + 1, two.len());
    for &i in &two {
        let down = curve.down[i].as_ref().unwrap();
        assert!(curve.states[i].amplitude > 1.2 * down.amplitude);
        assert_eq!((&curve.states[i].status, &down.status), (&Status::Steady, &Status::Steady));
    }
    // The upper branch ends near the backbone w^2 = (K + 3/4 K3 alpha^2)/J.
    let last = *two.last().unwrap();
    let alpha = curve.states[last].amplitude;
    let backbone = ((1018.8 + 0.75 * 2e10 * alpha * alpha) / 0.005f64).sqrt() / std::f64::consts::TAU;
    assert!((curve.frequency[last] - backbone).abs() < 0.4, "{} {backbone}", curve.frequency[last]);
}

#[test]
fn steep_weakening_does_not_stick_where_the_slip_goes_on() {
    // Both stick and slip are consistent with the states wherever N |dmu/ds| > cc: a cycle must go on as the last one
    // ended.
    for v_s in [5e-5, 1e-4, 3e-4, 5e-4] {
        let state = steady(&with("stribeck", &[0.2, v_s]), &at(0.02, 71.0));
        let free = steady(&paper_model(Series), &at(0.02, 71.0));
        assert_eq!(state.status, Status::Steady, "{v_s}");
        assert!((state.amplitude / free.amplitude - 1.0).abs() < 1e-6, "{v_s}: {:e}", state.amplitude);
        assert_eq!(state.stick_fraction, 0.0);
    }
}

#[test]
fn no_steady_state_sticks_throughout_on_a_turning_roller() {
    for (name, parameters) in
        [("stribeck", vec![0.2, 1e-4]), ("stribeck", vec![0.4, 1e-3]), ("grosch", vec![1.0, 1e-4, 0.5])]
    {
        for speed in [2e-5, 5e-5, 1e-4] {
            let state = steady(&with(name, &parameters), &at(speed, 71.0));
            assert!(state.status != Status::Steady || state.stick_fraction < 0.999, "{name} {speed}: {state:?}");
        }
    }
}

#[test]
fn what_no_number_describes_fails_at_once_and_in_words() {
    let mut undamped = paper_model(Series);
    if let Rig::TorsionalArm(arm) = &mut undamped.rig {
        (arm.torsional_damping, arm.spring_damping, arm.torsional_stiffness) = (0.0, 0.0, 1000.0);
    }
    let ageing = with("rate-and-state", &[0.01, 0.02, 1e-3, 1e-5]);
    let resonance = 72.193_917_240_733_34;
    let cases = [
        (&undamped, Operation { load: 0.0, ..at(0.02, resonance) }),
        (&undamped, at(0.02, resonance)),
        (&undamped, at(0.0, resonance)),
        (&ageing, at(5e-324, 72.0)),
    ];
    for (model, operation) in cases {
        let state = steady(model, &operation);
        let numbers = [
            state.amplitude,
            state.phase,
            state.mean,
            state.stick_fraction,
            state.force_minimum,
            state.periodicity_error,
        ];
        let sound = numbers.iter().all(|number| number.is_finite());
        assert_eq!(sound, !matches!(state.status, Status::Failed(_)), "{operation:?}: {state:?}");
        // A motion that is lost is not followed through all the cycles of the plan.
        let plan = Plan { steps: 1000, cycles: 1000, ..Plan::default() };
        let found =
            if operation.load > 0.0 { integrate(&Problem::new(model, &operation).sliders(), &plan).cycles } else { 0 };
        assert!(sound || found < 2, "{operation:?}: {found} cycles");
    }
}

/// A contact of many sliders whose weakening excites the arm.
fn excited_sliders() -> Model {
    let mut model = with("partial-slip", &[2.0]);
    model.effects.push((effects::find("stribeck").unwrap(), vec![0.08, 0.01]));
    model
}

#[test]
fn many_sliders_that_excite_themselves_are_averaged_over_fewer_cycles() {
    let state = steady(&excited_sliders(), &at(0.02, 72.0));
    assert!(matches!(state.status, Status::SelfExcited(_)) && state.amplitude.is_finite(), "{state:?}");
    assert_eq!((state.method, state.cycles), (Method::TimeIntegration, 100));
}

#[test]
fn an_integration_whose_steps_are_not_solved_is_given_up() {
    let model = excited_sliders();
    let problem = Problem::new(&model, &at(0.02, 72.0));
    let plan = Plan { steps: 64, cycles: 20, window: 1, ..Plan::default() };
    let found = integrate(&problem.sliders(), &plan);
    assert!(!found.given_up && found.cycles > plan.cycles, "{found:?}");
    // No step counts as solved: each takes all trials that it may.
    let found = integrate(&problem.sliders(), &Plan { solved: -1.0, ..plan });
    assert!(found.given_up && !found.periodic && found.cycles < plan.cycles / 2, "{found:?}");
}
