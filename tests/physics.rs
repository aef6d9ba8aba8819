//! The base contact against closed forms and exact invariants.

mod common;

use common::{at, complex, distance, paper_model, steady};
use stickslip::model::contact::Problem;
use stickslip::model::system::HybridSystem;
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::{Paper, Series};
use stickslip::solver::cycle::{Record, Tolerance};
use stickslip::solver::{Status, Warm, radau, shooting, solve};
use stickslip::sweep::{LimitingCase, limiting_oscillator};

#[test]
fn peaks_of_the_limiting_cases_are_those_of_the_specification() {
    let model = paper_model(Series);
    let free = limiting_oscillator(&model, LimitingCase::FreeOrFullSlip, 2.5e-6);
    let stuck = limiting_oscillator(&model, LimitingCase::StaticContact, 2.5e-6);
    let b = model.rig.arm().contact_arm;
    let close =
        |value: f64, expected: f64, digits: f64| assert!((value - expected).abs() < digits, "{value} {expected}");
    let (f, alpha) = free.peak(50.0, 100.0, 0);
    close(f, 71.194, 5e-4);
    close(alpha * 1e6, 6.2401, 5e-5);
    let (f, speed) = free.peak(50.0, 100.0, 1);
    close(f, 71.916, 5e-4);
    close(b * speed * 1e3, 0.16833, 5e-6);
    let (f, alpha) = stuck.peak(50.0, 100.0, 0);
    close(f, 81.569, 5e-4);
    close(alpha * 1e6, 4.5814, 5e-5);
    let (f, speed) = stuck.peak(50.0, 100.0, 1);
    close(f, 82.49, 5e-3);
    close(b * speed * 1e3, 0.14167, 5e-6);
}

#[test]
fn limiting_cases_of_the_contact_are_the_closed_forms() {
    let model = paper_model(Series);
    for i in 0..=25 {
        let f = 50.0 + 2.0 * i as f64;
        let free = limiting_oscillator(&model, LimitingCase::FreeOrFullSlip, 2.5e-6).response(f);
        let stuck = limiting_oscillator(&model, LimitingCase::StaticContact, 2.5e-6).response(f);
        let check = |operation: Operation, expected: (f64, f64), tolerance: f64| {
            let state = steady(&model, &operation);
            assert!((state.amplitude / expected.0 - 1.0).abs() < tolerance, "{operation:?} {}", state.amplitude);
            assert!((state.phase - expected.1).abs() < tolerance, "{operation:?} {}", state.phase);
        };
        check(Operation { load: 0.0, ..at(0.0, f) }, free, 1e-12);
        check(at(0.02, f), free, 1e-10);
        check(at(0.0, f), stuck, 1e-12);
        // The shooting solver, which is not asked for these points, gives them too.
        for (operation, expected) in [(at(0.02, f), free), (at(0.0, f), stuck)] {
            let problem = Problem::new(&model, &operation);
            let found = shooting::solve(&problem, None, &Tolerance::default()).unwrap().cycle.fundamental;
            let (re, im) = problem.free();
            let (re, im) = (re + found.0, im + found.1);
            let expected = (expected.0 * expected.1.cos(), expected.0 * expected.1.sin());
            assert!((re - expected.0).hypot(im - expected.1) < 1e-6 * re.hypot(im), "{operation:?}");
        }
    }
}

#[test]
fn phase_falls_through_resonance_without_a_jump() {
    let oscillator = limiting_oscillator(&paper_model(Series), LimitingCase::FreeOrFullSlip, 2.5e-6);
    let phases: Vec<f64> = (0..=500).map(|i| oscillator.response(50.0 + 0.1 * i as f64).1).collect();
    assert!(phases.windows(2).all(|w| w[1] < w[0] && w[0] - w[1] < 0.05));
}

