//! Harmonic balance of motions that stay in one mode: against shooting with fine steps and against time integration.

mod common;

use common::{Random, distance, paper_model};
use stickslip::effects::{Effect, REGISTRY, find, fits_rig, slides, typical};
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
use stickslip::solver::cycle::Tolerance;
use stickslip::solver::time::Plan;
use stickslip::solver::{Method, Solution, Status, Warm, integrated, solve, solve_steady};

/// Steps of the collocation method alone: an infinite roughness asks for just these.
const FINE: Tolerance = Tolerance { steps: 192, roughness: f64::INFINITY, cycles: 2000, budget: usize::MAX };
/// Draws per effect.
const DRAWS: usize = 60;

fn with(effect: &'static dyn Effect, parameters: Vec<f64>) -> Model {
    let mut model = paper_model(Series);
    model.effects.push((effect, parameters));
    model
}

/// An effect with parameters from its range at a point that is likely to stay in one mode: over a fast roller, or under
/// the paper's load over one at rest.
fn draw(effect: &'static dyn Effect, random: &mut Random) -> (Model, Operation) {
    let parameters = effect.parameters().iter().map(|info| random.between(info.range.expect("effects have ranges")));
    let model = with(effect, parameters.collect());
    let rests = random.next() < 0.2;
    let speed = if rests { 0.0 } else { random.between((1e-4, 0.1)) };
    let load = if rests { 20.0 } else { random.between((0.05, 30.0)) };
    (
        model,
        Operation {
            speed,
            load,
            drive: random.between((1e-6, 1e-5)),
            frequency: 45.0 + 60.0 * random.next(),
            series: 0,
        },
    )
}

fn cold(model: &Model, at: &Operation, tolerance: &Tolerance) -> Solution {
    solve_steady(model, at, tolerance, true, &mut Warm::default())
}

#[test]
fn agrees_with_shooting_over_the_ranges_of_all_effects() {
    let mut random = Random(3);
    let mut balanced = Vec::new();
    let single = |effect: &&&dyn Effect| !slides(**effect, &typical(**effect)) && fits_rig(**effect, true).is_ok();
    for &effect in REGISTRY.iter().filter(single) {
        let mut count = 0;
        for _ in 0..DRAWS {
            let (model, at) = draw(effect, &mut random);
            let found = cold(&model, &at, &Tolerance::default());
            if found.state.method != Method::HarmonicBalance {
                continue;
            }
            count += 1;
            let fine = cold(&model, &at, &FINE);
            let what = format!("{} {:?} {at:?}", effect.name(), model.effects[0].1);
            let (a, b) = (&found.state, &fine.state);
            assert_eq!((&a.status, &b.status), (&Status::Steady, &Status::Steady), "{what}");
            // Uniform steps lose a part of what they are good for over a kink.
            let most = if effect.name() == "quadratic-damping" { 5e-6 } else { 1e-6 };
            assert!(distance(a, b) < most, "{what}: {:e}", distance(a, b));
            assert!((a.mean - b.mean).abs() < 1e-6 * (b.amplitude + b.mean.abs()), "{what}: mean");
            assert!((a.stick_fraction - b.stick_fraction).abs() < 1e-9, "{what}: stick");
            let swing = (b.force_maximum - b.force_minimum).max(1e-3 * b.force_maximum);
            let force = (a.force_minimum - b.force_minimum).abs().max((a.force_maximum - b.force_maximum).abs());
            assert!(force < 1e-3 * swing, "{what}: force {a:?} {b:?}");
            let (Some(by), Some(fine)) = (&found.derivatives, &fine.derivatives) else {
                panic!("{what}: no derivatives")
            };
            for (index, (by, fine)) in by.iter().zip(fine).enumerate() {
                let (mut model, mut at) = (model.clone(), at);
                let value = model.parameter(&mut at, index).map_or(0.0, |value| value.abs());
                // Relative change of the complex amplitude by a relative change of the parameter.
                let size = |amplitude: f64, phase: f64| value * (amplitude / b.amplitude).hypot(phase);
                let error = size(by.0 - fine.0, by.1 - fine.1);
                assert!(error < 1e-4 * size(fine.0, fine.1) + 1e-5, "{what}: derivative {index}: {by:?} {fine:?}");
            }
        }
        if count > 0 {
            balanced.push((effect.name(), count));
        }
    }
    // Who has a law that is not linear; the others have closed forms and exact flows.
    let names: Vec<&str> = balanced.iter().map(|(name, _)| *name).collect();
    let friction = ["stribeck", "rate-strengthening", "grosch", "rate-and-state", "frictional-heating", "viscous-film"];
    let arm = ["lugre", "cubic-stiffness", "quintic-stiffness", "asymmetric-stiffness", "quadratic-damping"];
    assert_eq!(names, [&friction[..], &arm].concat());
    assert!(balanced.iter().all(|&(_, count)| count > DRAWS / 3), "{balanced:?}");
}

