//! Laws of a rig without a contact: rows of a separate program, closed forms, limiting cases, derivatives.

mod common;

use common::oscillator;
use std::f64::consts::{PI, TAU};
use stickslip::effects::{ParameterInfo, find};
use stickslip::model::{Model, Operation};
use stickslip::solver::cycle::Tolerance;
use stickslip::solver::{Solution, Status, Warm, solve_steady};

/// What `tests/reference/effects.py` integrated.
const TABLE: &str = include_str!("data/effects-alone.csv");

fn with(model: &Model, name: &str, parameters: &[f64]) -> Model {
    let mut model = model.clone();
    model.effects.push((find(name).expect("registered"), parameters.to_vec()));
    model
}

fn at(force: f64, frequency: f64) -> Operation {
    Operation { speed: 0.0, load: 0.0, drive: force, frequency, series: 0 }
}

fn solved(model: &Model, at: &Operation) -> Solution {
    solve_steady(model, at, &Tolerance::default(), true, &mut Warm::default())
}

fn complex(solution: &Solution) -> (f64, f64) {
    common::complex(&solution.state)
}

/// Mass, resonance, quality factor, force of the tests; stiffness, damping, and the largest motion of the linear mode.
const OF: (f64, f64, f64, f64) = (3.0, 7.0, 40.0, 2.0);
fn sizes() -> (f64, f64, f64) {
    let (mass, f0, quality, force) = OF;
    let k = mass * (TAU * f0).powi(2);
    (k, (k * mass).sqrt() / quality, force * quality / k)
}

fn bare() -> Model {
    oscillator(OF.0, OF.1, OF.2)
}

#[test]
fn reference_rows_agree_to_1e_4() {
    let model = oscillator(2.0, 80.0, 30.0);
    let (mut wrong, mut rows) = (Vec::new(), 0);
    let mut largest: Vec<(&str, f64)> = Vec::new();
    for line in TABLE.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let effect = find(fields[0]).unwrap_or_else(|| panic!("{line}"));
        let value = |(index, info): (usize, &ParameterInfo)| {
            let pair = fields[1].split(' ').find_map(|pair| pair.strip_prefix(info.key)?.strip_prefix('='));
            let stated = pair.and_then(|value| value.parse().ok()).or_else(|| effect.unstated(index));
            stated.unwrap_or_else(|| panic!("{line}: {}", info.key))
        };
        let parameters: Vec<f64> = effect.parameters().iter().enumerate().map(value).collect();
        let v: Vec<f64> = fields[2..].iter().map(|v| v.parse().expect("a number")).collect();
        // Rows of a drift are of the second series.
        let place = Operation { series: 1, ..at(v[0], v[1]) };
        let state = solved(&with(&model, fields[0], &parameters), &place).state;
        rows += 1;
        if v[2] == 0.0 {
            assert_eq!((state.status, state.amplitude, state.phase), (Status::Stuck, 0.0, 0.0), "{line}");
            continue;
        }
        let mean = (state.mean - v[4]).abs() / v[2];
        let apart = (state.amplitude / v[2] - 1.0).abs().max((state.phase - v[3]).abs()).max(mean);
        if state.status != Status::Steady || apart.is_nan() || apart > 1e-4 {
            wrong.push(format!("{line}\n    {apart:.1e} {:?} {:e} {}", state.status, state.amplitude, state.phase));
        }
        match largest.last_mut() {
            Some((name, most)) if *name == fields[1] => *most = most.max(apart),
            _ => largest.push((fields[1], apart)),
        }
    }
    for (parameters, most) in largest {
        println!("{parameters:30} {most:.1e}");
    }
    assert!(wrong.is_empty(), "{} rows disagree:\n{}", wrong.len(), wrong.join("\n"));
    assert!(rows >= 100, "{rows}");
}

/// [(K - M w^2) + 5/8 K5 X^4]^2 + (w C)^2 = (f/X)^2, exact as the response tends to one harmonic.
#[test]
fn quintic_stiffness_is_that_of_one_harmonic() {
    let (mass, f0, quality, force) = (2.0, 80.0, 1e4, 1.0);
    let k = mass * (TAU * f0).powi(2);
    let motion = force * quality / k;
    for strength in [-1.0, 0.5, 2.0] {
        let k5 = strength * k / quality / motion.powi(4);
        let model = with(&oscillator(mass, f0, quality), "quintic-stiffness", &[k5]);
        for step in -10..=10 {
            let frequency = f0 * (1.0 + 0.2 * f64::from(step) / quality);
            let found = solved(&model, &at(force, frequency));
            assert_eq!(found.state.status, Status::Steady, "{strength} {step}");
            for x in [found.state.amplitude].into_iter().chain(found.others.iter().map(|o| o.0)) {
                let w = TAU * frequency;
                let balance = (k - mass * w * w + 0.625 * k5 * x.powi(4)).hypot(w * (k * mass).sqrt() / quality) * x;
                assert!((balance / force - 1.0).abs() < 1e-3, "{strength} {step}: {balance}");
            }
        }
    }
}

