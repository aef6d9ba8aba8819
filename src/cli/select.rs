//! Which scenarios a command works on.

use super::folder::RESERVED;
use crate::error::{Error, Result};
use crate::measurement::Table;
use crate::scenario::{self, Scenario};
use crate::terminal;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The scenarios of the arguments: files, folders, or without any those below `scenarios/`, or the ones in the binary.
/// Ids are made unique.
///
/// # Errors
/// All problems of all files together.
pub fn scenarios(paths: &[PathBuf], quiet: bool) -> Result<Vec<Scenario>> {
    let (mut good, mut problems) = (Vec::new(), Vec::new());
    for outcome in outcomes(paths, quiet) {
        match outcome {
            Ok(scenario) => good.push(scenario),
            Err(error) => problems.push(error.to_string()),
        }
    }
    if !problems.is_empty() {
        return Err(Error::Input(problems.join("\n\n")));
    }
    let mut taken = BTreeSet::new();
    // A scenario has a folder of its name beside the files of the report.
    let file = |id: &str| RESERVED.iter().any(|name| id == *name || id.starts_with(&format!("{name}/")));
    for scenario in &mut good {
        let wanted = scenario.id.clone();
        let mut number = 2;
        while file(&scenario.id) || !taken.insert(scenario.id.clone()) {
            scenario.id = match wanted.split_once('/').filter(|_| file(&wanted)) {
                Some((first, rest)) => format!("{first}-{number}/{rest}"),
                None => format!("{wanted}-{number}"),
            };
            number += 1;
        }
    }
    Ok(good)
}

/// The files that a scenario comes from, as far as one of a result's kind is among them.
pub fn inputs<'a>(scenario: &'a Scenario, table: Option<&'a Table>) -> impl Iterator<Item = &'a Path> {
    std::iter::once(scenario.path.as_path()).chain(table.map(|table| table.file.as_path()))
}

/// Each scenario of the arguments, or why it cannot be read.
pub fn outcomes(paths: &[PathBuf], quiet: bool) -> Vec<Result<Scenario>> {
    if !paths.is_empty() {
        return paths.iter().flat_map(|path| below(path)).collect();
    }
    let found = scenario::discover(Path::new("scenarios"));
    if found.is_empty() {
        if !quiet {
            terminal::tell("no scenarios/ here: the scenarios built into the program are used");
        }
        return scenario::embedded_names().iter().map(|name| scenario::load_embedded(name)).collect();
    }
    found.iter().map(scenario::load).collect()
}

fn below(path: &Path) -> Vec<Result<Scenario>> {
    let found = if path.is_dir() { scenario::discover(path) } else { Vec::new() };
    if found.is_empty() { vec![scenario::load(path)] } else { found.iter().map(scenario::load).collect() }
}
