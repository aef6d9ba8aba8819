//! Rigs without a contact: closed forms, an integration that shares no shortcut, derivatives, folds.

mod common;

use common::oscillator;
use std::f64::consts::TAU;
use stickslip::effects::find;
use stickslip::model::{Model, Operation};
use stickslip::scenario;
use stickslip::solver::cycle::Tolerance;
use stickslip::solver::time::Plan;
use stickslip::solver::{Solution, Status, Warm, integrated, solve_steady};

fn with(mut model: Model, name: &str, parameters: &[f64]) -> Model {
    model.effects.push((find(name).expect("registered"), parameters.to_vec()));
    model
}

fn at(force: f64, frequency: f64) -> Operation {
    Operation { speed: 0.0, load: 0.0, drive: force, frequency, series: 0 }
}

fn solved(model: &Model, at: &Operation, warm: &mut Warm) -> Solution {
    solve_steady(model, at, &Tolerance::default(), true, warm)
}

/// [(K - M w^2) + 3/4 K3 X^2]^2 + (w C)^2 = (f/X)^2, exact as the response tends to one harmonic.
#[test]
fn duffing_is_that_of_the_closed_form() {
    for quality in [30.0, 1e3, 1e4] {
        let (mass, f0, force) = (2.0, 80.0, 1.0);
        let k = mass * (TAU * f0).powi(2);
        let motion = force * quality / k;
        for strength in [-1.0, 0.5, 3.0] {
            let k3 = strength * k / quality / motion.powi(2);
            let model = with(oscillator(mass, f0, quality), "cubic-stiffness", &[k3]);
            for step in -20..=20 {
                let frequency = f0 * (1.0 + 0.2 * f64::from(step) / quality);
                let found = solved(&model, &at(force, frequency), &mut Warm::default());
                assert_eq!(found.state.status, Status::Steady, "{quality} {strength} {step}");
                for x in [found.state.amplitude].into_iter().chain(found.others.iter().map(|o| o.0)) {
                    let w = TAU * frequency;
                    let c = (k * mass).sqrt() / quality;
                    let balance = (k - mass * w * w + 0.75 * k3 * x * x).hypot(w * c) * x / force;
                    // The third harmonic goes with K3 X^2/32 K.
                    let third = 0.1 * (k3 * x * x / k).abs() + 1e-7;
                    assert!((balance - 1.0).abs() < third * quality, "{quality} {strength} {step}: {balance}");
                }
            }
        }
    }
}

/// The discriminant of the cubic of the closed form tells how many states there are.
#[test]
fn folds_are_where_the_closed_form_has_them() {
    let (mass, f0, quality, force) = (1.0, 1.0, 500.0, 1.0);
    let k: f64 = mass * (TAU * f0).powi(2);
    let c = (k * mass).sqrt() / quality;
    let k3 = 4.0 * k / quality / (force * quality / k).powi(2);
    let model = with(oscillator(mass, f0, quality), "cubic-stiffness", &[k3]);
    let mut between = 0;
    for step in 0..400 {
        let frequency = f0 * (1.0 + 6.0 / quality * f64::from(step) / 400.0);
        let w = TAU * frequency;
        // y^3 + p y^2 + q y + r = 0 with y = X^2.
        let (a, s, d) = (0.75 * k3, k - mass * w * w, w * c);
        let (p, q, r) = (2.0 * s / a, (s * s + d * d) / (a * a), -(force / a).powi(2));
        let discriminant = 18.0 * p * q * r - 4.0 * p.powi(3) * r + (p * q).powi(2) - 4.0 * q.powi(3) - 27.0 * r * r;
        let scale = 27.0 * r * r;
        let found = solved(&model, &at(force, frequency), &mut Warm::default());
        if (discriminant / scale).abs() > 1e-3 {
            assert_eq!(found.others.len(), usize::from(discriminant > 0.0), "{frequency}: {discriminant}");
        }
        between += usize::from(discriminant > 0.0);
    }
    assert!(between > 20, "the test has to meet folds: {between}");
}

