//! `stickslip check`: read and validate scenarios and their tables of measurements, nothing else.

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::measurement::{self, Table};
use crate::scenario::Scenario;
use crate::terminal;

use super::compare::uncalibrated;
use super::ledger::Ledger;
use super::select::outcomes;

/// Checks files, and the scenarios below folders; without any, those below `scenarios/`, or where there is no such
/// folder the ones inside the binary. One line per sound file; the problems of all others are told together.
pub fn execute(paths: &[PathBuf]) -> Result<()> {
    let mut problems = Vec::new();
    for outcome in outcomes(paths, false) {
        let read = outcome.and_then(|scenario| {
            Ledger::find(std::slice::from_ref(&scenario))?;
            Ok((measurement::load(&scenario)?, scenario))
        });
        match read {
            Ok((table, scenario)) => print(&scenario, table.as_ref())?,
            Err(error) => problems.push(error.to_string()),
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::Input(problems.join("\n\n"))) }
}

fn print(scenario: &Scenario, table: Option<&Table>) -> Result<()> {
    let swept = scenario.sweep.as_ref().map(|sweep| format!("{} points", sweep.points()));
    let measured = table.map(|table| format!("measured: {}", table.summary()));
    let what: Vec<String> = swept.into_iter().chain(measured).collect();
    let mut text = format!("ok  {}  {}  ({})\n", scenario.id, scenario.title, what.join("; "));
    if let Some(table) = table {
        text += &format!("    {}\n", table.ranges());
    }
    let told = table.and_then(|_| uncalibrated(scenario));
    for note in table.iter().flat_map(|table| &table.notes).cloned().chain(told) {
        text += &format!("    note: {note}\n");
    }
    terminal::print(&text)
}
