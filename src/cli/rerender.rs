//! `stickslip report --from report.json`: the page made again from the files of an earlier run.

use super::exports::Extras;
use super::{Global, gates, say};
use crate::error::{Error, Result};
use crate::report::{self, Passed, ReportView};
use crate::results::Results;
use crate::{files, gate};
use std::path::{Path, PathBuf};

/// Bytes of a page that is still opened at once on a phone; drawings of an earlier run are left out beyond.
const LARGEST: usize = 4_900_000;
/// Largest file that is read.
const MAX_BYTES: u64 = 1 << 28;

/// Writes `report.html` into `--out`, or beside the JSON, and what else was asked for.
pub fn execute(from: &Path, (out, open): (Option<&Path>, bool), extras: &Extras, global: &Global) -> Result<()> {
    let from = if from.is_dir() { from.join("report.json") } else { from.to_path_buf() };
    let mut view = load(&from)?;
    let folder = from.parent().unwrap_or(Path::new("")).to_path_buf();
    let out = out.map_or_else(|| folder.clone(), Path::to_path_buf);
    let out = if out.as_os_str().is_empty() { PathBuf::from(".") } else { out };
    extras.free(&out)?;
    for figure in report::figures(&mut view) {
        for file in figure.files.clone() {
            let Some(place) = figure.text(&file.kind) else { continue };
            *place = text(&folder.join(&file.name))?;
        }
    }
    for picture in view.baseline.iter_mut().flat_map(|baseline| &mut baseline.pictures) {
        picture.svg = text(&folder.join(&picture.before))?;
    }
    let page = page(&view)?;
    let target = out.join("report.html");
    let results = Results::open(&out, [from.as_path()])?;
    results.write("report.html", page.as_bytes())?;
    for (name, page) in others(&view)? {
        results.write(name, page.as_bytes())?;
    }
    let written = extras.write(&view)?;
    say(global, &view.summary.sentence)?;
    for path in std::iter::once(target.as_path()).chain(written) {
        say(global, &format!("wrote {}", path.display()))?;
    }
    if open {
        super::browser::open(&target);
    }
    gates::passed(&judged(&view))
}

/// The pages beside the main one.
pub fn others(view: &ReportView) -> Result<Vec<(&'static str, String)>> {
    report::others(view).map_err(|why| Error::Unfinished(why.to_string()))
}

/// The page with as many drawings of an earlier run as it may hold; all of them are among the files.
pub fn page(view: &ReportView) -> Result<String> {
    let mut view = view.clone();
    loop {
        let page = report::render(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
        let pictures = view.baseline.iter_mut().flat_map(|baseline| &mut baseline.pictures);
        let mut held: Vec<_> = pictures.filter(|picture| !picture.svg.is_empty()).collect();
        if page.len() <= LARGEST || held.is_empty() {
            return Ok(page);
        }
        let half = held.len() / 2;
        held.drain(half..).for_each(|picture| picture.svg.clear());
    }
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
