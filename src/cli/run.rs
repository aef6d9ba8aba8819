//! `stickslip run`: simulate one scenario, compare it with its measurements, find what is missing, draw it.

use super::figure_output::FigureOutput;
use super::folder::Folder;
use super::{Global, compare, gates, say, select, simulate};
use crate::error::{Error, Result};
use crate::{discover, free_form, gate, question};
use std::path::{Path, PathBuf};

/// Simulates the scenario, compares it where it names measurements, writes its figures and `curves.csv` below `out`.
pub fn execute(path: &Path, (out, drawn): (&Path, &FigureOutput), global: &Global) -> Result<()> {
    if path.is_dir() {
        return Err(Error::Input(format!(
            "error: {} is a folder\n  = help: name one scenario file, or use `stickslip report {}`",
            path.display(),
            path.display()
        )));
    }
    let scenarios = select::scenarios(&[PathBuf::from(path)], global.quiet)?;
    let mut judged = Vec::new();
    for scenario in &scenarios {
        let table = compare::table(scenario)?;
        let results = &Folder::open(out, drawn, select::inputs(scenario, table.as_ref()))?;
        let outcome = simulate::outcome(&compare::swept(scenario, table.as_ref()), global.quiet);
        let figures = simulate::figures(std::slice::from_ref(&outcome), results)?;
        let folder = out.join(&scenario.id);
        let points: usize = outcome.curves.iter().map(|curve| curve.states.len()).sum();
        if scenario.sweep.is_some() {
            say(global, &format!("{}: {points} points in {:.2} s", scenario.id, outcome.seconds))?;
        }
        if points > 0 {
            say(global, &format!("  {}", folder.join("curves.csv").display()))?;
        }
        let mut figures: Vec<_> = figures.into_iter().flatten().collect();
        if let Some(table) = &table {
            let comparison = compare::compare(scenario, table);
            figures.extend(simulate::comparison(&comparison, results)?);
            compare::words(&comparison).iter().try_for_each(|line| say(global, line))?;
            let discovery = discover::discover(scenario, table, &discover::SearchOptions::default());
            figures.extend(simulate::discovery(&discovery, results)?);
            super::discover::words(&discovery, None).iter().try_for_each(|line| say(global, line))?;
            if let Some(found) = discover::beside(&discovery, false) {
                figures.extend(simulate::free_form(&found, &scenario.id, results)?);
                free_form::lines(&found, true).iter().try_for_each(|line| say(global, line))?;
            }
            judged.extend(gate::of_comparison(&scenario.gate, &comparison));
            judged.extend(gate::of_discovery(&scenario.gate, &discovery));
        }
        if let Some((answer, drawn)) = super::question::answer(scenario, results)? {
            figures.extend(drawn);
            question::lines(&answer).iter().try_for_each(|line| say(global, line))?;
        }
        for name in figures.iter().flat_map(|figure| &figure.files) {
            say(global, &format!("  {}", out.join(name).display()))?;
        }
    }
    gates::told(&judged, global)?;
    gates::passed(&judged)
}
