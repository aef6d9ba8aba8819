//! Where the time of a discovery goes, on practice table 1 (312 points with phases): the calibration of the base, one
//! evaluation with derivatives and one fit per effect, the whole by the number of effects allowed.
//!
//! `cargo bench --bench discovery`, or a part of it: `cargo bench --bench discovery -- fit`. All run on one thread per
//! core.

use divan::Bencher;
use std::path::Path;
use stickslip::compare::calibrate;
use stickslip::discover::{Addition, Candidates, SearchOptions, additions, compatible, discover, extended};
use stickslip::fit::{Parameter, Problem, Settings, TAIL, minimise, parameter};
use stickslip::measurement::{self, Table};
use stickslip::model::Model;
use stickslip::scenario::{self, Scenario};
use stickslip::solver::cycle::Tolerance;

fn main() {
    divan::main();
}

fn practice(number: u32) -> (Scenario, Table) {
    let path = format!("{}/scenarios/practice/{number}/scenario.toml", env!("CARGO_MANIFEST_DIR"));
    let scenario = scenario::load(Path::new(&path)).expect("a scenario of the repository");
    let table = measurement::load(&scenario).expect("a table").expect("measurements");
    (scenario, table)
}

/// What may be added to the model of practice table 1.
fn pool() -> Vec<Addition> {
    let (scenario, _) = practice(1);
    let base = Model::new(&scenario);
    additions(&base, &scenario.free, true, &Candidates::default())
        .into_iter()
        .filter(|addition| compatible(&base, &[*addition]))
        .collect()
}

fn names() -> Vec<&'static str> {
    pool().iter().map(Addition::name).collect()
}

/// The model with an addition of typical strength, and what moves beside it.
fn with(scenario: &Scenario, name: &str) -> (Model, Vec<Parameter>) {
    let addition = pool().into_iter().find(|addition| addition.name() == name).expect("an addition");
    let model = extended(&Model::new(scenario), &[addition]);
    let keys = scenario.free.iter().cloned().chain(addition.keys());
    let parameters = keys.filter_map(|key| parameter(&model, &key)).collect();
    (model, parameters)
}

#[divan::bench(sample_size = 1, sample_count = 5)]
fn calibration(bencher: Bencher) {
    let (scenario, table) = practice(1);
    let base = Model::new(&scenario);
    bencher.bench_local(|| calibrate(&base, &scenario.free, &table.points, Tolerance::default(), 0));
}

/// All points with derivatives, cold.
#[divan::bench(args = names(), sample_size = 1, sample_count = 3)]
fn evaluation(bencher: Bencher, name: &str) {
    let (scenario, table) = practice(1);
    let (model, parameters) = with(&scenario, name);
    bencher.bench_local(|| {
        let mut problem = Problem::new(model.clone(), &table.points, parameters.clone(), Tolerance::default());
        let values = problem.values();
        problem.evaluate(&values, true)
    });
}

/// From the typical strength, at the accuracy of a search.
#[divan::bench(args = names(), sample_size = 1, sample_count = 3)]
fn fit(bencher: Bencher, name: &str) {
    let (scenario, table) = practice(1);
    let (model, parameters) = with(&scenario, name);
    let settings = Settings { evaluations: 30, threshold: TAIL, converged: 1e-4, states: u64::MAX };
    bencher.bench_local(|| {
        let mut problem = Problem::new(model.clone(), &table.points, parameters.clone(), Tolerance::COARSE);
        let values = problem.values();
        minimise(&mut problem, &values, &settings)
    });
}

#[divan::bench(args = [0, 1, 3], sample_size = 1, sample_count = 2)]
fn whole_by_effects_allowed(bencher: Bencher, max_effects: usize) {
    let (scenario, table) = practice(1);
    let options = SearchOptions { max_effects, ..SearchOptions::default() };
    bencher.bench_local(|| discover(&scenario, &table, &options));
}
