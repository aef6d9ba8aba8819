//! Prints as JSON how long a fit of rate-strengthening to practice table 1 takes on one thread, for
//! `benches/peers/fit.py`: from the geometric means of the catalogue's ranges, the contact from the scenario.
#![allow(clippy::print_stdout)]

use rayon::ThreadPoolBuilder;
use serde_json::json;
use std::time::Instant;
use stickslip::effects::find;
use stickslip::fit::{Problem, Settings, TAIL, minimise, parameter};
use stickslip::model::Model;
use stickslip::solver::cycle::Tolerance;
use stickslip::{measurement, scenario};

/// Fits, of which the fastest counts.
const REPEATS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = scenario::load("scenarios/practice/1/scenario.toml")?;
    let table = measurement::load(&scenario)?.ok_or("the scenario has no measurements")?;
    let effect = find("rate-strengthening").ok_or("rate-strengthening is not in the catalogue")?;
    let mut model = Model::new(&scenario);
    model.effects.push((effect, vec![(0.002f64 * 0.5).sqrt(), (1e-6f64 * 1e-1).sqrt()]));
    let mut keys = scenario.free.clone();
    keys.extend(effect.parameters().iter().map(|info| format!("effect.rate-strengthening.{}", info.key)));
    let parameters: Option<Vec<_>> = keys.iter().map(|key| parameter(&model, key)).collect();
    let parameters = parameters.ok_or("a parameter is not known")?;
    let settings = Settings { evaluations: 100, threshold: TAIL, converged: 1e-8, states: u64::MAX };
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut seconds = f64::INFINITY;
    let mut fitted = None;
    for _ in 0..REPEATS {
        let mut problem = Problem::new(model.clone(), &table.points, parameters.clone(), Tolerance::default());
        let start = problem.values();
        let began = Instant::now();
        fitted = Some(pool.install(|| minimise(&mut problem, &start, &settings)));
        seconds = seconds.min(began.elapsed().as_secs_f64());
    }
    let fit = fitted.ok_or("no fit was made")?;
    let report = json!({
        "chi2": fit.evaluation.chi2(),
        "values": fit.values,
        "evaluations": fit.evaluations,
        "seconds": seconds,
    });
    println!("{report:#}");
    Ok(())
}