#[test]
fn friction_coefficient_and_load_do_not_matter_while_the_force_stays_positive() {
    for f in [68.0, 71.0, 74.0, 78.0] {
        let base = steady(&paper_model(Series), &at(1e-4, f));
        assert!(base.stick_fraction > 0.1 && base.force_minimum > 0.0);
        for (friction, load) in [(0.25, 20.0), (0.9, 20.0), (0.5, 7.0), (0.37, 55.0)] {
            let mut model = paper_model(Series);
            model.contact.friction = friction;
            let other = steady(&model, &Operation { load, ..at(1e-4, f) });
            assert!(other.force_minimum > -friction * load);
            assert!(distance(&other, &base) < 1e-9, "{friction} {load} {f}: {:e}", distance(&other, &base));
        }
    }
}

#[test]
fn amplitude_over_drive_depends_on_speed_over_drive_only() {
    let model = paper_model(Series);
    for (speed, f) in [(2e-5, 78.0), (5e-5, 74.0), (1e-4, 70.0)] {
        let base = steady(&model, &at(speed, f));
        for factor in [0.3, 1.7, 4.0] {
            let scaled = steady(&model, &Operation { drive: 2.5e-6 * factor, ..at(speed * factor, f) });
            let ratio = scaled.amplitude / factor / base.amplitude - 1.0;
            assert!(ratio.abs() < 1e-9 && (scaled.phase - base.phase).abs() < 1e-9, "{speed} {factor}: {ratio:e}");
        }
    }
}

#[test]
fn sticking_starts_at_the_threshold_speed_in_both_formulations() {
    // Series: the largest speed amplitude of case III; paper: that times sqrt(1 + (w cc/kc)^2).
    let series = |v: f64| steady(&paper_model(Series), &at(v, 71.916)).stick_fraction;
    assert_eq!(series(0.16834e-3), 0.0);
    assert!(series(0.16832e-3) > 0.0);
    let paper = |v: f64| {
        let (model, operation) = (paper_model(Paper), at(v, 71.916));
        solve(&model, &operation, 200_000, &Tolerance::default(), false, &mut Warm::default()).state.stick_fraction
    };
    assert_eq!(paper(0.16990e-3), 0.0);
    assert!(paper(0.16965e-3) > 0.0);
}

#[test]
fn work_of_drive_and_roller_is_what_damping_bristles_and_slip_dissipate() {
    let model = paper_model(Series);
    let cases = [(1e-4, 20.0, 2.5e-6), (2e-5, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6), (0.02, 20.0, 2.5e-6)];
    for (speed, load, drive) in cases {
        for f in [66.0, 74.0, 80.0] {
            let operation = Operation { speed, load, drive, frequency: f, series: 0 };
            let problem = Problem::new(&model, &operation);
            let tolerance = Tolerance { steps: 64, ..Tolerance::default() };
            let periodic = shooting::solve(&problem, None, &tolerance).unwrap();
            let lumps = &problem.lumps;
            let (mut supplied, mut dissipated) = (0.0, 0.0);
            let mut add = |r: &Record| {
                for i in 0..3 {
                    let h = r.size * radau::A[2][i];
                    let (z, s, forcing) = (&r.stepper.z[i], r.stepper.s[i], &r.stepper.forcing[i]);
                    let w = forcing.velocity + z[1];
                    let force = problem.force(forcing, z, s).0;
                    let torque = lumps.torque_re.value * forcing.sine + lumps.torque_im.value * forcing.cosine;
                    let stretching = speed - model.rig.arm().contact_arm * w - s;
                    supplied += h * (torque * w + force * speed);
                    dissipated += h * (lumps.damping.value * w * w + 26.0 * stretching * stretching + force * s);
                }
            };
            shooting::trace(&problem, &periodic, &tolerance, &mut add).unwrap();
            assert!((supplied / dissipated - 1.0).abs() < 2e-6, "{operation:?}: {supplied:e} {dissipated:e}");
        }
    }
}

