//! The whole catalogue: documented, nested in the base, differentiated, and equal to an independent integration.

mod common;

use common::{EULER_STEPS, Random, paper_model, steady};
use stickslip::effects::{Effect, Law, Measure, ParameterInfo, REGISTRY, find, fits_rig, typical};
use stickslip::model::{Model, Operation};
use stickslip::parameter::FIRST_EFFECT_PARAMETER;
use stickslip::scenario::Formulation::Series;
use stickslip::solver::{Solution, Status, Warm, cycle::Tolerance, solve};
use stickslip::units;

const TABLE: &str = include_str!("data/effects.csv");

/// One steady state of the separate program.
struct Row {
    effect: &'static dyn Effect,
    parameters: Vec<f64>,
    at: Operation,
    amplitude: f64,
    phase: f64,
    line: &'static str,
}

fn rows() -> Vec<Row> {
    let effects = TABLE.lines().skip(1).filter(|line| !line.starts_with("none,"));
    effects
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let effect = find(fields[0]).unwrap_or_else(|| panic!("{line}"));
            let value = |(index, info): (usize, &ParameterInfo)| {
                let pair = fields[1].split(' ').find_map(|pair| pair.strip_prefix(info.key)?.strip_prefix('='));
                let stated = pair.and_then(|value| value.parse().ok()).or_else(|| effect.unstated(index));
                stated.unwrap_or_else(|| panic!("{line}: {}", info.key))
            };
            let parameters = effect.parameters().iter().enumerate().map(value).collect();
            let v: Vec<f64> = fields[2..8].iter().map(|v| v.parse().unwrap()).collect();
            // Rows of a drift are of the second series, and to others that is no matter.
            let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3], series: 1 };
            Row { effect, parameters, at, amplitude: v[4], phase: v[5], line }
        })
        .collect()
}

fn with(effect: &'static dyn Effect, parameters: Vec<f64>) -> Model {
    Model { effects: vec![(effect, parameters)], ..paper_model(Series) }
}

/// The parameters that the reference table has for an effect.
fn tabulated(effect: &dyn Effect) -> Vec<f64> {
    rows().into_iter().find(|row| row.effect.name() == effect.name()).expect("a row").parameters
}

/// The effects that act on the paper's rig; those of a rig without a contact are tested in `tests/oscillator.rs`.
fn beside_contact() -> impl Iterator<Item = &'static dyn Effect> {
    REGISTRY.iter().copied().filter(|effect| fits_rig(*effect, true).is_ok())
}

/// Static contact, partial stick at two loads, full slip, and slip both ways at a low load.
const CONDITIONS: [(f64, f64, f64); 5] =
    [(0.0, 20.0, 2.5e-6), (5e-5, 20.0, 2.5e-6), (1e-4, 10.0, 2.5e-6), (0.02, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6)];

#[test]
fn every_effect_is_documented() {
    let sentence = |text: &str| text.ends_with('.') && text.len() > 30 && !text.contains("  ");
    for effect in REGISTRY {
        let name = effect.name();
        let kebab = name.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        assert!(kebab && !name.starts_with('-') && !name.ends_with('-'), "{name}");
        assert_eq!(REGISTRY.iter().filter(|other| other.name() == name).count(), 1, "{name}");
        assert!(!effect.title().is_empty() && !effect.equation().is_empty(), "{name}");
        for text in [effect.meaning(), effect.source(), effect.fingerprint()] {
            assert!(sentence(text), "{name}: {text}");
        }
        if fits_rig(*effect, true).is_err() {
            assert!(effect.fingerprint().contains("Without contact"), "{name}");
            continue;
        }
        for state in ["V = 0", "artial stick", "ull slip"] {
            assert!(effect.fingerprint().contains(state), "{name}: {state}");
        }
        assert!(rows().iter().any(|row| row.effect.name() == name), "{name} is not in the reference table");
    }
}

