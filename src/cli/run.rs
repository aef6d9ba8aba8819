//! `stickslip run`: simulate one scenario and draw it.

use super::{Global, say, select, simulate};
use crate::error::{Error, Result};
use crate::files;
use std::path::{Path, PathBuf};

/// Simulates the scenario, writes its figures and `curves.csv` below `out`.
pub fn execute(path: &Path, out: &Path, global: &Global) -> Result<()> {
    if path.is_dir() {
        return Err(Error::Input(format!(
            "error: {} is a folder\n  = help: name one scenario file, or use `stickslip report {}`",
            path.display(),
            path.display()
        )));
    }
    let scenarios = select::scenarios(&[PathBuf::from(path)])?;
    select::warn_unused(&scenarios);
    for scenario in &scenarios {
        if scenario.sweep.is_none() {
            return Err(Error::Input(format!(
                "error: {}: nothing to simulate\n  = help: add a [sweep] with frequency, speed, load and drive",
                scenario.path.display()
            )));
        }
        files::prepare(out)?;
        let outcome = simulate::outcome(scenario, global.quiet)?;
        let figures = simulate::figures(std::slice::from_ref(&outcome), out)?;
        let folder = out.join(&scenario.id);
        let points: usize = outcome.curves.iter().map(|curve| curve.states.len()).sum();
        say(global, &format!("{}: {points} points in {:.2} s", scenario.id, outcome.seconds));
        say(global, &format!("  {}", folder.join("curves.csv").display()));
        for name in figures.iter().flatten().flat_map(|figure| &figure.files) {
            say(global, &format!("  {}", out.join(name).display()));
        }
    }
    Ok(())
}
