//! Options that bound the next measurement: `--speed '0 mm/s..50 mm/s'`.

use crate::discover::Bounds;
use crate::error::{Error, Result};
use crate::measurement::Table;
use crate::scenario::Scenario;
use crate::units;
use clap::Args;

/// Where the next measurement may be made; without an option, within the range of the measurements at hand.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Bounds of the next measurement [default: the range of the measurements]")]
pub struct Limits {
    /// Roller speeds, e.g. '0 mm/s..50 mm/s'
    #[arg(long, value_name = "FROM..TO", value_parser = speed)]
    speed: Option<Range>,
    /// Loads, e.g. '0.1 N..20 N'
    #[arg(long, value_name = "FROM..TO", value_parser = load)]
    load: Option<Range>,
    /// Drives, e.g. '1 um..10 um'; of a rig driven by a force '0.1 N..5 N'
    #[arg(long, value_name = "FROM..TO", value_parser = drive)]
    drive: Option<String>,
    /// Frequencies, e.g. '50 Hz..100 Hz'
    #[arg(long, value_name = "FROM..TO", value_parser = frequency)]
    frequency: Option<Range>,
}

type Range = (f64, f64);

/// Units that a drive may have.
const DRIVES: [&str; 7] = ["m", "N", "N m", "rad", "m/s^2", "rad/s^2", "V"];

impl Limits {
    /// The bounds for a scenario and its table.
    ///
    /// # Errors
    /// [`Error::Input`] where they are of something that the rig does not have.
    pub fn of(&self, scenario: &Scenario, table: &Table) -> Result<Bounds> {
        let refuse = |option: &str, why: &str, help: &str| {
            Err(Error::Input(format!("error: {option}: {why}\n  = help: {help}")))
        };
        if scenario.contact.is_none() {
            for (option, given) in [("--speed", self.speed), ("--load", self.load)] {
                if given.is_some() {
                    return refuse(option, "the rig has no contact", "leave the option out");
                }
            }
        }
        let unit = table.signals.drive.unit;
        let drive = match self.drive.as_deref().map(|text| range(text, unit, true)) {
            Some(Err(why)) => {
                return refuse("--drive", &why, &format!("the drive of this rig is in {unit}"));
            }
            read => read.and_then(std::result::Result::ok),
        };
        Ok(Bounds { speed: self.speed, load: self.load, drive, frequency: self.frequency })
    }
}

fn speed(text: &str) -> std::result::Result<Range, String> {
    range(text, "m/s", false)
}
fn load(text: &str) -> std::result::Result<Range, String> {
    range(text, "N", true)
}

/// In whatever unit a drive may have; which one the rig's has is not known yet.
fn drive(text: &str) -> std::result::Result<String, String> {
    let read = DRIVES.map(|unit| range(text, unit, true));
    if read.iter().any(std::result::Result::is_ok) {
        return Ok(text.into());
    }
    // What is wrong whatever the unit says more than that another one was expected.
    let told = read.into_iter().filter_map(std::result::Result::err).min_by_key(|why| why.contains("is a unit of"));
    Err(told.unwrap_or_default())
}

fn frequency(text: &str) -> std::result::Result<Range, String> {
    range(text, "Hz", true)
}

/// Two quantities with `..` between them, ascending; one alone is a range of that value only.
fn range(text: &str, unit: &str, positive: bool) -> std::result::Result<Range, String> {
    let (from, to) = text.split_once("..").unwrap_or((text, text));
    // A number without a unit has that of the other end.
    let written = |part: &str| units::split_number(part.trim()).1.to_string();
    let (first, last) = (written(from), written(to));
    if first.is_empty() && last.is_empty() {
        return Err(format!(
            "it has no unit; write e.g. \"10 {unit}..20 {unit}\", or the unit once: \"10..20 {unit}\""
        ));
    }
    let value = |part: &str, own: &str, other: &str| {
        let unit_of = if own.is_empty() { other } else { "" };
        units::parse(format!("{part} {unit_of}").trim(), unit).map_err(|e| e.to_string())
    };
    let (from, to) = (value(from, &first, &last)?, value(to, &last, &first)?);
    let low = if positive { from > 0.0 } else { from >= 0.0 };
    match (low, from <= to) {
        (true, true) => Ok((from, to)),
        (false, _) if positive => Err(format!("it starts at {from:e} {unit}; expected more than zero")),
        (false, _) => Err(format!("it starts at {from:e} {unit}; expected zero or more")),
        (_, false) => Err("it ends below its start; write the smaller value first".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_carry_units() {
        assert_eq!(speed("0 mm/s..50 mm/s"), Ok((0.0, 0.05)));
        assert_eq!(load("2 N"), Ok((2.0, 2.0)));
        assert_eq!((speed("0..50 mm/s"), frequency("50 Hz..60")), (Ok((0.0, 0.05)), Ok((50.0, 60.0))));
    }

    #[test]
    fn a_bad_range_says_what_was_expected() {
        assert!(speed("5 mm..6 mm").unwrap_err().contains("speed"));
        assert!(load("0 N..5 N").unwrap_err().contains("more than zero"));
        assert!(drive("5 um..2 um").unwrap_err().contains("smaller value first"));
        assert!(drive("1 mN..2 N").is_ok() && drive("0.1..2 m/s^2").is_ok());
        assert!(drive("1 kg..2 kg").unwrap_err().contains("a mass"));
        assert!(frequency("50..60").unwrap_err().contains("\"10..20 Hz\""));
    }
}