fn order(errors: &[f64]) -> f64 {
    let n = errors.len();
    (errors[0] / errors[n - 1]).log2() / (n - 1) as f64
}

#[test]
fn euler_procedure_converges_with_order_one() {
    let model = paper_model(Paper);
    let solved =
        |steps| solve(&model, &at(1e-4, 74.0), steps, &Tolerance::default(), false, &mut Warm::default()).state;
    let fine = solved(256_000);
    let errors: Vec<f64> = [4000, 8000, 16000].map(|n| distance(&solved(n), &fine)).to_vec();
    let observed = order(&errors);
    assert!((observed - 1.0).abs() < 0.1, "order {observed}: {errors:?}");
}

#[test]
fn shooting_converges_with_order_five_through_the_events() {
    let model = paper_model(Series);
    let solved = |steps| {
        let tolerance = Tolerance { steps, roughness: f64::INFINITY, ..Tolerance::default() };
        solve(&model, &at(5e-5, 74.0), 0, &tolerance, false, &mut Warm::default()).state
    };
    let fine = solved(400);
    let errors: Vec<f64> = [10, 20, 40].map(|n| distance(&solved(n), &fine)).to_vec();
    let observed = order(&errors);
    assert!(observed > 4.3 && observed < 6.5, "order {observed}: {errors:?}");
}

#[test]
fn default_tolerance_gives_alpha_to_1e_6() {
    let model = paper_model(Series);
    for speed in [1e-6, 1e-5, 3e-5, 1e-4, 1.5e-4] {
        for f in [52.0, 66.0, 74.0, 82.0, 98.0] {
            let coarse = steady(&model, &at(speed, f));
            let tolerance = Tolerance { steps: 400, roughness: 1e-5, ..Tolerance::default() };
            let fine = solve(&model, &at(speed, f), 0, &tolerance, false, &mut Warm::default()).state;
            assert_eq!(coarse.status, Status::Steady);
            assert!(distance(&coarse, &fine) < 1e-6, "{speed} {f}: {:e}", distance(&coarse, &fine));
        }
    }
}

#[test]
fn formulations_differ_by_less_than_half_a_percent() {
    let mut largest = 0.0f64;
    for speed in [5e-6, 2e-5, 5e-5, 1e-4, 1.4e-4] {
        for f in [66.0, 71.0, 76.0, 81.0] {
            let series = steady(&paper_model(Series), &at(speed, f)).amplitude;
            let paper = steady(&paper_model(Paper), &at(speed, f)).amplitude;
            largest = largest.max((paper / series - 1.0).abs());
        }
    }
    assert!(largest > 1e-3 && largest < 5e-3, "{largest}");
}