/// To the second order in K2: as a cubic stiffness of -10/9 K2^2/K, about a mean of -K2 X^2/(2K).
#[test]
fn a_weak_asymmetry_bends_like_a_softening_cubic() {
    let (mass, f0, quality, force): (f64, f64, f64, f64) = (2.0, 80.0, 1e4, 1.0);
    let k = mass * (TAU * f0).powi(2);
    let k2 = 0.8 * k / quality.sqrt() / (force * quality / k);
    let base = oscillator(mass, f0, quality);
    let (even, cubic) =
        (with(&base, "asymmetric-stiffness", &[k2]), with(&base, "cubic-stiffness", &[-10.0 / 9.0 * k2 * k2 / k]));
    for step in -10i32..=10 {
        let operation = at(force, f0 * (1.0 + 0.15 * f64::from(step) / quality));
        let (one, other) = (solved(&even, &operation), solved(&cubic, &operation));
        let apart = common::distance(&one.state, &other.state);
        let linear = common::distance(&solved(&base, &operation).state, &other.state);
        assert!(apart < 2e-3 && (linear > 1e-2 || step.abs() > 5), "{step}: {apart:e} {linear:e}");
        let mean = -k2 * one.state.amplitude.powi(2) / (2.0 * k);
        assert!((one.state.mean / mean - 1.0).abs() < 1e-2, "{step}: {:e} {mean:e}", one.state.mean);
    }
}

#[test]
fn both_branches_of_an_asymmetric_spring_are_found() {
    let (f0, quality): (f64, f64) = (50.0, 1e3);
    let k: f64 = (TAU * f0).powi(2);
    let model =
        with(&oscillator(1.0, f0, quality), "asymmetric-stiffness", &[3.0 * k / quality.sqrt() / (quality / k)]);
    let folded = (0..60).filter(|i| {
        let found = solved(&model, &at(1.0, f0 * (1.0 - 4.0 * f64::from(*i) / 60.0 / quality)));
        assert_eq!(found.state.status, Status::Steady, "{i}");
        !found.others.is_empty()
    });
    assert!(folded.count() > 5);
}

#[test]
fn stops_without_a_gap_are_a_spring() {
    let (k, ..) = sizes();
    let stopped = with(&bare(), "clearance", &[0.3 * k, 0.0]);
    let stiffer = oscillator(OF.0, OF.1 * 1.3f64.sqrt(), OF.2 * 1.3f64.sqrt());
    for ratio in [0.8, 1.0, 1.1, 1.14, 1.5] {
        let operation = at(OF.3, ratio * OF.1);
        let apart = common::distance(&solved(&stopped, &operation).state, &solved(&stiffer, &operation).state);
        assert!(apart < 1e-9, "{ratio}: {apart:e}");
    }
}

#[test]
fn powers_of_one_and_two_are_the_linear_and_the_quadratic_damping() {
    let (_, c, motion) = sizes();
    let speed = motion * TAU * OF.1;
    let more = oscillator(OF.0, OF.1, OF.2 / 1.5);
    let quadratic = with(&bare(), "quadratic-damping", &[c / speed]);
    for (p, same) in [(1.0, &more), (2.0, &quadratic)] {
        let d = c * speed * if p == 1.0 { 0.5 } else { 1.0 };
        let model = with(&bare(), "power-damping", &[d, p, speed]);
        for ratio in [0.9, 1.0, 1.01, 1.2] {
            let operation = at(OF.3, ratio * OF.1);
            let apart = common::distance(&solved(&model, &operation).state, &solved(same, &operation).state);
            // Of the quadratic law fewer instants of a cycle are looked at.
            assert!(apart < 1e-5, "{p} {ratio}: {apart:e}");
        }
    }
}

