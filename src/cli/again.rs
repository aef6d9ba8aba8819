//! `stickslip report --from report.json`: the page made again from the files of an earlier run.

use super::report::{Arguments, page};
use super::{Global, gates, say};
use crate::error::{Error, Result};
use crate::report::{self, Passed, ReportView};
use crate::results::Results;
use crate::{files, gate};
use std::path::{Path, PathBuf};

/// Largest file that is read.
const MAX_BYTES: u64 = 1 << 28;

/// Writes `report.html` into `--out`, or beside the JSON, and what else was asked for.
pub fn execute(from: &Path, arguments: &Arguments, global: &Global) -> Result<()> {
    let from = if from.is_dir() { from.join("report.json") } else { from.to_path_buf() };
    let mut view = load(&from)?;
    let folder = from.parent().unwrap_or(Path::new("")).to_path_buf();
    let out = arguments.out.clone().unwrap_or_else(|| folder.clone());
    let out = if out.as_os_str().is_empty() { PathBuf::from(".") } else { out };
    arguments.extras.free(&out)?;
    for figure in report::figures(&mut view) {
        for file in &figure.files {
            let place = match file.kind.as_str() {
                "SVG" => &mut figure.svg,
                // The first table is what is shown; others go with it.
                "CSV" if figure.csv.is_empty() => &mut figure.csv,
                _ => continue,
            };
            *place = text(&folder.join(&file.name))?;
        }
    }
    for picture in view.baseline.iter_mut().flat_map(|baseline| &mut baseline.pictures) {
        picture.svg = text(&folder.join(&picture.before))?;
    }
    let page = page(&view)?;
    let target = out.join("report.html");
    Results::open(&out, [from.as_path()])?.write("report.html", page.as_bytes())?;
    let extras = arguments.extras.write(&view)?;
    say(global, &view.summary.sentence)?;
    for path in std::iter::once(target.as_path()).chain(extras) {
        say(global, &format!("wrote {}", path.display()))?;
    }
    gates::passed(&judged(&view))
}

/// The view of an earlier run.
///
/// # Errors
/// [`Error::Input`] where the file is not one of a report.
pub fn load(path: &Path) -> Result<ReportView> {
    report::read(&text(path)?)
        .map_err(|(why, help)| Error::Input(format!("error: {} {why}\n  = help: {help}", path.display())))
}

/// The text of a report, or of a file beside it.
///
/// # Errors
/// As of [`files::text`].
pub fn text(path: &Path) -> Result<String> {
    let help = "name the report.json of an earlier run, its figures beside it: `stickslip report` makes one, \
                `stickslip accept` a baseline of it";
    files::text(path, MAX_BYTES, help)
}

/// The gates of that run.
fn judged(view: &ReportView) -> Vec<gate::Judged> {
    let of = |g: &report::GateView| gate::Judged {
        scenario: g.scenario.clone(),
        gate: g.gate.clone(),
        found: g.found.text.clone(),
        demanded: g.demanded.text.clone(),
        value: g.found.value,
        limit: g.demanded.value,
        holds: g.verdict == Passed::Yes,
    };
    view.gates.iter().map(of).collect()
}
