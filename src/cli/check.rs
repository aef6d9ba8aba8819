//! `stickslip check`: read and validate, nothing else.

use std::io::Write as _;
use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::scenario::Scenario;

use super::select::outcomes;

/// Checks files, and the scenarios below folders; without any, those below `scenarios/`, or where there is no such
/// folder the ones inside the binary. One line per sound file; the problems of all others are told together.
pub fn execute(paths: &[PathBuf]) -> Result<()> {
    let mut problems = Vec::new();
    for outcome in outcomes(paths) {
        match outcome {
            Ok(scenario) => print(&scenario)?,
            Err(error) => problems.push(error.to_string()),
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::Input(problems.join("\n\n"))) }
}

fn print(scenario: &Scenario) -> Result<()> {
    let points = match &scenario.sweep {
        Some(sweep) => format!("{} points", sweep.points()),
        None => "measurements only".into(),
    };
    let line = writeln!(std::io::stdout().lock(), "ok  {}  {}  ({points})", scenario.id, scenario.title);
    match line {
        // A reader such as `head` that has seen enough is no failure.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome.map_err(Error::io("write to", "standard output")),
    }
}
