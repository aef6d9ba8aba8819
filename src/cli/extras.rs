//! Files of a report for pipelines: JUnit XML and a Markdown summary.

use crate::error::{Error, Result};
use crate::files;
use crate::report::{self, ReportView};
use clap::Args;
use std::path::{Path, PathBuf};

/// Where they go.
#[derive(Debug, Clone, Default, Args)]
pub struct Extras {
    /// Write gates, claims and checks as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write a summary as Markdown, e.g. for $GITHUB_STEP_SUMMARY
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

impl Extras {
    /// Complains where one of them would take the place of something else.
    ///
    /// # Errors
    /// [`Error::Input`] where it would.
    pub fn refuse<'a>(&self, inputs: impl Iterator<Item = &'a Path> + Clone) -> Result<()> {
        let given = [("--junit", &self.junit), ("--markdown", &self.markdown)];
        for (option, path) in given.iter().filter_map(|(option, path)| Some((option, path.as_ref()?))) {
            let same = |input: &Path| matches!((input.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
            let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
            let input = path.exists() && ["toml", "csv"].contains(&extension);
            if input || inputs.clone().any(same) || path.is_dir() {
                let why = if path.is_dir() { "is a folder" } else { "is an input and is not overwritten" };
                return Err(Error::Input(format!(
                    "error: {} {why}\n  = help: give {option} another file",
                    path.display()
                )));
            }
        }
        if self.junit.is_some() && self.junit == self.markdown {
            return Err(Error::Input(
                "error: --junit and --markdown name the same file\n  = help: give each its own file".into(),
            ));
        }
        Ok(())
    }

    /// Writes what was asked for; the paths written.
    pub fn write(&self, view: &ReportView) -> Result<Vec<&Path>> {
        let texts = [(&self.junit, report::junit as fn(&ReportView) -> String), (&self.markdown, report::markdown)];
        let mut written = Vec::new();
        for (path, text) in texts.iter().filter_map(|(path, text)| Some((path.as_deref()?, text))) {
            files::replace(path, text(view).as_bytes())?;
            written.push(path);
        }
        Ok(written)
    }
}
