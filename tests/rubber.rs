//! What rubber does beyond a spring and a dashpot, against closed forms: a power of the frequency, friction within.

mod common;

use common::{distance, paper_model, steady};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use stickslip::effects::{REGISTRY, find_among};
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;

fn with(name: &str, parameters: &[f64]) -> Model {
    Model {
        effects: vec![(find_among(REGISTRY, name).expect("registered"), parameters.to_vec())],
        ..paper_model(Series)
    }
}

fn at_rest(load: f64, drive: f64, frequency: f64) -> Operation {
    Operation { speed: 0.0, load, drive, frequency, series: 0 }
}

/// Torque of the drive of the paper's rig (real, imaginary), and its inertia, damping and stiffness.
fn rig(model: &Model, drive: f64, w: f64) -> ((f64, f64), [f64; 3]) {
    let arm = model.rig.arm();
    let (a, k0, c0) = (arm.spring_arm, arm.spring_stiffness, arm.spring_damping);
    let stiffness = arm.torsional_stiffness + 2.0 * a * a * k0;
    let damping = arm.torsional_damping + 2.0 * a * a * c0;
    ((a * drive * k0, a * drive * c0 * w), [arm.inertia, damping, stiffness])
}

/// Case II with the complex stiffness kc + i w cc + c_a (i w t_0)^a.
#[test]
fn a_spring_pot_that_sticks_is_a_power_of_the_frequency() {
    for (order, modulus) in [(0.1, 8e4), (0.5, 3e4), (0.9, 2e4)] {
        let model = with("spring-pot", &[modulus, order, 0.003]);
        for frequency in [5.0, 58.0, 74.0, 400.0] {
            let w = TAU * frequency;
            let ((re, im), [inertia, damping, stiffness]) = rig(&model, 2.5e-6, w);
            let size = modulus * (0.003 * w).powf(order);
            let lever = model.rig.arm().contact_arm.powi(2);
            let (sine, cosine) = (FRAC_PI_2 * order).sin_cos();
            let along = stiffness - inertia * w * w + lever * (model.contact.stiffness + size * cosine);
            let across = w * damping + lever * (w * model.contact.damping + size * sine);
            let state = steady(&model, &at_rest(20.0, 2.5e-6, frequency));
            assert!((state.amplitude * along.hypot(across) / re.hypot(im) - 1.0).abs() < 1e-12, "{order} {frequency}");
            let phase = im.atan2(re) - across.atan2(along);
            assert!((state.phase - phase).sin().abs() < 1e-12, "{order} {frequency}");
        }
    }
}

/// Relaxations side by side: stiffness \[N/m\] and time \[s\] of each.
fn prony_series(terms: &[(f64, f64)]) -> Model {
    let name = |j: usize| if j == 0 { "maxwell-branch".into() } else { format!("maxwell-branch-{}", j + 1) };
    let effect = |(j, &(stiffness, tau)): (usize, &(f64, f64))| {
        (find_among(REGISTRY, &name(j)).expect("a branch"), vec![stiffness, tau])
    };
    Model { effects: terms.iter().enumerate().map(effect).collect(), ..paper_model(Series) }
}

/// Case II with the complex stiffness of a Prony series, of two to eight terms.
#[test]
fn several_branches_that_stick_are_a_prony_series() {
    let terms: [(f64, f64); 8] = std::array::from_fn(|j| (2e4 / (1.0 + j as f64), 1e-4 * 3f64.powi(j as i32)));
    for count in [2, 5, 8] {
        let model = prony_series(&terms[..count]);
        for frequency in [5.0, 58.0, 74.0, 400.0] {
            let w = TAU * frequency;
            let ((re, im), [inertia, damping, stiffness]) = rig(&model, 2.5e-6, w);
            let lever = model.rig.arm().contact_arm.powi(2);
            let relaxing = terms[..count].iter().fold((0.0, 0.0), |sum, (k, tau)| {
                let q = w * tau;
                (sum.0 + k * q * q / (1.0 + q * q), sum.1 + k * q / (1.0 + q * q))
            });
            let along = stiffness - inertia * w * w + lever * (model.contact.stiffness + relaxing.0);
            let across = w * damping + lever * (w * model.contact.damping + relaxing.1);
            let state = steady(&model, &at_rest(20.0, 2.5e-6, frequency));
            assert!((state.amplitude * along.hypot(across) / re.hypot(im) - 1.0).abs() < 1e-12, "{count} {frequency}");
            let phase = im.atan2(re) - across.atan2(along);
            assert!((state.phase - phase).sin().abs() < 1e-12, "{count} {frequency}");
        }
    }
}

/// Stick, partial stick, full slip and slip both ways with three branches, integrated by the separate program.
#[test]
fn several_branches_agree_with_the_independent_table_to_1e_4() {
    let mut slipping = 0;
    for line in include_str!("data/branches.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let numbers: Vec<f64> =
            fields[1].split(' ').map(|pair| pair.split_once('=').unwrap().1.parse().unwrap()).collect();
        let terms: Vec<(f64, f64)> = numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect();
        let v: Vec<f64> = fields[2..].iter().map(|v| v.parse().unwrap()).collect();
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3], series: 0 };
        let model = prony_series(&terms);
        let state = steady(&model, &at);
        assert!((state.amplitude / v[4] - 1.0).abs() < 1e-4, "{line}: {:e}", state.amplitude);
        assert!((state.phase - v[5]).sin().abs() < 1e-4, "{line}: {}", state.phase);
        // Which branch has which name does not matter, nor does one without stiffness.
        let turned: Vec<(f64, f64)> = terms.iter().rev().copied().chain([(0.0, 1.0)]).collect();
        let same = steady(&prony_series(&turned), &at);
        assert!((same.amplitude / state.amplitude - 1.0).abs() < 1e-6, "{line}: {:e}", same.amplitude);
        slipping += usize::from(state.stick_fraction < 1.0);
    }
    assert!(slipping >= 15, "{slipping}");
}