#[test]
fn sweeps_stay_on_their_branch_until_it_ends() {
    let (f0, quality) = (50.0, 1e3);
    let k: f64 = (TAU * f0).powi(2);
    let k3 = 4.0 * k / quality / (quality / k).powi(2);
    let model = with(oscillator(1.0, f0, quality), "cubic-stiffness", &[k3]);
    let frequencies: Vec<f64> = (0..200).map(|i| f0 * (1.0 + (6.0 * f64::from(i) / 200.0 - 1.0) / quality)).collect();
    let sweep = |order: &mut dyn Iterator<Item = usize>| {
        let mut warm = Warm::default();
        let mut found = vec![0.0; frequencies.len()];
        for i in order {
            found[i] = solved(&model, &at(1.0, frequencies[i]), &mut warm).state.amplitude;
        }
        found
    };
    let (up, down) = (sweep(&mut (0..200)), sweep(&mut (0..200).rev()));
    let differ = (0..200).filter(|&i| (up[i] / down[i] - 1.0).abs() > 1e-3).count();
    assert!(differ > 5, "{differ}");
    assert!((0..200).all(|i| up[i] >= down[i] * (1.0 - 1e-9)), "a hardening resonance is higher on the way up");
}

const PLAN: Plan = Plan { steps: 2000, cycles: 2000, settled: 1e-9, window: 1, solved: 1e-9 };

/// Against an integration in time, from rest, that shares only the statement of the laws.
#[test]
fn balance_and_integration_agree() {
    let (mass, f0, quality, force) = (3.0, 7.0, 15.0, 2.0);
    let k = mass * (TAU * f0).powi(2);
    let motion = force * quality / k;
    let c = (k * mass).sqrt() / quality;
    let cases: [(&str, Vec<f64>); 11] = [
        ("cubic-stiffness", vec![0.3 * k / quality / motion.powi(2)]),
        ("cubic-stiffness", vec![-0.3 * k / quality / motion.powi(2)]),
        ("quintic-stiffness", vec![0.3 * k / quality / motion.powi(4)]),
        ("asymmetric-stiffness", vec![-0.8 * k / quality.sqrt() / motion]),
        ("clearance", vec![0.06 * k, 0.4 * motion]),
        ("power-damping", vec![0.5 * force, 1.3, motion * TAU * f0]),
        ("quadratic-damping", vec![2.0 * c / (motion * TAU * f0)]),
        ("friction-joint", vec![0.3 * k, 0.4 * force, 1.0]),
        ("friction-joint", vec![0.3 * k, 0.4 * force, 2.5]),
        ("friction-joint", vec![0.3 * k, 5.0 * force, 1.5]),
        ("structural-damping", vec![0.1]),
    ];
    for (name, parameters) in cases {
        let model = with(oscillator(mass, f0, quality), name, &parameters);
        for ratio in [0.4, 0.9, 0.98, 1.0, 1.05, 1.15, 1.6] {
            let operation = at(force, ratio * f0);
            let found = solved(&model, &operation, &mut Warm::default());
            let other = integrated(&model, &operation, &PLAN);
            assert!(other.periodic, "{name} {ratio}");
            let amplitude = found.state.amplitude / other.amplitude - 1.0;
            let phase = found.state.phase - other.phase;
            // The sliders of the integration are a coarser continuum than Masing's rules.
            let close = if name == "friction-joint" && parameters[2] > 1.0 { 1e-3 } else { 1e-4 };
            assert!(amplitude.abs() < close && phase.abs() < close, "{name} {ratio}: {amplitude:e} {phase:e}");
        }
    }
}

