//! Gates on the command line, and what is said of them.

use super::{Global, say};
use crate::error::{Error, Result};
use crate::gate::Judged;
use crate::scenario::parameters::{GATE, VERDICTS};
use crate::scenario::{Gate, Scenario};
use crate::units;
use clap::Args;
use clap::builder::PossibleValuesParser;

/// GateLimits in place of those of the scenarios.
#[derive(Debug, Clone, Default, Args)]
pub struct GateLimits {
    /// Gate: largest rms error of the amplitude, e.g. '5 %' [default: the scenario's]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    pub max_rms_error: Option<f64>,
    /// Gate: largest chi2 per reading, e.g. 1.5 [default: the scenario's]
    #[arg(long, value_name = "N", value_parser = chi2)]
    pub max_chi2: Option<f64>,
}

/// A verdict in place of that of the scenarios.
#[derive(Debug, Clone, Default, Args)]
pub struct Verdicts {
    /// Gate: what the discovery has to come to [default: the scenario's]
    #[arg(long, value_name = "VERDICT", value_parser = PossibleValuesParser::new(VERDICTS))]
    pub verdict: Option<String>,
}

impl GateLimits {
    /// Puts them in the place of a scenario's own.
    pub fn apply(&self, gate: &mut Gate) {
        gate.max_rms_error = self.max_rms_error.or(gate.max_rms_error);
        gate.max_chi2_per_point = self.max_chi2.or(gate.max_chi2_per_point);
    }
}

impl Verdicts {
    /// Puts it in the place of a scenario's own.
    pub fn apply(&self, gate: &mut Gate) {
        gate.verdict = self.verdict.clone().or(gate.verdict.take());
    }
}

/// Puts limits and verdict in place for every scenario with measurements.
///
/// # Errors
/// [`Error::Input`] where there is none to hold to them.
pub fn apply(limits: &GateLimits, verdict: &Verdicts, scenarios: &mut [Scenario]) -> Result<()> {
    let asked = limits.max_rms_error.is_some() || limits.max_chi2.is_some() || verdict.verdict.is_some();
    let mut measured = 0;
    for scenario in scenarios.iter_mut().filter(|scenario| scenario.measurement.is_some()) {
        limits.apply(&mut scenario.gate);
        verdict.apply(&mut scenario.gate);
        measured += 1;
    }
    if asked && measured == 0 {
        return Err(Error::Input(
            "error: a gate was given, and no scenario names measurements to judge\n  = help: add a table [measurement], \
             or leave out --max-rms-error, --max-chi2 and --verdict"
                .into(),
        ));
    }
    Ok(())
}

/// Says how many gates hold.
///
/// # Errors
/// [`Error::Io`] where that cannot be said.
pub fn told(judged: &[Judged], global: &Global) -> Result<()> {
    if !judged.is_empty() {
        let held = judged.iter().filter(|gate| gate.holds).count();
        say(global, &format!("gates: {held} of {} passed", judged.len()))?;
    }
    Ok(())
}

/// Says that claims are for the report.
///
/// # Errors
/// [`Error::Io`] where that cannot be said.
pub fn claims_elsewhere(gate: &Gate, global: &Global) -> Result<()> {
    if !gate.claims.is_empty() {
        say(global, "not judged here: claims of [gate]; `stickslip report` does")?;
    }
    Ok(())
}

/// An error with every gate that failed.
///
/// # Errors
/// [`Error::Gate`] where there is one.
pub fn passed(judged: &[Judged]) -> Result<()> {
    let failed: Vec<String> = judged.iter().filter(|g| !g.holds).map(|g| format!("  {}", g.sentence())).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let title = format!("error: {} of {} gates failed", failed.len(), judged.len());
    Err(Error::Gate(format!("{title}\n{}", failed.join("\n"))))
}

fn share(text: &str) -> std::result::Result<f64, String> {
    number(text, 0, "a share such as '5 %' or 0.05")
}

fn chi2(text: &str) -> std::result::Result<f64, String> {
    number(text, 1, "a number such as 1.5")
}

/// A pure number within the range of its key in `[gate]`.
fn number(text: &str, key: usize, expected: &str) -> std::result::Result<f64, String> {
    let value = text.trim().parse().ok().or_else(|| units::parse(text.trim(), "1").ok());
    let info = &GATE[key];
    value
        .filter(|value| (info.minimum..=info.maximum).contains(value))
        .ok_or_else(|| format!("expected {expected}, from {} to {}", info.minimum, info.maximum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_numbers_are_read_within_their_range() {
        assert_eq!((share("5 %"), share("0.05"), chi2("1.5")), (Ok(0.05), Ok(0.05), Ok(1.5)));
        assert!(share("-1 %").is_err() && share("nan").is_err() && share("5 mm").unwrap_err().contains("'5 %'"));
    }
}