#[test]
fn every_parameter_has_a_unit_limits_and_a_range_within_them() {
    for effect in REGISTRY {
        let infos = effect.parameters();
        // A law has a derivative for each of four.
        let most = if effect.of_series().is_some() { 16 } else { 4 };
        assert!((1..=most).contains(&infos.len()), "{}", effect.name());
        // Numbers of the registry are also those of the keys that a fit moves.
        assert!(infos.is_sorted_by_key(|info| info.held), "{}", effect.name());
        for info in infos {
            let what = format!("{} {}", effect.name(), info.key);
            assert!(!info.key.is_empty() && !info.symbol.is_empty() && !info.meaning.is_empty(), "{what}");
            assert_eq!(units::parse(&format!("1 {}", info.unit), info.unit), Ok(1.0), "{what}");
            let (low, high) = info.range.expect("a range");
            assert!(0.0 <= low && low < high && info.minimum <= low && high <= info.maximum, "{what}");
            assert_eq!(info.signed, info.minimum < 0.0, "{what}");
            // A range with a unit would be that of one size of rig.
            let pure = ["1", "decades"].contains(&info.unit);
            assert!(pure || info.measure != Measure::Number, "{what}");
            assert!(!info.signed || info.minimum <= -high, "{what}");
            assert_eq!(infos.iter().filter(|other| other.key == info.key).count(), 1, "{what}");
        }
        for zero in effect.zero() {
            let info = &infos[zero.parameter];
            assert!(zero.value.is_infinite() || (info.minimum..=info.maximum).contains(&zero.value), "{}", info.key);
        }
        for (value, info) in typical(*effect).iter().zip(infos) {
            assert!((info.minimum..=info.maximum).contains(value), "{} {}", effect.name(), info.key);
        }
    }
}

#[test]
fn zero_strength_is_the_base() {
    // Fine enough for the limiting cases too, which are closed forms in the base and shot at with some effects.
    let fine = Tolerance { steps: 512, roughness: 1e-3, ..Tolerance::default() };
    let steady =
        |model: &Model, at: &Operation| solve(model, at, EULER_STEPS, &fine, false, &mut Warm::default()).state;
    let base = paper_model(Series);
    for effect in beside_contact().filter(|effect| !effect.zero().is_empty()) {
        let mut parameters = tabulated(effect);
        let mut tolerance = 1e-10;
        for zero in effect.zero() {
            parameters[zero.parameter] = zero.value;
            if zero.value.is_infinite() {
                // Approached with 1/strength: what is left is of the order of kc/k_r, V/(w len) or W V/P_0.
                parameters[zero.parameter] = 1e12;
                tolerance = 2e-7;
            }
        }
        let model = with(effect, parameters);
        for (speed, load, drive) in CONDITIONS {
            for frequency in [62.0, 71.0, 84.0] {
                // Of the first series nothing drifts.
                let at = Operation { speed, load, drive, frequency, series: 1 };
                let (with, without) = (steady(&model, &at), steady(&base, &at));
                let what = format!("{} {at:?} {:?}", effect.name(), with.status);
                let error = common::distance(&with, &without);
                assert!(error <= tolerance, "{what}: {error:e}");
                let shift = (with.mean - without.mean).abs();
                assert!(shift <= tolerance * without.mean.abs().max(1e-3), "{what}: mean shifted by {shift:e}");
            }
        }
    }
}

#[test]
fn reference_rows_agree_to_1e_4() {
    let mut wrong = Vec::new();
    let mut largest: Vec<(&str, f64, f64)> = Vec::new();
    for row in rows() {
        let state = steady(&with(row.effect, row.parameters.clone()), &row.at);
        let (amplitude, phase) = ((state.amplitude / row.amplitude - 1.0).abs(), (state.phase - row.phase).abs());
        if state.status != Status::Steady || amplitude.is_nan() || amplitude > 1e-4 || phase > 1e-4 {
            wrong.push(format!("{}\n    {amplitude:.1e} {phase:.1e} {:?}", row.line, state.status));
        }
        match largest.last_mut() {
            Some((name, a, p)) if *name == row.effect.name() => (*a, *p) = (a.max(amplitude), p.max(phase)),
            _ => largest.push((row.effect.name(), amplitude, phase)),
        }
    }
    for (name, amplitude, phase) in largest {
        println!("{name:20} {amplitude:.1e} {phase:.1e}");
    }
    assert!(wrong.is_empty(), "{} rows disagree:\n{}", wrong.len(), wrong.join("\n"));
}

/// A law with its parameters and two arguments.
type Contribution<'a> = &'a dyn Fn(&[f64], f64, f64) -> Option<Law>;