/// A branch by itself, by the solver of one state and by that of sliders, however slow or fast it relaxes.
#[test]
fn a_branch_is_the_same_by_whatever_name() {
    for tau in [1e-6, 1e-4, 2e-3, 0.05, 3.0] {
        let [one, other] = ["maxwell-branch", "maxwell-branch-2"].map(|name| with(name, &[3e4, tau]));
        for (speed, load, drive) in
            [(0.0, 20.0, 2.5e-6), (5e-5, 20.0, 2.5e-6), (0.02, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6)]
        {
            for frequency in [58.0, 74.0, 94.0] {
                let at = Operation { speed, load, drive, frequency, series: 0 };
                let off = distance(&steady(&one, &at), &steady(&other, &at));
                assert!(off < 1e-4, "{tau} {at:?}: {off:e}");
            }
        }
    }
}

/// As a nears 1 a dashpot, as it nears 0 a spring, in partial stick too, where it is a sum of relaxations.
#[test]
fn a_spring_pot_lies_between_a_spring_and_a_dashpot() {
    let (modulus, time) = (3e4, 1.0 / (TAU * 72.0));
    let (mut spring, mut dashpot) = (paper_model(Series), paper_model(Series));
    spring.contact.stiffness += modulus;
    dashpot.contact.damping += modulus * time;
    for (speed, load, drive) in [(5e-5, 20.0, 2.5e-6), (0.0, 0.05, 7.5e-6)] {
        for frequency in [66.0, 74.0, 82.0] {
            let at = Operation { speed, load, drive, frequency, series: 0 };
            for (order, limit) in [(0.01, &spring), (0.99, &dashpot)] {
                let off = |order: f64| {
                    distance(&steady(&with("spring-pot", &[modulus, order, time]), &at), &steady(limit, &at))
                };
                let near: f64 = if order < 0.5 { order + 0.01 } else { order - 0.01 };
                let (one, two) = (off(order), off(near));
                // In proportion to what is left to the limit.
                assert!(one < 5e-3 && (two / one - 2.0).abs() < 0.1, "{at:?} {order}: {one:e} {two:e}");
            }
        }
    }
}

#[test]
fn a_weak_drive_finds_berg_friction_a_spring_and_a_strong_one_finds_none() {
    let [limit, stretch] = [0.01, 3e-7];
    let model = with("berg-friction", &[limit, stretch]);
    let mut stiffer = paper_model(Series);
    stiffer.contact.stiffness += limit / stretch;
    for frequency in [58.0, 74.0, 94.0] {
        let apart = |drive: f64, from: &Model| {
            let at = at_rest(1e4, drive, frequency);
            distance(&steady(&model, &at), &steady(from, &at))
        };
        let (weak, weaker) = (apart(1e-9, &stiffer), apart(5e-10, &stiffer));
        assert!(weak < 1e-3 && (weak / weaker - 2.0).abs() < 0.3, "{frequency}: {weak:e} {weaker:e}");
        let (strong, stronger) = (apart(1e-3, &paper_model(Series)), apart(2e-3, &paper_model(Series)));
        assert!(strong < 2e-3 && (strong / stronger - 2.0).abs() < 0.3, "{frequency}: {strong:e} {stronger:e}");
    }
}

/// Berg's loop of amplitude A loses 2 Fm [2 A - x2 (1 + r)^2 ln(1 + 2 A/(x2 (1 + r)))], r Fm being the force at its
/// ends.
#[test]
fn the_drive_does_the_work_of_bergs_loop() {
    let [limit, stretch] = [0.01, 3e-7];
    let model = with("berg-friction", &[limit, stretch]);
    for (drive, frequency) in [(1e-6, 74.0), (2.5e-6, 70.0), (2.5e-6, 82.0), (1e-5, 74.0)] {
        let w = TAU * frequency;
        let state = steady(&model, &at_rest(100.0, drive, frequency));
        let ((re, im), [_, damping, _]) = rig(&model, drive, w);
        let work = PI * re.hypot(im) * state.amplitude * (im.atan2(re) - state.phase).sin();
        let lever = model.rig.arm().contact_arm;
        let amplitude = lever * state.amplitude;
        let root = (stretch * stretch + amplitude * amplitude + 6.0 * stretch * amplitude).sqrt();
        let above = 1.0 + (root - stretch - amplitude) / (2.0 * stretch);
        let log = (2.0 * amplitude / (stretch * above)).ln_1p();
        let loss = 2.0 * limit * (2.0 * amplitude - stretch * above * above * log);
        let dashpots = PI * w * state.amplitude.powi(2) * (damping + lever * lever * model.contact.damping);
        // The motion is nearly one harmonic.
        assert!((work - dashpots - loss).abs() < 5e-3 * loss, "{drive} {frequency}: {work:e} {dashpots:e} {loss:e}");
        assert!(loss > 0.01 * work);
    }
}
