//! `stickslip accept`: the present report becomes the baseline of later ones.

use super::baseline::{self, Baseline};
use super::{Global, rerender, say, simulate};
use crate::error::{Error, Result};
use crate::report::Passed;
use crate::results::Results;
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of the command.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Folder or report.json of the run to accept
    #[arg(default_value = "output")]
    report: PathBuf,
    /// Folder of the baseline
    #[arg(long, value_name = "DIR", default_value = "baseline")]
    baseline: PathBuf,
    /// Show what would change, and write nothing
    #[arg(long)]
    dry_run: bool,
}

/// Says what differs from the baseline so far, and puts the report with its drawings and curves in its place.
pub fn execute(arguments: &Arguments, global: &Global) -> Result<()> {
    let Arguments { report, baseline: folder, dry_run } = arguments;
    let now = Baseline::load(report)?;
    let from = if report.is_dir() { report.clone() } else { report.parent().unwrap_or(Path::new("")).to_path_buf() };
    let target = folder.join("report.json");
    if folder.exists() && !folder.is_dir() {
        let help = "give --baseline a folder";
        return Err(Error::Input(format!("error: {} is not a folder\n  = help: {help}", folder.display())));
    }
    if matches!((from.canonicalize(), folder.canonicalize()), (Ok(a), Ok(b)) if a == b) {
        let help = "give --baseline another folder";
        return Err(Error::Input(format!("error: {} is the report itself\n  = help: {help}", folder.display())));
    }
    if target.exists() {
        let earlier = Baseline::load(folder)?;
        baseline::words(&earlier.numbers(&now.view)).iter().try_for_each(|line| say(global, line))?;
    } else {
        say(global, &format!("{} holds no baseline yet", folder.display()))?;
    }
    let failed = now.view.gates.iter().filter(|gate| gate.verdict == Passed::No).count();
    if failed > 0 {
        say(global, &format!("note: {failed} of {} gates failed in this run", now.view.gates.len()))?;
    }
    let json = if report.is_dir() { report.join("report.json") } else { report.clone() };
    let text = rerender::text(&json)?;
    let figures = now.view.figures();
    let drawings = figures.iter().filter(|figure| !figure.svg.is_empty()).flat_map(|figure| {
        figure.files.iter().filter(|file| file.kind == "SVG").map(|file| (file.name.clone(), figure.svg.clone()))
    });
    let ids = now.view.scenarios.iter().map(|scenario| simulate::curves_name(&scenario.id));
    let curves = ids.filter(|name| baseline::inside(name)).filter_map(|name| {
        let text = rerender::text(&from.join(&name)).ok()?;
        Some((name, text))
    });
    let files: Vec<(String, String)> = drawings.chain(curves).collect();
    let count = files.len() + 1;
    if *dry_run {
        say(global, &format!("dry run: {count} files would be written below {}", folder.display()))?;
        return Ok(());
    }
    let results = Results::open(folder, [json.as_path()])?;
    for (name, text) in &files {
        results.write(name, text.as_bytes())?;
    }
    // Last, so that a baseline whose report names a figure has it.
    results.write("report.json", text.as_bytes())?;
    say(global, &format!("accepted: {count} files below {}", folder.display()))?;
    Ok(())
}
