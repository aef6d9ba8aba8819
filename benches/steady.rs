//! Time per steady state: every effect in three regimes, cold and warm, derivatives, the published procedure, threads.
//!
//! `cargo bench --bench steady`, or a part of it: `cargo bench --bench steady -- cold`. Every benchmark of a steady
//! state runs over the same 24 frequencies in each sample, so that the times shown are means over a resonance curve.

#[path = "../tests/common/mod.rs"]
mod common;

use common::paper_model;
use divan::{Bencher, counter::ItemsCount};
use std::fmt;
use stickslip::effects::formula::{ActsOn, Formula, Stated, Statement};
use stickslip::effects::{ParameterInfo, REGISTRY, find};
use stickslip::model::{Model, Operation};
use stickslip::scenario::Formulation::{Paper, Series};
use stickslip::scenario::{self, Scenario};
use stickslip::solver::{Solution, Warm, cycle::Tolerance, solve};
use stickslip::sweep;

fn main() {
    divan::main();
}

/// Frequencies of a sweep.
const FREQUENCIES: u32 = 24;
/// Steps per cycle of the published procedure.
const EULER_STEPS: usize = 20_000;
/// The reference table, for the parameters of the effects.
const TABLE: &str = include_str!("../tests/data/effects.csv");

/// A regime with its (speed, load, drive) in SI.
type Regime = (&'static str, (f64, f64, f64));
/// Slip both ways at a low load, partial stick, full slip.
const REGIMES: [Regime; 3] =
    [("V = 0", (0.0, 0.1, 7.5e-6)), ("partial stick", (5e-5, 20.0, 2.5e-6)), ("full slip", (0.02, 20.0, 2.5e-6))];

/// The base law or one effect, in one regime.
struct Case {
    effect: &'static str,
    regime: Regime,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}, {}", self.effect, self.regime.0)
    }
}

impl Case {
    fn model(&self) -> Model {
        let mut model = paper_model(Series);
        if let Some(effect) = find(self.effect) {
            let row = TABLE.lines().find(|line| line.starts_with(self.effect)).expect("a row of the table");
            let settings = row.split(',').nth(1).expect("the parameters");
            let value = |info: &ParameterInfo| {
                let pair = settings.split(' ').find_map(|pair| pair.strip_prefix(info.key)?.strip_prefix('='));
                pair.and_then(|value| value.parse().ok()).expect("a value")
            };
            model.effects.push((effect, effect.parameters().iter().map(value).collect()));
        }
        model
    }

    fn operation(&self, index: u32) -> Operation {
        let (speed, load, drive) = self.regime.1;
        let frequency = 58.0 + 36.0 * f64::from(index) / f64::from(FREQUENCIES - 1);
        Operation { speed, load, drive, frequency, series: 0 }
    }

    /// Times one steady state; `warm` starts each from its neighbour and the first one of a sweep cold.
    fn bench(&self, bencher: Bencher, warm: bool, derivatives: bool) {
        let model = self.model();
        let (mut index, mut start) = (0, Warm::default());
        bencher.bench_local(|| -> Solution {
            if !warm || index == 0 {
                start = Warm::default();
            }
            let at = self.operation(index);
            index = (index + 1) % FREQUENCIES;
            solve(&model, &at, EULER_STEPS, &Tolerance::default(), derivatives, &mut start)
        });
    }
}

fn cases() -> Vec<Case> {
    let names = ["none"].into_iter().chain(REGISTRY.iter().map(|effect| effect.name()));
    names.flat_map(|effect| REGIMES.map(|regime| Case { effect, regime })).collect()
}

/// All but the continuum, whose derivatives are differences of solutions.
fn single_sliders() -> Vec<Case> {
    cases().into_iter().filter(|case| case.effect != "partial-slip").collect()
}

#[divan::bench(args = cases(), sample_size = FREQUENCIES, sample_count = 20, max_time = 2)]
fn cold(bencher: Bencher, case: &Case) {
    case.bench(bencher, false, false);
}

