//! The history of runs: read before anything is written, drawn with this run, and extended by it at the very end.

use super::folder::Folder;
use super::simulate;
use crate::error::{Error, Result};
use crate::figures;
use crate::history::{self, Record, Records, Series};
use crate::report::{self, Change, FigureView, ReportView, Trend};
use std::path::{Path, PathBuf};

/// Name of the folder of its figures.
const SECTION: &str = "history";

/// The runs before this one.
pub struct Past {
    path: PathBuf,
    records: Records,
}

impl Past {
    /// Those of the file in a folder.
    ///
    /// # Errors
    /// [`Error::Input`] naming the line that is not a record.
    pub fn load(folder: &Path) -> Result<Self> {
        if folder.exists() && !folder.is_dir() {
            return Err(Error::Input(format!(
                "error: {} is not a folder\n  = help: give --history the folder of {}",
                folder.display(),
                history::FILE
            )));
        }
        let path = folder.join(history::FILE);
        Ok(Self { records: history::read(&path)?, path })
    }

    /// The report with the latest runs, this one included, and the record of this one; figures go below `out`.
    ///
    /// # Errors
    /// [`Error::Io`] where they cannot be written.
    pub fn with(mut self, view: ReportView, record: Record, out: &Folder) -> Result<ReportView> {
        self.records.latest.push(record);
        let trend = Trend::of(&self.records);
        let values = draw(&trend.values, "trend", "Errors and peaks by run", out)?;
        let times = draw(&trend.times, "times", "Wall times by run", out)?;
        let figures = (values.into_iter().collect(), times);
        Ok(view.with_history(&self.path.display().to_string(), &self.records, &trend, figures))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

fn draw(series: &[Series], name: &str, title: &str, out: &Folder) -> Result<Option<FigureView>> {
    match figures::history::draw(series, name, title) {
        Ok(drawing) => {
            let input = simulate::write(drawing, SECTION, out)?;
            Ok(Some(report::figure_view(SECTION, &input)))
        }
        Err(figures::FigureError::MissingData(_)) => Ok(None),
        Err(why) => Err(Error::Unfinished(why.to_string())),
    }
}

/// The history in lines of text.
pub fn words(view: &ReportView) -> Vec<String> {
    let Some(history) = &view.history else { return Vec::new() };
    let mut lines = vec![format!("history {}: {}", history.path, history.sentence)];
    let worse = history.steps.iter().filter(|step| step.verdict == Change::Regressed);
    let slower = view.provenance.slower.iter().filter(|step| step.verdict == Change::Regressed);
    for step in worse.chain(slower) {
        let (before, after, by) = (&step.before.text, &step.after.text, &step.by);
        lines.push(format!("  {}: {before} → {after} ({by}) since run {}, {}", step.what, step.run, step.time));
    }
    lines
}
