//! Searches for the effect that the model of a measured rig lacks.
#![allow(clippy::print_stdout)]

use stickslip::discover::{SearchOptions, discover, sentence};
use stickslip::{measurement, scenario};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = scenario::load("scenarios/practice/1/scenario.toml")?;
    let table = measurement::load(&scenario)?.ok_or("the scenario has no measurements")?;
    let found = discover(&scenario, &table, &SearchOptions { max_effects: 1, ..SearchOptions::default() });
    println!("{}", sentence(&found));
    for candidate in found.candidates.iter().take(5) {
        println!("{:8.1} BIC above the best: {}", candidate.delta_bic, candidate.hypothesis.label());
    }
    Ok(())
}