/// Motions that a careless search takes for steady: full slip that friction weakening blows up within a cycle, an
/// interface below the temperature at which friction would drive it, and a first guess at whose slip rate the law is
/// flat.
#[test]
fn leaves_what_does_not_stay_in_full_slip() {
    let point = |speed, load, drive, frequency| Operation { speed, load, drive, frequency, series: 0 };
    let unstable = [
        ("stribeck", vec![0.4947, 0.1912], point(0.04084, 13.04, 2.208e-6, 98.17)),
        ("frictional-heating", vec![0.2004, 2.091e-4], point(0.001960, 23.15, 3.346e-6, 67.56)),
    ];
    for (name, parameters, at) in unstable {
        let model = with(find(name).expect("known"), parameters);
        let found = solve_steady(&model, &at, &Tolerance::default(), false, &mut Warm::default()).state;
        assert!(found.method != Method::HarmonicBalance, "{name}: {found:?}");
        let followed = solve(&model, &at, 0, &Tolerance::default(), false, &mut Warm::default()).state;
        assert_eq!(followed.method, Method::TimeIntegration, "{name}: {followed:?}");
        assert!(followed.force_maximum > 0.0, "{name}: {followed:?}");
    }
    let model = with(find("grosch").expect("known"), vec![0.33235, 0.18436, 0.31030]);
    let at = point(1.1275891e-4, 19.599196, 2.9815117e-6, 72.316779);
    let found = solve(&model, &at, 0, &Tolerance::default(), false, &mut Warm::default()).state;
    let time = integrated(&model, &at, &Plan { steps: 2000, ..Plan::default() });
    assert!(time.periodic && (found.amplitude / time.amplitude - 1.0).abs() < 1e-5, "{found:?} {time:?}");
    assert!(found.stick_fraction > 0.3, "{found:?}");
}

/// A neighbour on another branch is not left for the one that a cold start finds.
#[test]
fn a_sweep_stays_on_its_branch() {
    // A hardening spring over a fast roller: three periodic states between the jumps.
    let model = with(find("cubic-stiffness").expect("known"), vec![4e12]);
    let at = |frequency| Operation { speed: 0.1, load: 0.02, drive: 1e-5, frequency, series: 0 };
    let frequencies: Vec<f64> = (0..=120).map(|i| 60.0 + 0.5 * f64::from(i)).collect();
    let sweep = |frequencies: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
        let mut warm = Warm::default();
        let steady = |f| solve_steady(&model, &at(f), &Tolerance::default(), false, &mut warm).state.amplitude;
        frequencies.map(steady).collect()
    };
    let up = sweep(&mut frequencies.iter().copied());
    let mut down = sweep(&mut frequencies.iter().rev().copied());
    down.reverse();
    let differ = up.iter().zip(&down).filter(|(up, down)| (*up - *down).abs() > 0.1 * **up).count();
    assert!(differ > 4, "{differ} {up:?} {down:?}");
    assert!(up.iter().zip(&down).all(|(up, down)| *up > 0.999 * down), "the upper branch is followed upwards");
}
