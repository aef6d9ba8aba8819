//! States that are not steady are reported as such, and none is silently wrong.

mod common;

use common::{at, paper_model, steady};
use stickslip::effects;
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::Series;
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
    for effect in effects::REGISTRY {
        for _ in 0..20 {
            let value = |p: &effects::ParameterInfo, u: f64| {
                let (low, high) = p.range.unwrap_or((p.minimum, p.maximum));
                let low = low.max(1e-3 * high);
                low * (high / low).powf(u)
            };
            let parameters: Vec<f64> = effect.parameters().iter().map(|p| value(p, uniform())).collect();
            let speed = [0.0, 5e-5, 2e-3, 0.02][(uniform() * 4.0) as usize];
            let load = [0.1, 20.0][(uniform() * 2.0) as usize];
            let operation = Operation { speed, load, drive: 2.5e-6, frequency: 60.0 + 30.0 * uniform() };
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