/// The exact motion without stops: its peak is Den Hartog's, its fundamental that of drive and square wave of the
/// friction.
#[test]
fn friction_in_the_pivot_is_that_of_den_hartog() {
    for (r, zeta, beta, peak) in
        [(0.8, 0.05, 0.2, 2.50014), (1.2, 0.05, 0.2, 1.96685), (0.9, 0.1, 0.3, 2.69765), (1.0, 0.1, 0.4, 2.45007)]
    {
        let transfer = |n: f64| {
            let (x, y): (f64, f64) = (1.0 - (n * r).powi(2), 2.0 * zeta * n * r);
            (x / (x * x + y * y), -y / (x * x + y * y))
        };
        // At the peak the velocity of drive and square wave is zero; sums over the odd harmonics of the square wave.
        let odd = || (0..200_000).map(|i| 2.0 * f64::from(i) + 1.0);
        let (along, speed) = odd().fold((0.0, 0.0), |(x, v), n| {
            let (re, im) = transfer(n);
            (x + 4.0 * beta / (PI * n) * im, v + 4.0 * beta / PI * re)
        });
        let (re, im) = transfer(1.0);
        let size: f64 = re.hypot(im);
        // x = size cos(wt + chi) + the answer to the square wave.
        let chi = (speed / size).asin();
        assert!((size * chi.cos() + along - peak).abs() < 2e-5, "{r}: {}", size * chi.cos() + along);
        // Of the square wave -i 4 beta/pi T; relative to the drive, whose phase at the peak is chi - arg T.
        let (x, y) = (size * chi.cos() + 4.0 * beta / PI * im, size * chi.sin() - 4.0 * beta / PI * re);
        let drive = chi - im.atan2(re);
        let expected = (x.hypot(y), y.atan2(x) - drive);
        let (mass, f0, force) = (3.0, 7.0, 2.0);
        let k = mass * (TAU * f0).powi(2);
        let model = with(&oscillator(mass, f0, 0.5 / zeta), "pivot-friction", &[beta * force]);
        let found = solved(&model, &at(force, r * f0)).state;
        assert_eq!((&found.status, found.stick_fraction), (&Status::Steady, 0.0), "{r}");
        let phase = stickslip::statistics::wrap(found.phase - expected.1);
        let amplitude = found.amplitude * k / force / expected.0 - 1.0;
        assert!(amplitude.abs() < 1e-6 && phase.abs() < 1e-6, "{r}: {amplitude:e} {phase:e}");
    }
}

#[test]
fn a_body_that_the_drive_cannot_move_sticks_and_stops_twice_a_cycle_just_above() {
    for (name, parameters) in [("pivot-friction", vec![OF.3]), ("power-damping", vec![OF.3, 0.0, 1.0])] {
        let model = with(&bare(), name, &parameters);
        let stuck = solved(&model, &at(0.999 * OF.3, OF.1));
        assert_eq!((stuck.state.status, stuck.state.amplitude, stuck.state.mean), (Status::Stuck, 0.0, 0.0), "{name}");
        assert_eq!((stuck.state.phase, stuck.state.stick_fraction), (0.0, 1.0));
        let derivatives = stuck.derivatives.expect("asked for");
        assert!(derivatives.iter().all(|d| *d == (0.0, 0.0)), "{name}");
        for more in [1.05, 1.2] {
            let state = solved(&model, &at(more * OF.3, 0.5 * OF.1)).state;
            assert_eq!(state.status, Status::Steady, "{name}");
            assert!(state.stick_fraction > 0.1 && state.stick_fraction < 0.95 && state.amplitude > 0.0, "{state:?}");
        }
    }
}

#[test]
fn residual_modes_are_added_to_the_reading() {
    let (c, m) = (2e-4, -0.3);
    let model = with(&bare(), "residual-modes", &[c, m]);
    for ratio in [0.7, 1.0, 1.2] {
        let operation = at(OF.3, ratio * OF.1);
        let (one, other) = (complex(&solved(&model, &operation)), complex(&solved(&bare(), &operation)));
        let share = (c + m / (TAU * operation.frequency).powi(2)) * OF.3;
        assert!((one.0 - other.0 - share).hypot(one.1 - other.1) < 1e-15, "{ratio}: {one:?} {other:?} {share:e}");
    }
}