#[test]
fn zero_strength_is_the_linear_mode() {
    let bare = oscillator(3.0, 7.0, 40.0);
    for (name, parameters) in [
        ("cubic-stiffness", vec![0.0]),
        ("quadratic-damping", vec![0.0]),
        ("friction-joint", vec![0.0, 1.0, 2.0]),
        ("quintic-stiffness", vec![0.0]),
        ("asymmetric-stiffness", vec![0.0]),
        ("clearance", vec![0.0, 1e-3]),
        ("clearance", vec![1.0, 1e3]),
        ("power-damping", vec![0.0, 0.5, 1.0]),
        ("power-damping", vec![0.0, 1.5, 1.0]),
        ("pivot-friction", vec![0.0]),
        ("residual-modes", vec![0.0, 0.0]),
        ("crosstalk", vec![0.0, 0.0]),
        ("structural-damping", vec![0.0]),
        ("sensor-delay", vec![0.0]),
        ("actuator-lag", vec![0.0]),
    ] {
        let model = with(bare.clone(), name, &parameters);
        for frequency in [5.0, 7.0, 7.1, 12.0] {
            let one = solved(&model, &at(2.0, frequency), &mut Warm::default()).state;
            let other = solved(&bare, &at(2.0, frequency), &mut Warm::default()).state;
            let apart = (one.amplitude / other.amplitude - 1.0).abs() + (one.phase - other.phase).abs();
            assert!(apart < 1e-9, "{name} {frequency}: {apart:e}");
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let (mass, f0, quality, force) = (3.0, 7.0, 40.0, 2.0);
    let k = mass * (TAU * f0).powi(2);
    let motion = force * quality / k;
    let c = (k * mass).sqrt() / quality;
    let mut model = with(oscillator(mass, f0, quality), "cubic-stiffness", &[0.5 * k / quality / motion.powi(2)]);
    model = with(model, "quadratic-damping", &[0.5 * c / (motion * TAU * f0)]);
    model = with(model, "friction-joint", &[0.1 * k, 0.5 * force, 1.8]);
    for ratio in [0.9, 1.0, 1.03, 1.2] {
        let operation = at(force, ratio * f0);
        let found = solved(&model, &operation, &mut Warm::default());
        let derivatives = found.derivatives.expect("asked for");
        for index in (0..3).chain(10..13).chain(15..21) {
            let moved = |sign: f64| {
                let (mut model, mut operation) = (model.clone(), operation);
                let slot = model.parameter(&mut operation, index).expect("a parameter");
                let step = 1e-5 * if *slot == 0.0 { 1.0 } else { slot.abs() };
                *slot += sign * step;
                let state = solved(&model, &operation, &mut Warm::default()).state;
                (state.amplitude, state.phase, step)
            };
            let (plus, minus) = (moved(1.0), moved(-1.0));
            let by = ((plus.0 - minus.0) / (2.0 * plus.2), (plus.1 - minus.1) / (2.0 * plus.2));
            let (amplitude, phase) = derivatives[index];
            let scale = found.state.amplitude / plus.2 * 1e-5;
            assert!(
                (amplitude - by.0).abs() < 2e-3 * by.0.abs() + 1e-5 * scale,
                "{ratio} {index}: {amplitude} {}",
                by.0
            );
            assert!(
                (phase - by.1).abs() < 2e-3 * by.1.abs() + 1e-5 * 1e-5 / plus.2,
                "{ratio} {index}: {phase} {}",
                by.1
            );
        }
    }
}

/// The paper's rig with nothing that damps it, driven at its resonance.
#[test]
fn an_undamped_resonance_is_no_steady_state() {
    let mut scenario = scenario::paper();
    let arm = scenario.rig.arm_mut();
    (arm.torsional_damping, arm.spring_damping, arm.torsional_stiffness) = (0.0, 0.0, 1000.0);
    let model = Model::new(&scenario);
    let operation = Operation { speed: 0.0, load: 0.0, drive: 2.5e-6, frequency: 72.193_917_240_733_34, series: 0 };
    let found = solved(&model, &operation, &mut Warm::default()).state;
    assert!(found.status != Status::Steady || found.amplitude.is_finite(), "{found:?}");
}

#[test]
fn the_sign_of_an_even_force_is_hidden_beside_odd_ones_alone() {
    let bare = || oscillator(1.0, 10.0, 50.0);
    let k: f64 = (TAU * 10.0f64).powi(2);
    let motion = 50.0 / k;
    let with_sign = |sign: f64, k3: f64| {
        let model = with(bare(), "asymmetric-stiffness", &[sign * 0.3 * k / motion]);
        if k3 == 0.0 { model } else { with(model, "cubic-stiffness", &[k3]) }
    };
    for k3 in [0.0, 0.01 * k / motion.powi(2)] {
        assert!(with_sign(1.0, k3).hides_sign(0));
        for share in [0.97, 1.0, 1.02] {
            let at = at(0.3, 10.0 * share);
            let [one, other] = [1.0, -1.0].map(|sign| solved(&with_sign(sign, k3), &at, &mut Warm::default()).state);
            assert!((one.amplitude / other.amplitude - 1.0).abs() < 1e-9, "{share}");
            assert!((one.phase - other.phase).abs() < 1e-9, "{share}");
            // It does change what is read.
            let without = solved(&with_sign(0.0, k3), &at, &mut Warm::default()).state;
            assert!((one.amplitude / without.amplitude - 1.0).abs() > 1e-6, "{share}");
        }
    }
    // An odd force has a sign to be read; so has an even one beside another.
    assert!(!with(bare(), "cubic-stiffness", &[1.0]).hides_sign(0));
    assert!(!with(with_sign(1.0, 0.0), "asymmetric-stiffness", &[1.0]).hides_sign(0));
}

/// y [1 + Gamma r^2/(1 - r^2 + i r/Q)] is what a place of a base-driven structure does in space, Gamma 1 of a mass on a
/// spring.
#[test]
fn a_place_of_a_base_driven_structure_moves_as_its_participation_says() {
    let text = "title = 'x'\nprovenance = 'x'\n[rig]\nkind = 'oscillator'\ndrive = 'base'\nreading = 'absolute'\n\
                natural_frequency = 80\nquality_factor = 50\nparticipation = 1.57\n[sweep]\nfrequency = 80\ndrive = 1e-3\n";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("beam.toml");
    std::fs::write(&path, text).expect("a file");
    let model = Model::new(&scenario::load(&path).unwrap_or_else(|error| panic!("{error}")));
    for frequency in [60.0, 79.0, 80.0, 81.5, 120.0] {
        let found = solved(&model, &at(1e-3, frequency), &mut Warm::default());
        let r: f64 = frequency / 80.0;
        let (re, im) = (1.0 - r * r, r / 50.0);
        let share = 1.57 * r * r / (re * re + im * im);
        let (x, y) = (1e-3 * (1.0 + share * re), -1e-3 * share * im);
        assert!((found.state.amplitude / x.hypot(y) - 1.0).abs() < 1e-12, "{frequency}");
        assert!((found.state.phase - y.atan2(x)).abs() < 1e-9, "{frequency}");
        // By the participation as by differences.
        let (key, index, _) = model.base_parameters().into_iter().find(|(key, ..)| key.ends_with("tion")).expect("one");
        let moved = |by: f64| {
            let (mut model, mut at) = (model.clone(), at(1e-3, frequency));
            *model.parameter(&mut at, index).expect("a parameter") += by;
            solved(&model, &at, &mut Warm::default()).state.amplitude
        };
        let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        let told = found.derivatives.as_ref().expect("derivatives")[index].0;
        assert!((told - slope).abs() < 1e-6 * slope.abs(), "{key} at {frequency}: {told} {slope}");
    }
    // Relative to the base it would be a gain.
    std::fs::write(&path, text.replace("absolute", "relative")).expect("a file");
    let refused = scenario::load(&path).expect_err("refused").to_string();
    assert!(refused.contains("`participation` belongs to reading = \"absolute\""), "{refused}");
}