/// Checks the partial derivatives of one law against central differences.
fn check(law: Contribution<'_>, p: &[f64], first: f64, second: f64, what: &str) {
    let Some(at) = law(p, first, second) else { return };
    let value = |p: &[f64], first: f64, second: f64| law(p, first, second).expect("a law stays one").value;
    let compare = |name: &str, x: f64, slope: f64, f: &dyn Fn(f64) -> f64| {
        let h = 1e-6 * x.abs();
        let difference = (f(x + h) - f(x - h)) / (2.0 * h);
        let error = (slope - difference).abs() * x.abs();
        let scale = 1e-3 + at.value.abs() + (slope * x).abs();
        assert!(slope.is_finite() && error <= 1e-6 * scale, "{what} {name}: {slope:e}, differences {difference:e}");
    };
    compare("first", first, at.d_first, &|x| value(p, x, second));
    compare("second", second, at.d_second, &|x| value(p, first, x));
    for (i, (&value_i, &slope)) in p.iter().zip(&at.d_parameters).enumerate() {
        compare(&format!("parameter {i}"), value_i, slope, &|x| {
            let mut p = p.to_vec();
            p[i] = x;
            value(&p, first, second)
        });
    }
}

#[test]
fn derivatives_of_the_laws_match_differences() {
    let mut random = Random(1);
    for effect in REGISTRY {
        for _ in 0..300 {
            let mut p = Vec::new();
            for info in effect.parameters() {
                let magnitude = random.between(info.range.expect("a range"));
                p.push(if info.signed && random.next() < 0.5 { -magnitude } else { magnitude });
            }
            let (s, psi) = (random.between((1e-9, 10.0)), random.between((1e-9, 1e3)));
            let what = format!("{} {p:?} at {s:e}, {psi:e}", effect.name());
            check(&|p, s, psi| effect.friction(p, s, psi), &p, s, psi, &what);
            check(&|p, s, psi| effect.interface_rate(p, s, psi), &p, s, psi, &what);
            let mut turn = || random.between((1e-8, 0.1)) * if random.next() < 0.5 { -1.0 } else { 1.0 };
            let (th, w) = (turn(), turn());
            check(&|p, th, w| effect.torque(p, th, w), &p, th, w, &format!("{what} {th:e} {w:e}"));
        }
    }
}

#[test]
fn laws_are_finite_for_whatever_the_solver_tries() {
    let mut random = Random(2);
    for effect in REGISTRY {
        for _ in 0..100 {
            let p: Vec<f64> = effect.parameters().iter().map(|i| random.between(i.range.expect("a range"))).collect();
            for s in [0.0, 1e-300, 1e-12, 1e3, 1e12] {
                for psi in [-1e-3, 0.0, 1e-12, 1e12] {
                    for law in [effect.friction(&p, s, psi), effect.interface_rate(&p, s, psi)].into_iter().flatten() {
                        let all = [law.value, law.d_first, law.d_second].into_iter().chain(law.d_parameters);
                        assert!(all.into_iter().all(f64::is_finite), "{} {p:?} {s} {psi} {law:?}", effect.name());
                    }
                }
            }
        }
    }
}

#[test]
fn derivatives_of_steady_states_match_differences() {
    let fine = Tolerance { steps: 400, roughness: 1e-5, ..Tolerance::default() };
    let solved = |model: &Model, at: &Operation, derivatives: bool| -> Solution {
        solve(model, at, EULER_STEPS, &fine, derivatives, &mut Warm::default())
    };
    for effect in beside_contact() {
        let p = tabulated(effect);
        for (speed, load, drive) in [(0.0, 0.1, 7.5e-6), (1e-4, 10.0, 2.5e-6), (0.02, 20.0, 2.5e-6)] {
            let at = Operation { speed, load, drive, frequency: 73.0, series: 1 };
            let solution = solved(&with(effect, p.clone()), &at, true);
            let what = format!("{} {at:?}", effect.name());
            let gradient = solution.derivatives.unwrap_or_else(|| panic!("{what}: {:?}", solution.state.status));
            for (i, info) in effect.parameters().iter().enumerate() {
                let shifted = |relative: f64| {
                    let mut p = p.clone();
                    p[i] *= 1.0 + relative;
                    solved(&with(effect, p), &at, false).state
                };
                let h = 1e-3;
                let (up, down) = (shifted(h), shifted(-h));
                let by_amplitude = (up.amplitude - down.amplitude) / (2.0 * h * solution.state.amplitude);
                let by_phase = (up.phase - down.phase) / (2.0 * h);
                let (amplitude, phase) = gradient[FIRST_EFFECT_PARAMETER + i];
                let (amplitude, phase) = (amplitude * p[i] / solution.state.amplitude, phase * p[i]);
                let scale = amplitude.abs().max(phase.abs());
                let error = (amplitude - by_amplitude).abs().max((phase - by_phase).abs());
                // The elements of the continuum move with its exponent: their number shows in this derivative.
                let relative = if effect.name() == "partial-slip" { 3e-3 } else { 1e-4 };
                assert!(
                    error < relative * scale + 1e-8,
                    "{what} {}: {amplitude:e} {phase:e}, differences {by_amplitude:e} {by_phase:e}",
                    info.key
                );
            }
        }
    }
}