#[divan::bench(args = cases(), sample_size = FREQUENCIES, sample_count = 20, max_time = 2)]
fn warm(bencher: Bencher, case: &Case) {
    case.bench(bencher, true, false);
}

/// To be divided by the times of `cold`.
#[divan::bench(args = single_sliders(), sample_size = FREQUENCIES, sample_count = 20, max_time = 2)]
fn cold_with_all_derivatives(bencher: Bencher, case: &Case) {
    case.bench(bencher, false, true);
}

/// Laws of the catalogue as a scenario may type them.
const TYPED: [(&str, ActsOn, &str); 3] = [
    ("cubic-stiffness", ActsOn::Force, "-K_3*x^3"),
    ("quadratic-damping", ActsOn::Force, "-D_2*v*abs(v)"),
    ("stribeck", ActsOn::Friction, "delta_mu*exp(-s/v_s)"),
];

/// A law of the catalogue in a regime, by itself or as a formula.
struct Typed {
    case: Case,
    formula: Option<(ActsOn, &'static str)>,
}

impl fmt::Display for Typed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}{}", self.case, if self.formula.is_some() { ", typed" } else { "" })
    }
}

fn typed_and_built_in() -> Vec<Typed> {
    // No contact, too: there nothing but the law takes time.
    let regimes = [("no contact", (0.0, 0.0, 7.5e-6)), REGIMES[1], REGIMES[2]];
    let of = |(effect, acts_on, text): (&'static str, ActsOn, &'static str)| {
        regimes.into_iter().flat_map(move |regime| {
            [None, Some((acts_on, text))].map(|formula| Typed { case: Case { effect, regime }, formula })
        })
    };
    TYPED.into_iter().flat_map(of).collect()
}

/// A law of the catalogue and the same law as a formula of a scenario, with all derivatives.
#[divan::bench(args = typed_and_built_in(), sample_size = FREQUENCIES, sample_count = 20, max_time = 2)]
fn formula(bencher: Bencher, typed: &Typed) {
    let mut model = typed.case.model();
    if let Some((acts_on, text)) = typed.formula {
        let (built_in, values) = model.effects.remove(0);
        let stated = |(info, value): (&ParameterInfo, &f64)| Stated {
            key: info.key.into(),
            unit: info.unit.into(),
            value: *value,
            range: None,
        };
        let parameters = built_in.parameters().iter().zip(&values).map(stated).collect();
        let statement = Statement { name: "typed".into(), text: text.into(), acts_on, parameters };
        let formula = Formula::new(statement).unwrap_or_else(|fault| panic!("{fault:?}"));
        model.effects.push((formula, values));
    }
    let mut index = 0;
    bencher.bench_local(|| -> Solution {
        let at = typed.case.operation(index);
        index = (index + 1) % FREQUENCIES;
        solve(&model, &at, EULER_STEPS, &Tolerance::default(), true, &mut Warm::default())
    });
}

/// The published procedure in partial stick, by its steps per cycle.
#[divan::bench(args = [2_000, 20_000], sample_size = 1, sample_count = 12)]
fn published_euler(bencher: Bencher, steps: usize) {
    let (model, at) = (paper_model(Paper), common::at(5e-5, 74.0));
    bencher.bench_local(|| solve(&model, &at, steps, &Tolerance::default(), false, &mut Warm::default()));
}

fn regime_map() -> Scenario {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/regime-map.toml");
    scenario::load(std::path::Path::new(path)).expect("a scenario of the repository")
}

/// The regime map of the report (67 speeds, 101 frequencies) by the number of threads.
#[divan::bench(args = [1, 2], sample_size = 1, sample_count = 10)]
fn sweep_on_threads(bencher: Bencher, threads: usize) {
    let scenario = regime_map();
    let points = sweep::conditions(&scenario).len() * scenario.sweep.as_ref().map_or(0, |s| s.frequency.len());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    bencher
        .counter(ItemsCount::new(points))
        .bench_local(|| pool.install(|| sweep::run(&scenario, &sweep::Options::default())));
}