#[test]
fn derivatives_agree_with_differences() {
    let base = paper_model(Series);
    type Knob = for<'a> fn(&'a mut Model, &'a mut Operation) -> &'a mut f64;
    let knobs: [(usize, Knob); 13] = [
        (0, |m, _| &mut m.rig.arm_mut().inertia),
        (1, |m, _| &mut m.rig.arm_mut().torsional_stiffness),
        (2, |m, _| &mut m.rig.arm_mut().torsional_damping),
        (3, |m, _| &mut m.rig.arm_mut().spring_stiffness),
        (4, |m, _| &mut m.rig.arm_mut().spring_damping),
        (5, |m, _| &mut m.rig.arm_mut().spring_arm),
        (6, |m, _| &mut m.rig.arm_mut().contact_arm),
        (7, |m, _| &mut m.contact.stiffness),
        (8, |m, _| &mut m.contact.damping),
        (10, |m, _| &mut m.instrument.drive_gain),
        (11, |m, _| &mut m.instrument.amplitude_gain),
        (13, |_, at| &mut at.speed),
        (15, |_, at| &mut at.drive),
    ];
    let tolerance = Tolerance { steps: 200, roughness: 1e-5, ..Tolerance::default() };
    let run = |model: &Model, at: &Operation, with| solve(model, at, 0, &tolerance, with, &mut Warm::default());
    for operation in [at(5e-5, 72.0), at(0.02, 72.0), Operation { load: 0.1, drive: 7.5e-6, ..at(0.0, 78.0) }] {
        let solution = run(&base, &operation, true);
        let derivatives = solution.derivatives.unwrap();
        for (index, knob) in knobs {
            let sample = |sign: f64| {
                let (mut model, mut op) = (base.clone(), operation);
                let value = knob(&mut model, &mut op);
                let step = 1e-5 * *value;
                *value += sign * step;
                (step, complex(&run(&model, &op, false).state))
            };
            let ((step, plus), (_, minus)) = (sample(1.0), sample(-1.0));
            if step == 0.0 {
                continue;
            }
            let (da, dp) = derivatives[index];
            let (alpha, phi) = (solution.state.amplitude, solution.state.phase);
            let expected = ((plus.0 - minus.0) / (2.0 * step), (plus.1 - minus.1) / (2.0 * step));
            let given = (da * phi.cos() - alpha * dp * phi.sin(), da * phi.sin() + alpha * dp * phi.cos());
            let error = (given.0 - expected.0).hypot(given.1 - expected.1);
            let size = expected.0.hypot(expected.1);
            assert!(
                error < 2e-5 * size.max(1e-3 * alpha / step * 1e-5),
                "{operation:?} parameter {index}: {given:?} {expected:?}"
            );
        }
    }
}

#[test]
fn contact_without_damping_and_very_stiff_contact_have_steady_states() {
    for (kc, cc) in [(8.9e4, 0.0), (8.9e4, 1e-6), (8.9e6, 26.0), (8.9e7, 2.6e4)] {
        let mut model = paper_model(Series);
        (model.contact.stiffness, model.contact.damping) = (kc, cc);
        for operation in [at(5e-5, 72.0), at(1e-4, 71.0), Operation { load: 0.1, drive: 7.5e-6, ..at(0.0, 74.0) }] {
            let state = steady(&model, &operation);
            assert_eq!(state.status, Status::Steady, "kc {kc} cc {cc} {operation:?}");
        }
    }
}

#[test]
fn euler_procedure_reports_divergence() {
    let model = paper_model(Paper);
    let state = solve(&model, &at(1e-4, 74.0), 6, &Tolerance::default(), false, &mut Warm::default()).state;
    assert!(matches!(state.status, Status::Failed(_) | Status::SelfExcited(_)), "{state:?}");
}

#[test]
fn quality_factors_up_to_5000_are_solved_to_1e_5() {
    let mut model = paper_model(Series);
    model.rig.arm_mut().spring_damping = 0.0;
    let stiffness = 1018.8f64;
    model.rig.arm_mut().torsional_damping = (stiffness * model.rig.arm().inertia).sqrt() / 5000.0;
    let natural = (stiffness / model.rig.arm().inertia).sqrt() / std::f64::consts::TAU;
    for (speed, offset) in [(1e-4, -0.5), (5e-4, 0.0), (0.02, 0.0), (2e-5, 2.0), (3e-3, 0.01), (0.0, 0.1)] {
        let operation = Operation { load: if speed == 0.0 { 0.1 } else { 20.0 }, ..at(speed, natural + offset) };
        let state = steady(&model, &operation);
        let tolerance = Tolerance { steps: 600, roughness: 1e-5, ..Tolerance::default() };
        let fine = solve(&model, &operation, 0, &tolerance, false, &mut Warm::default()).state;
        assert_eq!((&state.status, &fine.status), (&Status::Steady, &Status::Steady), "{operation:?}");
        assert!(distance(&state, &fine) < 1e-5, "{operation:?}: {:e}", distance(&state, &fine));
        // The transient would take thousands of cycles.
        assert!(state.cycles < 150, "{operation:?}: {} cycles", state.cycles);
    }
}
