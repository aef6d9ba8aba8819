//! Solves the sweep of a scenario and prints the peak of every resonance curve.
#![allow(clippy::print_stdout)]

use stickslip::{compare, scenario, sweep, units::readable::quantity};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = scenario::load("scenarios/paper/figure-6.toml")?;
    let outcome = sweep::run(&scenario, &sweep::Options::default());
    for curve in &outcome.curves {
        let amplitudes = curve.states.iter().map(|state| state.amplitude);
        let resonance: Vec<_> = curve.frequency.iter().copied().zip(amplitudes).collect();
        let Some(peak) = compare::peak(&resonance) else { continue };
        let at = &curve.condition;
        println!(
            "V = {}, W = {}: {} at {}",
            quantity(at.speed, "m/s", 3),
            quantity(at.load, "N", 3),
            quantity(peak.amplitude, "rad", 4),
            quantity(peak.frequency_hz, "Hz", 4)
        );
    }
    Ok(())
}
