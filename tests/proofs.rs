//! The checks that every report prints: each holds, and none has vanished.

use std::collections::BTreeSet;
use stickslip::scenario::{EffectSetting, Formulation, Scenario};
use stickslip::sweep::{Options, run};
use stickslip::{effects, scenario, verification};

/// Names in the order of the report, those of the effects apart.
const NAMES: [&str; 38] = [
    "Peak frequency, case I/III",
    "Peak amplitude, case I/III",
    "Speed at which sticking starts",
    "Peak frequency, case II",
    "Peak amplitude, case II",
    "Limiting cases by shooting",
    "Independence of friction",
    "Collapse on V/u0",
    "Paper against series formulation",
    "Discretisation error of shooting",
    "Den Hartog, r = 0.8, zeta = 0.05, beta = 0.2",
    "Den Hartog, r = 1.2, zeta = 0.05, beta = 0.2",
    "Den Hartog, r = 0.9, zeta = 0.1, beta = 0.3",
    "Den Hartog, r = 1, zeta = 0.1, beta = 0.4",
    "Jenkins element, A = 1.2, secant stiffness",
    "Jenkins element, A = 1.2, quadrature",
    "Jenkins element, A = 1.2, loop energy",
    "Jenkins element, A = 2, secant stiffness",
    "Jenkins element, A = 2, quadrature",
    "Jenkins element, A = 2, loop energy",
    "Jenkins element, A = 5, secant stiffness",
    "Jenkins element, A = 5, quadrature",
    "Jenkins element, A = 5, loop energy",
    "Masing loop, secant stiffness",
    "Masing loop, quadrature",
    "Hertz-Mindlin-Cattaneo, q = 0.3, loop energy",
    "Hertz-Mindlin-Cattaneo, q = 0.7, loop energy",
    "Hertz-Mindlin-Cattaneo, q = 0.95, loop energy",
    "Duffing, bend of the backbone",
    "Maxwell branch",
    "Maxwell branch by shooting",
    "Rate strengthening in full slip",
    "Rate-and-state in full slip",
    "LuGre in full slip",
    "Critical stiffness of rate-and-state",
    "Order of the Euler procedure",
    "Order of the time integration",
    "Order of shooting",
];

/// Effects whose period is not one cycle of one system.
const SLIDERS: [&str; 3] = ["partial-slip", "spring-pot", "berg-friction"];

#[test]
fn every_check_holds_and_none_has_vanished() {
    let checks = verification::run();
    for check in &checks {
        assert!(check.holds(), "{check:?}");
        assert!(check.tolerance <= 0.1 && check.difference.is_finite());
    }
    let effects = effects::REGISTRY.iter().filter(|effect| effects::fits_rig(**effect, true).is_ok());
    let effects = effects.map(|effect| effect.name()).filter(|name| !SLIDERS.contains(name));
    let balances = effects.flat_map(|name| [format!("Energy balance, {name}"), format!("Contact dissipates, {name}")]);
    let expected: Vec<String> = NAMES.iter().map(|name| name.to_string()).chain(balances).collect();
    let found: Vec<String> = checks.into_iter().map(|check| check.name).collect();
    assert_eq!(found, expected);
}

#[test]
fn a_check_without_a_number_does_not_hold() {
    let check = verification::Check {
        name: String::new(),
        compares: String::new(),
        unit: "1",
        expected: None,
        computed: None,
        difference: f64::NAN,
        tolerance: f64::INFINITY,
    };
    assert!(!check.holds());
}

/// Besides the typical parameters of the checks: those of the reference table.
#[test]
fn energy_is_balanced_for_the_effects_of_the_reference_table() {
    let mut names = BTreeSet::new();
    for line in include_str!("data/effects.csv").lines().skip(1) {
        let (name, rest) = line.split_once(',').unwrap();
        let (words, _) = rest.split_once(',').unwrap();
        if name == "none" || SLIDERS.contains(&name) || !names.insert(name) {
            continue;
        }
        let effect = effects::find(name).unwrap();
        let value = |key: &str| words.split(' ').find_map(|w| w.strip_prefix(key)?.strip_prefix('=')?.parse().ok());
        let stated = |(i, p): (usize, &effects::ParameterInfo)| value(p.key).or_else(|| effect.unstated(i)).unwrap();
        let parameters: Vec<f64> = effect.parameters().iter().enumerate().map(stated).collect();
        for check in verification::energy_balance(effect, &parameters) {
            assert!(check.holds(), "{check:?}");
        }
    }
    let beside_contact = effects::REGISTRY.iter().filter(|effect| effects::fits_rig(**effect, true).is_ok());
    assert_eq!(names.len(), beside_contact.count() - SLIDERS.len(), "{names:?}");
}

/// A scenario of the paper in the series formulation alone, at every tenth frequency.
fn thinned(name: &str, effect: Option<EffectSetting>) -> Scenario {
    let mut scenario = scenario::load_embedded(name).unwrap();
    scenario.effects.extend(effect);
    let sweep = scenario.sweep.as_mut().unwrap();
    sweep.formulation = vec![Formulation::Series];
    sweep.frequency = sweep.frequency.iter().copied().step_by(10).collect();
    scenario
}

#[test]
fn two_solvers_agree_on_points_of_all_scenarios() {
    let partial_slip = EffectSetting { effect: effects::find("partial-slip").unwrap(), parameters: vec![2.0] };
    let scenarios = [
        thinned("paper/figure-5", None),
        thinned("paper/figure-6", None),
        thinned("paper/figure-5", Some(partial_slip)),
    ];
    let outcomes = scenarios.map(|scenario| run(&scenario, &Options::default()));
    let checks = verification::numerical_error(outcomes.iter().flat_map(verification::solved_twice).collect());
    let names: Vec<&str> = checks.iter().map(|check| check.name.as_str()).collect();
    assert_eq!(names, ["Two solvers", "Two solvers, continua of sliders"]);
    for check in &checks {
        assert!(check.holds() && check.difference > 0.0, "{check:?}");
        assert!(check.compares.contains("the largest difference is at paper/figure-"), "{check:?}");
    }
    assert!(checks[0].compares.contains("at 12 points") && checks[1].compares.contains("at 6 points"));
    // A wrong answer is found where it was sampled.
    let [mut wrong, ..] = outcomes;
    wrong.curves.iter_mut().flat_map(|curve| &mut curve.states).for_each(|state| state.amplitude *= 1.0001);
    assert!(!verification::numerical_error(verification::solved_twice(&wrong))[0].holds());
    assert!(verification::numerical_error(Vec::new()).is_empty());
}
