//! Calibrates the free parameters of a scenario with its measurements and prints what the model leaves.
#![allow(clippy::print_stdout)]

use stickslip::compare::{Options, compare, words};
use stickslip::{measurement, scenario};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = scenario::load("scenarios/practice/1/scenario.toml")?;
    let table = measurement::load(&scenario)?.ok_or("the scenario has no measurements")?;
    let found = compare(&scenario, &table, &Options { seed: 0 });
    for (parameter, interval) in found.fit.parameters.iter().zip(&found.intervals) {
        let (value, low, high) = (interval.value, interval.low, interval.high);
        println!("{} = {value:.4e} {} (95 %: {low:.4e} to {high:.4e})", parameter.key, parameter.unit);
    }
    println!("mean square of the residuals: {:.3} standard deviations squared", found.overall.chi2_per_point);
    for region in found.regions.iter().take(3) {
        let (from, to) = (region.frequency_from_hz, region.frequency_to_hz);
        println!("the model fails at {}, {from:.1} to {to:.1} Hz", words(&region.setting));
    }
    Ok(())
}