/// A constant share of the force over the stiffness, whatever the motion.
#[test]
fn crosstalk_is_added_to_the_reading() {
    let (re, im) = (1.5, -4.0);
    let model = with(&bare(), "crosstalk", &[re, im]);
    for ratio in [0.7, 1.0, 1.2] {
        let operation = at(OF.3, ratio * OF.1);
        let (one, other) = (complex(&solved(&model, &operation)), complex(&solved(&bare(), &operation)));
        let deflection = OF.3 / sizes().0;
        let apart = (one.0 - other.0 - re * deflection).hypot(one.1 - other.1 - im * deflection);
        assert!(apart < 1e-12 * deflection, "{ratio}: {one:?} {other:?} {deflection:e}");
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let (k, _, motion) = sizes();
    let speed = motion * TAU * OF.1;
    let cases = [
        ("quintic-stiffness", vec![0.4 * k / OF.2 / motion.powi(4)]),
        ("asymmetric-stiffness", vec![0.6 * k / OF.2.sqrt() / motion]),
        ("clearance", vec![0.05 * k, 0.3 * motion]),
        ("power-damping", vec![0.3 * OF.3, 1.4, speed]),
        ("power-damping", vec![0.3 * OF.3, 0.6, 0.5 * speed]),
        ("pivot-friction", vec![0.4 * OF.3]),
        ("residual-modes", vec![2e-4, -0.3]),
        ("crosstalk", vec![0.8, -1.7]),
    ];
    for (name, parameters) in cases {
        // Beside a spring that is not linear.
        let model = with(&with(&bare(), "cubic-stiffness", &[0.2 * k / OF.2 / motion.powi(2)]), name, &parameters);
        for ratio in [0.9, 1.0, 1.05] {
            let operation = at(OF.3, ratio * OF.1);
            let found = solved(&model, &operation);
            let derivatives = found.derivatives.expect("asked for");
            for index in (0..3).chain([15]).chain(16..17 + parameters.len()) {
                let moved = |sign: f64| {
                    let (mut model, mut operation) = (model.clone(), operation);
                    let slot = model.parameter(&mut operation, index).expect("a parameter");
                    let step = 1e-4 * slot.abs();
                    *slot += sign * step;
                    let state = solved(&model, &operation).state;
                    (state.amplitude / found.state.amplitude, state.phase, step)
                };
                let (plus, minus) = (moved(1.0), moved(-1.0));
                let by = ((plus.0 - minus.0) / 2e-4, (plus.1 - minus.1) / 2e-4);
                let relative = 1e4 * plus.2;
                let (amplitude, phase) =
                    (derivatives[index].0 * relative / found.state.amplitude, derivatives[index].1 * relative);
                let scale = by.0.hypot(by.1);
                let error = (amplitude - by.0).hypot(phase - by.1);
                // Corners of a force lie between the instants of a cycle.
                let close = if ["clearance", "power-damping"].contains(&name) { 1e-2 } else { 2e-3 };
                assert!(
                    error < close * scale + 2e-5,
                    "{name} {ratio} {index}: {amplitude} {phase}, differences {by:?}"
                );
            }
        }
    }
}

#[test]
fn a_power_of_the_velocity_needs_no_velocity_to_be_stated() {
    let rig = "title = \"Power\"\nprovenance = \"none\"\n[rig]\nkind = \"oscillator\"\nmass = 2\nnatural_frequency = \"80 Hz\"\nquality_factor = 300\ndrive = \"force\"\n";
    let sweep = "[sweep]\nfrequency = 80\ndrive = 1\n";
    let of = |more: &str| {
        let text = format!("{rig}{sweep}[[effect]]\nname = \"power-damping\"\nD = 3\np = 1.5\n{more}");
        let scenario = stickslip::scenario::load_text("/nowhere/power.toml", &text).expect("a sound scenario");
        scenario.effects[0].parameters.clone()
    };
    assert_eq!(of(""), of("v_0 = 1\n"));
    assert_eq!(of(""), [3.0, 1.5, 1.0]);
}

/// A fit balances harmonics where what is reported is integrated from rest to rest.
#[test]
fn what_a_fit_makes_of_a_steep_damping_is_what_is_reported() {
    let speed = sizes().2 * TAU * OF.1;
    for p in [0.15, 0.3, 0.5, 0.8] {
        for share in [0.1, 0.4, 0.7] {
            let model = with(&bare(), "power-damping", &[share * OF.3, p, speed]);
            for ratio in [0.95, 0.999, 1.0, 1.005, 1.05] {
                let operation = at(OF.3, ratio * OF.1);
                let reported = solved(&model, &operation).state;
                for tolerance in [Tolerance::COARSE, Tolerance::FIT] {
                    let fitted = solve_steady(&model, &operation, &tolerance, true, &mut Warm::default()).state;
                    let apart = common::distance(&fitted, &reported);
                    // The nearer to dry friction, the less smooth the motion.
                    let close = if p < 0.5 { 3e-3 } else { 1e-4 };
                    assert!(apart < close, "{p} {share} {ratio}: {apart:e}");
                }
            }
        }
    }
}
