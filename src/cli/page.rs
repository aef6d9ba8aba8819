//! The page of one scenario, beside its figures: what `compare --out` and `discover --out` write.

use super::folder::Folder;
use super::rerender::{others, page};
use crate::error::{Error, Result};
use crate::gate::Judged;
use crate::report::{self, Provenance, ReportView, ScenarioView};
use crate::scenario::Scenario;
use crate::sweep::Outcome;
use std::path::PathBuf;

/// The section of a scenario of which nothing is swept.
pub fn section(scenario: &Scenario) -> ScenarioView {
    let none = Outcome { scenario: scenario.clone(), curves: Vec::new(), limits: Vec::new(), seconds: 0.0 };
    report::scenario_view(&none, &[])
}

/// Writes the page and the JSON of a section; where the page is.
///
/// # Errors
/// [`Error::Io`] where they cannot be written.
pub fn write(section: ScenarioView, judged: &[Judged], command: &str, out: &Folder) -> Result<PathBuf> {
    let provenance = Provenance::from_environment(command, rayon::current_num_threads());
    let title = section.title.clone();
    let view = ReportView::assemble(&title, vec![], vec![section], vec![], vec![], &provenance).with_gates(judged);
    let json = report::json(&view).map_err(|why| Error::Unfinished(why.to_string()))?;
    out.write("report.json", json.as_bytes())?;
    out.write("report.html", page(&view)?.as_bytes())?;
    for (name, page) in others(&view)? {
        out.write(name, page.as_bytes())?;
    }
    Ok(out.path().join("report.html"))
}