#[test]
fn the_example_of_every_page_is_a_valid_scenario() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scenario.toml");
    let base = include_str!("broken/base.toml");
    for effect in REGISTRY {
        let example = stickslip::cli::effects::example(*effect);
        let alone = fits_rig(*effect, true).is_err();
        let oscillator = "title = \"x\"\n[rig]\nkind = \"oscillator\"\ncoordinate = \"angle\"\nnatural_frequency = 72\n\
                          quality_factor = 9\n[sweep]\nfrequency = 72\ndrive = 1\n";
        let sweep = "[sweep]\nfrequency = 72\nspeed = 0.02\nload = 20\ndrive = 2.5e-6\n";
        let rig = if alone { oscillator.to_string() } else { format!("{base}\n{sweep}") };
        std::fs::write(&path, format!("{rig}\n{example}")).expect("a file");
        let scenario = stickslip::scenario::load(&path).unwrap_or_else(|error| panic!("{error}"));
        for (read, meant) in scenario.effects[0].parameters.iter().zip(typical(*effect)) {
            assert!((read / meant - 1.0).abs() < 1e-12, "{}", effect.name());
        }
    }
}

#[test]
fn microslip_far_below_gross_slip_is_that_of_the_continuum() {
    // n = 2 on first loading: F = kc x (1 - x/(2 xm)). By Masing's rule a stroke A gives the complex stiffness
    // kc [1 - A/(2 xm) + i (2/(3 pi)) A/xm]; what the damping cc changes of this correction is of the order w cc/kc.
    let effect = find("partial-slip").expect("registered");
    let (model, base) = (with(effect, vec![2.0]), paper_model(Series));
    let (rig, contact) = (*base.rig.arm(), base.contact);
    for frequency in [70.0, 74.0, 82.0, 94.0] {
        let at = Operation { speed: 0.0, load: 20.0, drive: 2.5e-6, frequency, series: 0 };
        let (with, without) = (steady(&model, &at), steady(&base, &at));
        let share = rig.contact_arm * without.amplitude * contact.stiffness / (2.0 * contact.friction * at.load);
        let coupling = rig.contact_arm * rig.contact_arm * contact.stiffness;
        let (re, im) = (-0.5 * share * coupling, 2.0 / (3.0 * std::f64::consts::PI) * share * coupling);
        // The response falls by the change of the stiffness over itself; torque of the drive over response gives the
        // latter.
        let w = std::f64::consts::TAU * frequency;
        let arm = rig.spring_arm * at.drive / without.amplitude;
        let (torque, angle) = (
            arm * rig.spring_stiffness.hypot(w * rig.spring_damping),
            (w * rig.spring_damping / rig.spring_stiffness).atan() - without.phase,
        );
        let (d_re, d_im) = (torque * angle.cos(), torque * angle.sin());
        let square = d_re * d_re + d_im * d_im;
        let expected = (-(re * d_re + im * d_im) / square, -(im * d_re - re * d_im) / square);
        let found = (with.amplitude / without.amplitude - 1.0, with.phase - without.phase);
        let error = (found.0 - expected.0).hypot(found.1 - expected.1) / expected.0.hypot(expected.1);
        assert!(error < 0.25, "{frequency} Hz: {found:?}, expected {expected:?}");
    }
}
